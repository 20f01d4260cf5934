"""The commands of the docs, run as they stand there: those of blocks that begin with ```sh, document by document."""

import os
import pathlib
import re
import shutil
import subprocess

import pytest

from conftest import BIN

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
COMMANDS = "train evaluate plan check report inspect bench".split() + [
    f"maps {name}" for name in "info show convert generate".split()
]


@pytest.mark.parametrize("document", ["docs/tutorial.md", "docs/report.md", "examples/README.md"])
def test_commands_run(document, tmp_path):
    blocks = re.findall(r"```sh\n(.*?)```", (ROOT / document).read_text(encoding="utf-8"), re.DOTALL)
    commands = [line for block in blocks for line in block.replace("\\\n", " ").splitlines() if line]
    assert commands
    shutil.copytree(ROOT / "examples", tmp_path / "examples")
    for command in commands:
        environment = os.environ | {"PATH": f"{BIN}:{os.environ['PATH']}"}
        process = subprocess.run(
            command, shell=True, cwd=tmp_path, env=environment, capture_output=True, text=True, timeout=120, check=False
        )
        assert process.returncode == 0, f"{command}\n{process.stderr}"
    for name in re.findall(r"(?:--out|-o|--png) (\S+)", " ".join(commands)):
        assert (tmp_path / name).stat().st_size > 0


def test_every_command_has_its_options_in_the_docs(run):
    """docs/commands.md holds what --help prints, whatever the line breaks."""
    text = " ".join((ROOT / "docs" / "commands.md").read_text(encoding="utf-8").split())
    for command in COMMANDS:
        printed = " ".join(run("graphdrl", *command.split(), "--help").stdout.split())
        assert f"```text {printed} ```" in text, f"graphdrl {command} --help"
