"""What `graphdrl plan` prints: pictures that fit a terminal, walks that `check` reads back."""

import fcntl
import os
import pty
import re
import struct
import subprocess
import termios

import pytest
from conftest import BIN, ROOT

ESCAPE = re.compile(r"\033\[[0-9;]*m")
MAZE = ["maps", "generate", "loop-maze", "--size", "61", "--count", "1", "--out"]


def in_terminal(*arguments, columns, lines, **variables):
    """What a program writes to a terminal of this size."""
    ours, theirs = pty.openpty()
    fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", lines, columns, 0, 0))
    environment = {key: value for key, value in os.environ.items() if key not in ("COLUMNS", "NO_COLOR")}
    environment |= {"TERM": "xterm"} | variables
    with subprocess.Popen([BIN / "graphdrl", *map(str, arguments)], stdout=theirs, env=environment) as process:
        os.close(theirs)
        output = b""
        while True:
            try:
                part = os.read(ours, 65536)
            except OSError:  # Linux's way to say that the other side is closed
                part = b""
            if not part:
                break
            output += part
    os.close(ours)
    assert process.returncode == 0
    return output.decode().replace("\r\n", "\n")


@pytest.mark.parametrize(("columns", "lines"), [(40, 20), (80, 24), (200, 80)])
def test_a_picture_fits_the_terminal(run, tmp_path, columns, lines):
    assert run("graphdrl", *MAZE, tmp_path / "maze").returncode == 0
    (maze,) = (tmp_path / "maze").glob("*.txt")
    command = ["plan", maze, "--budget", "0.5x", "--policy", "nearest"]
    shown = in_terminal(*command, columns=columns, lines=lines)
    head, picture = ESCAPE.sub("", shown).split("\n\n")
    assert head.startswith("loop-maze-61-0000, nearest from node 0")
    assert max(len(line) for line in picture.splitlines()) <= columns
    assert shown.count("\n") < lines
    assert "\033[38;5;" in shown
    plain = in_terminal(*command, columns=columns, lines=lines, NO_COLOR="1")
    assert "\033" not in plain and "blocked" in plain
    assert "\033" not in in_terminal(*command, columns=columns, lines=lines, TERM="dumb")


def test_a_picture_in_a_file_has_no_colours(run):
    text = run("graphdrl", "plan", "paper:a", "--budget", "25", env=os.environ | {"COLUMNS": "7"}).stdout
    assert "\033" not in text
    rows = text.split("\n\n")[1].splitlines()[:5]
    assert all(len(row) == 5 for row in rows) and rows[0][0] == "S"  # two columns a cell do not fit


@pytest.mark.parametrize(
    "arguments",
    [("paper:a", "--budget", "25"), (ROOT / "examples/3-graph/campus.graphml", "--budget", "12", "--start", "Gate")],
)
def test_check_reads_the_walk_that_plan_prints(run, tmp_path, arguments):
    printed = run("graphdrl", "plan", *arguments, "--walk").stdout
    (tmp_path / "walk.txt").write_text(printed)
    checked = run("graphdrl", "check", arguments[0], tmp_path / "walk.txt", "--budget", arguments[2]).stdout
    visited = re.search(r"visited +(\d+ of \d+) nodes", printed)[1]
    assert f"visited {visited} nodes" in checked
    assert run("graphdrl", "plan", *arguments, "--walk", "--json").returncode == 2


def test_a_plan_without_cells_names_its_ends(run):
    text = run("graphdrl", "plan", ROOT / "examples/5-dot/login.dot", "--budget", "20", "--start", "start").stdout
    assert re.search(r"^walk of 17 steps to .* \(node \d+\); --walk prints them$", text, re.MULTILINE)
    assert "\n\n" not in text


def test_a_short_walk_on_a_graph_stands_on_one_line(run, tmp_path):
    (tmp_path / "graph.txt").write_text("a b\nb c\n")
    command = ["plan", tmp_path / "graph.txt", "--budget", "2"]
    assert run("graphdrl", *command).stdout.endswith("\nwalk of 2 steps: a, b, c\n")
    narrow = run("graphdrl", *command, env=os.environ | {"COLUMNS": "23"}).stdout
    assert narrow.endswith("\nwalk of 2 steps to c (node 2); --walk prints them\n")
