"""The examples of `graphdrl explore --live`: what they find in a state machine, in a program's menus, in a web shop."""

import json
import os
import pathlib
import re
import subprocess
import sys

import pytest

from conftest import BIN, ROOT
from programs import require_program

EXAMPLES = ROOT / "examples" / "live"
MACHINE = """digraph door {
  __start0 [label="" shape="none"];
  open -> closed [label="close / done"];
  open -> open [label="lock / no"];
  open -> broken [label="kick / noise"];
  closed -> open [label="open/done"];
  closed -> locked [label="lock/done"];
  locked -> closed [label="unlock/done"];
  locked -> alarm [label="kick/noise"];
  alarm -> alarm [label="kick/noise"];
  forgotten -> open [label="open/done"];
  __start0 -> closed;
}
"""


def start_example(name, *arguments, folder, **variables):
    return subprocess.run(
        [sys.executable, EXAMPLES / name, *map(str, arguments)],
        capture_output=True,
        text=True,
        cwd=folder,
        env=os.environ | {"GRAPHDRL_BIN": str(BIN.resolve()), "PYTHONDONTWRITEBYTECODE": "1"} | variables,
        timeout=120,
        check=False,
    )


def run_example(name, *arguments, folder, **variables):
    done = start_example(name, *arguments, folder=folder, **variables)
    assert done.returncode == 0, done.stderr
    return done.stdout.splitlines()


@pytest.fixture
def machine(tmp_path):
    path = tmp_path / "door.dot"
    path.write_text(MACHINE)
    return path


@pytest.fixture
def browser():
    """What `web.py` needs of the environment."""
    chromium = require_program("chromium", "--version", "^Chromium ")
    driver = require_program("chromedriver", "--version", "^ChromeDriver ")
    folders = [str(pathlib.Path(program).parent) for program in (chromium, driver)]
    return {"PATH": os.pathsep.join([*folders, os.environ["PATH"]])}


# --- A state machine ---------------------------------------------------------------------------------------------


def test_all_of_a_machine_is_seen_that_can_be_reached(machine, tmp_path):
    lines = run_example("machine.py", machine, "--out", "seen.json", "--transcript", "door.log", folder=tmp_path)
    # No input leads out of an alarm, nor out of a broken door.
    assert lines[0].startswith("covered after ") and lines[0].endswith(" of which 1 are resets")
    assert lines[1] == "5 of 5 states, 8 of 8 transitions"
    assert (tmp_path / "seen.json").stat().st_size > 0
    turns = [json.loads(line) for line in (tmp_path / "door.log").read_text().splitlines()[1:]]
    assert turns[0]["message"]["state"] == "closed" and turns[0]["message"]["moves"] == ["open", "lock"]


def test_the_login_is_a_machine_too(tmp_path):
    lines = run_example("machine.py", ROOT / "examples" / "5-dot" / "login.dot", folder=tmp_path)
    assert lines[1] == "12 of 12 states, 20 of 20 transitions"


def test_what_is_left_of_a_machine_is_told_by_the_status(machine, tmp_path):
    done = start_example("machine.py", machine, "--budget", 3, folder=tmp_path)
    assert done.returncode == 1
    assert done.stdout.splitlines()[0] == "budget after 3 steps, of which 0 are resets"


# --- Menus -------------------------------------------------------------------------------------------------------


def test_menus_are_found_with_what_is_odd_about_them(tmp_path):
    assert run_example("menus.py", "--out", "phone.html", folder=tmp_path) == [
        "unreachable: 9 menus, 25 choices that work",
        "menus: Clock, Contacts, Inbox, Messages, Radio, Radio setup, Settings, Sound, Telephone",
        "failed 3 times: '4 Camera' of Telephone",
        "changed: '5 Radio' of Telephone led to Radio setup, then to Radio",
    ]
    assert "Radio setup" in (tmp_path / "phone.html").read_text(encoding="utf-8")


