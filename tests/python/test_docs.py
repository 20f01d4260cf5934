"""The commands of the docs, run as they stand there: those of blocks that begin with ```sh, document by document.

Of the README's commands two are left out, the training of 45 minutes and TensorBoard, and one training is shortened.
"""

import os
import pathlib
import re
import shutil
import subprocess

import pytest

from conftest import BIN

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
COMMANDS = "train evaluate plan check report inspect export results tune bench completion".split() + [
    f"maps {name}" for name in "info show convert generate".split()
]


def run_commands(commands, folder):
    assert commands
    environment = os.environ | {"PATH": f"{BIN}:{os.environ['PATH']}"}
    for command in commands:
        process = subprocess.run(
            command, shell=True, cwd=folder, env=environment, capture_output=True, text=True, timeout=120, check=False
        )
        assert process.returncode == 0, f"{command}\n{process.stderr}"
    for name in re.findall(r"(?:--out|-o|--png|--svg) (\S+\.\w+)", " ".join(commands)):
        assert (folder / name).stat().st_size > 0


@pytest.mark.parametrize("document", ["docs/tutorial.md", "docs/report.md", "examples/README.md"])
def test_commands_run(document, tmp_path):
    blocks = re.findall(r"```sh\n(.*?)```", (ROOT / document).read_text(encoding="utf-8"), re.DOTALL)
    shutil.copytree(ROOT / "examples", tmp_path / "examples")
    run_commands([line for block in blocks for line in block.replace("\\\n", " ").splitlines() if line], tmp_path)


def test_commands_of_the_readme_run(tmp_path):
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    (tmp_path / "my.txt").write_text(re.search(r"```\n([.#\n]+)```", text)[1])
    block = re.search(r"```\ngraphdrl=\S+\n(.*?)```", text, re.DOTALL)[1]
    commands = [line.split(" #")[0].strip().replace("$graphdrl", "graphdrl") for line in block.splitlines()]
    commands = [command for command in commands if command != "graphdrl train" and "tensorboard" not in command]
    commands = [command.replace("--episodes 400", "--episodes 25") for command in commands]
    shown = [" ".join(command.split()) for command in re.findall(r"`(graphdrl (?:maps generate|plan)[^`]*)`", text)]
    assert len(commands) > 10 and len(shown) == 2
    run_commands(commands + shown, tmp_path)


def test_every_command_has_its_options_in_the_docs(run):
    """docs/commands.md holds what --help prints, whatever the line breaks."""
    text = " ".join((ROOT / "docs" / "commands.md").read_text(encoding="utf-8").split())
    for command in COMMANDS:
        printed = " ".join(run("graphdrl", *command.split(), "--help").stdout.split())
        assert f"```text {printed} ```" in text, f"graphdrl {command} --help"
