#!/usr/bin/env python3
"""Fails on lines of more than 120 characters, but for rows of Markdown's tables; --fix wraps Markdown's paragraphs."""

import pathlib
import re
import subprocess
import sys
import textwrap

ROOT = pathlib.Path(__file__).resolve().parent.parent
WIDTH = 120
SUFFIXES = {".cpp", ".h", ".py", ".md"}
LIST_ITEM = re.compile(r"([-*+]|\d+\.) +")
CODE_SPAN = re.compile(r"`[^`]{1,60}`")
GLUE = "\ue000"  # stands for a space that no line may be broken at


def sources() -> list[pathlib.Path]:
    listed = subprocess.run(
        ["git", "ls-files", "--cached", "--others", "--exclude-standard"],
        cwd=ROOT,
        check=True,
        capture_output=True,
        text=True,
    ).stdout.splitlines()
    paths = [ROOT / name for name in listed]
    return [path for path in paths if path.is_file() and is_source(path)]


def is_source(path: pathlib.Path) -> bool:
    if path.suffix:
        return path.suffix in SUFFIXES
    with path.open("rb") as file:
        return file.read(2) == b"#!"


def long_lines(path: pathlib.Path) -> list[int]:
    table = path.suffix == ".md"
    lines = path.read_text(encoding="utf-8").splitlines()
    return [n for n, line in enumerate(lines, 1) if len(line) > WIDTH and not (table and line.startswith("|"))]


def wrap(paragraph: list[str]) -> list[str]:
    indent = re.match(r" *", paragraph[0])[0]
    words = " ".join(line.strip() for line in paragraph)
    item = LIST_ITEM.match(words)
    hanging = indent + " " * len(item[0]) if item else indent
    words = CODE_SPAN.sub(lambda span: span[0].replace(" ", GLUE), words)
    words = re.sub(r" (?=(?:[-*+>|]|#+|\d+\.) |\|)", GLUE, words[len(item[0]) :] if item else words)
    lines = textwrap.wrap(
        words,
        WIDTH,
        initial_indent=indent + (item[0] if item else ""),
        subsequent_indent=hanging,
        break_long_words=False,
        break_on_hyphens=False,
    )
    return [line.replace(GLUE, " ") for line in lines]


def wrap_markdown(text: str) -> str:
    """Wraps the paragraphs and list items that hold a line too long, and leaves all else."""
    out: list[str] = []
    paragraph: list[str] = []

    def flush() -> None:
        out.extend(wrap(paragraph) if any(len(line) > WIDTH for line in paragraph) else paragraph)
        paragraph.clear()

    code = False
    for line in text.splitlines():
        fence = line.lstrip().startswith("```")
        if code or fence or not line.strip() or line.startswith(("|", "#", "<", "!")):
            flush()
            out.append(line)
        else:
            if LIST_ITEM.match(line.lstrip()):
                flush()
            paragraph.append(line)
        code ^= fence
    flush()
    return "\n".join(out) + "\n"


def main() -> int:
    problems = []
    for path in sources():
        if "--fix" in sys.argv[1:] and path.suffix == ".md" and long_lines(path):
            path.write_text(wrap_markdown(path.read_text(encoding="utf-8")), encoding="utf-8")
        problems += [
            f"{path.relative_to(ROOT)}:{n}: a line of more than {WIDTH} characters" for n in long_lines(path)
        ]
    for problem in problems:
        print(problem, file=sys.stderr)
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