@pytest.mark.parametrize("policy", ["nearest", "dfs", "frontier"])
def test_other_policies_find_the_same_in_menus(policy, tmp_path):
    lines = run_example("menus.py", "--policy", policy, folder=tmp_path)
    assert lines[0] == "unreachable: 9 menus, 25 choices that work" and len(lines) == 4


# --- A web shop --------------------------------------------------------------------------------------------------


def test_a_shop_is_found_with_what_is_wrong_with_it(browser, tmp_path):
    assert run_example("web.py", folder=tmp_path, **browser) == [
        "unreachable: 14 pages, 34 links that work",
        "pages: / /account /books /books/atlas /cart /checkout /help /help/shipping /login /orders /thanks /toys "
        "/toys/kite /toys/robot",
        "failed 3 times: 'Returns' of /help",
        "changed: 'My account' of / led to /account, then to /login",
    ]


def test_a_shop_that_runs_elsewhere_is_explored_from_any_page(browser, tmp_path):
    with subprocess.Popen([sys.executable, EXAMPLES / "shop.py"], stdout=subprocess.PIPE, text=True) as shop:
        try:
            url = shop.stdout.readline().strip()
            lines = run_example("web.py", "--url", f"{url}orders", "--budget", 5, folder=tmp_path, **browser)
            refused = start_example("web.py", "--url", f"{url}help/returns", folder=tmp_path, **browser)
        finally:
            shop.terminate()
    assert lines[0].startswith("budget: ") and "/orders" in lines[1].split()
    assert refused.returncode == 1 and refused.stderr == f"{url}help/returns: there is no such page\n"


# --- A robot -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("policy", ["tour", "nearest"])
def test_a_robot_sees_the_whole_floor(policy, tmp_path):
    floor = ROOT / "examples" / "2-ros" / "floor.yaml"
    lines = run_example("robot.py", floor, "--policy", policy, "--out", "floor.html", folder=tmp_path)
    ends = re.fullmatch(r"covered after ([0-9.]+) m: 4803 of 4803 free cells seen", lines[0])
    assert 60 < float(ends[1]) < 90
    assert (tmp_path / "floor.html").exists()


def test_a_robot_comes_home_within_its_budget(tmp_path):
    floor = ROOT / "examples" / "2-ros" / "floor.yaml"
    done = start_example("robot.py", floor, "--budget", "30", "--end", "start", "--out", "seen.txt", folder=tmp_path)
    assert done.returncode == 1
    assert re.match(r"budget after (29|30)\.\d m", done.stdout)
    seen = (tmp_path / "seen.txt").read_text()
    assert f"{seen.count('.')} of 4803 free cells seen" in done.stdout


# --- What goes wrong ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["machine.py", "menus.py", "robot.py", "web.py"])
def test_one_line_says_that_the_program_is_missing(name, machine, tmp_path):
    arguments = [machine] if name in ("machine.py", "robot.py") else []
    done = start_example(name, *arguments, folder=tmp_path, GRAPHDRL_BIN=str(tmp_path))
    assert (done.returncode, done.stdout) == (1, "")
    assert done.stderr == f"{tmp_path / 'graphdrl'}: No such file or directory\n"


def test_what_the_program_refuses_it_says_itself(machine, tmp_path):
    done = start_example("machine.py", machine, "--policy", "exact", folder=tmp_path)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.startswith("graphdrl: the policy does not explore") and done.stderr.count("\n") == 1


def test_one_line_says_that_there_is_no_machine(tmp_path):
    (tmp_path / "empty.dot").write_text("digraph {}\n")
    for name, why in (("none.dot", "No such file"), ("empty.dot", "no edges")):
        done = start_example("machine.py", name, folder=tmp_path)
        assert done.returncode == 1 and why in done.stderr and done.stderr.count("\n") == 1


def test_one_line_says_that_there_is_no_browser(tmp_path):
    done = start_example("web.py", folder=tmp_path, PATH=str(tmp_path))
    assert done.returncode == 1
    assert done.stderr == "there is no chromium, or no chromedriver, on the PATH\n"
