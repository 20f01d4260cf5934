"""What the docs say to run, run as it stands there, document by document: blocks that begin with ```sh or ```python.

What needs Stable-Baselines3 runs in test_learners.py, what needs OR-tools where that is installed.
"""

import contextlib
import importlib.util
import io
import os
import re
import shutil
import subprocess

import pytest

from conftest import BIN, ROOT, python_blocks

COMMANDS = [
    *["plan", "explore", "serve", "check", "evaluate", "report"],
    *["maps info", "maps show", "maps convert", "maps generate"],
    *["train", "inspect", "export", "results", "tune", "bench", "completion"],
]


def run_commands(commands, folder):
    assert commands
    printed = []
    environment = os.environ | {"PATH": f"{BIN}:{os.environ['PATH']}"}
    for command in commands:
        process = subprocess.run(
            command, shell=True, cwd=folder, env=environment, capture_output=True, text=True, timeout=120, check=False
        )
        assert process.returncode == 0, f"{command}\n{process.stderr}"
        printed.append(process.stdout)
    for name in re.findall(r"(?:--out|-o|--png|--svg) (\S+\.\w+)", " ".join(commands)):
        assert (folder / name).stat().st_size > 0
    return printed


@pytest.mark.parametrize("document", ["docs/tutorial.md", "docs/report.md", "examples/README.md"])
def test_commands_run(document, tmp_path):
    blocks = re.findall(r"```sh\n(.*?)```", (ROOT / document).read_text(encoding="utf-8"), re.DOTALL)
    shutil.copytree(ROOT / "examples", tmp_path / "examples")
    run_commands([line for block in blocks for line in block.replace("\\\n", " ").splitlines() if line], tmp_path)


def test_commands_of_the_readme_run(tmp_path):
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    first = re.search(r"```\nscripts/build graphdrl .*\n(printf.*\n.*)\n```\n\n```text\n(.*?)```", text, re.DOTALL)
    then = re.search(r"```\ngraphdrl=\S+\n(.*?)```", text, re.DOTALL)
    block = first[1] + "\n" + then[1]
    commands = [re.sub(r"\S+graphdrl |\$graphdrl ", "graphdrl ", line.split(" # ")[0]) for line in block.splitlines()]
    shown = [" ".join(command.split()) for command in re.findall(r"`(graphdrl (?:maps generate|plan)[^`]*)`", text)]
    assert len(commands) == 9 and len(shown) == 2
    printed = run_commands(commands + shown, tmp_path)
    assert printed[1] == first[2]


def test_the_examples_of_the_commands_run(tmp_path):
    """But for the trainings of 45 minutes and more, and TensorBoard; the others are shortened."""
    text = (ROOT / "docs" / "commands.md").read_text(encoding="utf-8")
    block = re.search(r"## By example\n\n```\n(.*?)```", text, re.DOTALL)[1]
    commands = [line.split(" # ")[0].strip() for line in block.splitlines()]
    commands = [command for command in commands if command not in ("graphdrl train", "graphdrl tune")]
    commands = [command.replace("--episodes 400", "--episodes 3") for command in commands]
    (tmp_path / "my.txt").write_text(".....\n.#.#.\n.....\n")
    assert commands.pop().startswith("tensorboard") and len(commands) > 10
    run_commands(commands, tmp_path)


def missing(code):
    """The packages that a block imports and that are not installed here."""
    imported = re.findall(r"^(?:import|from) (\w+)", code, re.MULTILINE)
    return [package for package in imported if importlib.util.find_spec(package) is None]


@pytest.mark.parametrize(
    ("document", "least", "not_installed"),
    [("README.md", 1, ()), ("docs/python.md", 12, ()), ("docs/coming_from.md", 4, ("ortools", "stable_baselines3"))],
)
def test_python_blocks_run(document, least, not_installed, tmp_path, monkeypatch):
    """One after the other, in one namespace, printing what the page says."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("SDL_VIDEODRIVER", "dummy")
    names = {}
    count = 0
    for line, code, expected in python_blocks(document):
        if missing(code):
            assert set(missing(code)) <= set(not_installed)
            continue
        code = code.replace("episodes=2_000", "episodes=12")  # ten minutes otherwise
        code = code.replace('"paper", ', '"paper", batch_size=4, ')  # a tenth of the time
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            exec(compile("\n" * line + code, document, "exec"), names)
        assert expected is None or printed.getvalue() == expected, code
        count += 1
    assert count >= least


def test_every_command_has_its_options_in_the_docs():
    """docs/commands.md holds what --help prints, whatever the line breaks."""
    text = (ROOT / "docs" / "commands.md").read_text(encoding="utf-8")
    assert re.findall(r"^## `graphdrl ([a-z ]+)`$", text, re.MULTILINE) == COMMANDS
    environment = os.environ | {"GRAPHDRL_BIN": str(BIN)}
    process = subprocess.run(
        [ROOT / "scripts" / "command_docs", "--check"], env=environment, capture_output=True, text=True, check=False
    )
    assert process.returncode == 0, process.stderr
