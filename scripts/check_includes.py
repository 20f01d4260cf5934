#!/usr/bin/env python3
"""Fails on an include against ARCHITECTURE.md's order of the modules, on a row there that names other files than there
are, and on LibTorch and MPI in other modules than their own."""

import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
SOURCES = ROOT / "src" / "graphdrl"
MODULE = re.compile(r"^### `([\w/]+)/`.*\n((?:(?!^#).*\n)*)", re.MULTILINE)
ROW = re.compile(r"^\| (`.+?`) \|", re.MULTILINE)
OWN_INCLUDE = re.compile(r'^#include "graphdrl/([\w/]+)/[^/]+"')
MPI_INCLUDE = re.compile(r"^#include [<\"]mpi")
TORCH_INCLUDE = re.compile(r"^#include [<\"](torch|ATen|c10)/")


def row_problems(module: str, text: str, files: set[str]) -> list[str]:
    """A row names headers or sources; `NAME` stands for any, `bound` for bound_without_clp too."""
    named = {name for row in ROW.findall(text) for name in re.findall(r"`(\w+)`", row)}
    mentioned = tuple(f"{name}_" for name in re.findall(r"`(\w+)`", text))
    problems = [f"ARCHITECTURE.md: {module}/ has no {name}" for name in sorted(named - files - {"NAME"})]
    if "NAME" not in named:
        lacking = sorted(stem for stem in files if not f"{stem}_".startswith(mentioned))
        problems += [f"ARCHITECTURE.md: no row of {module}/ names {stem}" for stem in lacking]
    return problems


def main() -> int:
    sections = dict(MODULE.findall((ROOT / "ARCHITECTURE.md").read_text(encoding="utf-8")))
    modules = list(sections)
    paths = sorted(path for path in SOURCES.rglob("*") if path.suffix in {".h", ".cpp"})
    folders = {path.parent.relative_to(SOURCES).as_posix() for path in paths}
    problems = []
    if set(modules) != folders:
        problems.append(f"ARCHITECTURE.md lists {sorted(modules)}, src/graphdrl/ holds {sorted(folders)}")
    for module, text in sections.items():
        problems += row_problems(module, text, {path.stem for path in paths if path.parent == SOURCES / module})
    torch_module = "train/torch" if "train/torch" in folders else "train"
    rank = {module: index for index, module in enumerate(modules)}
    for path in paths:
        module = path.parent.relative_to(SOURCES).as_posix()
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
            where = f"{path.relative_to(ROOT)}:{number}"
            own = OWN_INCLUDE.match(line)
            if own and rank.get(own[1], len(rank)) > rank.get(module, -1):
                problems.append(f"{where}: {module}/ must not include {own[1]}/, which comes after it")
            if TORCH_INCLUDE.match(line) and module != torch_module:
                problems.append(f"{where}: only {torch_module}/ may see LibTorch")
            if MPI_INCLUDE.match(line) and module != "mpi":
                problems.append(f"{where}: only mpi/ may see MPI")
    for problem in problems:
        print(problem, file=sys.stderr)
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
