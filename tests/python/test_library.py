"""The installed library: headers, CMake's and pkg-config's files, examples in C, C++ and ctypes; manuals; packages."""

import json
import os
import pathlib
import re
import shlex
import subprocess

import pytest
from conftest import BIN
from programs import find_program, require_program

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
EXAMPLES = ROOT / "examples" / "library"

# One of pytest's processes installs and builds for all of them.
pytestmark = pytest.mark.xdist_group("library")


def call(*command, **options):
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True, check=False, **options)
    assert done.returncode == 0, f"{command}\n{done.stdout}\n{done.stderr}"
    return done.stdout


@pytest.fixture(scope="module")
def prefix(tmp_path_factory):
    """What `cmake --install` installs."""
    folder = tmp_path_factory.mktemp("prefix")
    call("cmake", "--install", BIN.parent, "--prefix", folder)
    return folder


def environment(prefix):
    return os.environ | {
        "LD_LIBRARY_PATH": str(prefix / "lib"),
        "PKG_CONFIG_PATH": str(prefix / "lib" / "pkgconfig"),
        "PATH": f"{prefix / 'bin'}:{os.environ['PATH']}",
    }


@pytest.fixture(scope="module")
def built(prefix, tmp_path_factory):
    """The examples, built as their users would."""
    folder = tmp_path_factory.mktemp("examples")
    call("cmake", "-S", EXAMPLES, "-B", folder, f"-DCMAKE_PREFIX_PATH={prefix}")
    call("cmake", "--build", folder)
    return folder


def test_the_c_example_has_no_leak_and_no_error(built):
    valgrind = find_program("valgrind", "--version", "^valgrind-")
    checked = [valgrind, "-q", "--leak-check=full", "--show-leak-kinds=definite,possible", "--error-exitcode=9"]
    text = call(*(checked if valgrind else []), built / "plan_in_c")
    assert "5 doors in 11.5 of 12 minutes; no walk reaches more than 5: this one is the best" in text


def test_the_cpp_example_plans_and_refuses(built, run, tmp_path):
    text = call(built / "plan_in_cpp", "paper:c", tmp_path / "c.svg")
    assert text == "paper:c: 16 of 18 nodes in 16 steps; no walk visits more than 16\n"
    assert "</svg>" in (tmp_path / "c.svg").read_text()
    for arguments in (["no-such-map"], ["paper:a", tmp_path / "walk.what"], []):
        done = subprocess.run([built / "plan_in_cpp", *arguments], capture_output=True, text=True, check=False)
        assert done.returncode == 2
        assert done.stderr.splitlines()[-1].startswith("plan_in_cpp: ")


def test_pkg_config_builds_c99_and_cpp17(prefix, tmp_path):
    pkg_config = require_program("pkg-config", "--version", r"^\d+\.\d+")
    flags = call(pkg_config, "--cflags", "--libs", "graphdrl", env=environment(prefix)).split()
    strict = ["-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror"]
    call("cc", "-std=c99", *strict, EXAMPLES / "plan.c", *flags, "-o", tmp_path / "c")
    call("c++", "-std=c++17", *strict, EXAMPLES / "plan.cpp", *flags, "-o", tmp_path / "cpp")
    assert "doors" in call(tmp_path / "c", env=environment(prefix))


def test_ctypes_gives_the_programs_walk(prefix, run):
    text = call("/usr/bin/python3", EXAMPLES / "plan_by_ctypes.py", env=environment(prefix))
    plan, error = text.splitlines()
    expected = json.loads(run("graphdrl", "plan", "paper:b", "--budget", 20, "--json").stdout)
    assert json.loads(plan)["walk"] == expected["walk"]
    assert error.startswith("and what goes wrong is said: no such map")


def test_the_library_shows_its_interface_alone(prefix):
    lines = call("nm", "-D", "--defined-only", "--with-symbol-versions", prefix / "lib" / "libgraphdrl.so").splitlines()
    shown = {line.split()[-1].split("@")[0] for line in lines}
    header = (ROOT / "include" / "graphdrl" / "graphdrl_c.h").read_text()
    declared = set(re.findall(r"^GRAPHDRL_API [^(]*?(graphdrl_\w+)\(", header, re.MULTILINE))
    assert shown == declared and len(declared) > 15


def test_another_version_is_not_found(prefix, tmp_path):
    (tmp_path / "CMakeLists.txt").write_text(
        "cmake_minimum_required(VERSION 3.16)\nproject(p LANGUAGES CXX)\nfind_package(graphdrl 0.2 REQUIRED)\n"
    )
    command = ["cmake", "-S", tmp_path, "-B", tmp_path / "build", f"-DCMAKE_PREFIX_PATH={prefix}"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode != 0 and "considered but not accepted" in done.stderr


def test_every_command_has_a_manual_page(prefix, run):
    pages = {page.stem for page in (prefix / "share" / "man" / "man1").iterdir()}
    commands = re.findall(r"^  (\w+) ", run("graphdrl", "--help").stdout.split("Subcommands:")[1], re.MULTILINE)
    maps = re.findall(r"^  (\w+) ", run("graphdrl", "maps", "--help").stdout.split("Subcommands:")[1], re.MULTILINE)
    expected = {"graphdrl"} | {f"graphdrl-{name}" for name in commands} | {f"graphdrl-maps-{name}" for name in maps}
    assert pages == expected and len(commands) >= 10
    plan = (prefix / "share" / "man" / "man1" / "graphdrl-plan.1").read_text()
    train = (prefix / "share" / "man" / "man1" / "graphdrl-train.1").read_text()
    assert r"\fB\-\-time\-limit\fR" in plan and r"\fB\-\-learning\-rate\fR" in train
    if man := find_program("man", "--version", r"^man \d"):
        for page in pages:
            file = prefix / "share" / "man" / "man1" / f"{page}.1"
            done = subprocess.run([man, "--warnings", "-l", file], capture_output=True, text=True, check=False)
            assert done.returncode == 0 and done.stderr == "", page


def test_bash_completes_commands_options_and_values(prefix, run):
    script = prefix / "share" / "bash-completion" / "completions" / "graphdrl"
    assert script.read_text() == run("graphdrl", "completion", "bash").stdout

    def completed(*words):
        line = " ".join(f"'{word}'" for word in words)
        return call(
            "bash",
            "-c",
            f"source {shlex.quote(str(script))}; COMP_WORDS=({line}); COMP_CWORD={len(words) - 1}; _graphdrl; "
            'printf "%s\\n" "${COMPREPLY[@]}"',
        ).split()

    assert completed("graphdrl", "pl") == ["plan"]
    assert completed("graphdrl", "maps", "c") == ["convert"]
    assert completed("graphdrl", "plan", "paper:a", "--time") == ["--time-limit"]
    assert completed("graphdrl", "train", "--teacher-s") == ["--teacher-steps"]
    assert completed("graphdrl", "maps", "info", "x", "--connectivity", "") == ["4", "8"]


@pytest.mark.parametrize("shell, answer", [("zsh", r"^zsh \d"), ("fish", "^fish, version")])
def test_other_shells_take_their_completions(shell, answer, run, tmp_path):
    done = run("graphdrl", "completion", shell)
    assert "time-limit" in done.stdout and "generate" in done.stdout
    assert shell != "zsh" or "'*--policy[" in done.stdout  # may be given again
    if program := find_program(shell, "--version", answer):
        (tmp_path / "script").write_text(done.stdout)
        call(program, "-n", tmp_path / "script")


def test_completion_refuses_what_it_does_not_know(run):
    for arguments in ([], ["csh"], ["bash", "--install", "x"]):
        done = run("graphdrl", "completion", *arguments)
        assert done.returncode == 2 and len(done.stderr.splitlines()) == 1


def test_debian_packages_hold_what_they_should(tmp_path):
    call("cpack", "-G", "DEB", "-B", tmp_path, cwd=BIN.parent)
    files, needs = {}, {}
    for package in tmp_path.glob("*.deb"):
        name = package.name.split("_")[0]
        files[name] = {line.split()[5] for line in call("dpkg-deb", "--contents", package).splitlines()}
        needs[name] = call("dpkg-deb", "--field", package, "Depends")
    assert set(files) == {"graphdrl", "libgraphdrl0.1", "libgraphdrl-dev"}
    assert {"./usr/bin/graphdrl", "./usr/share/man/man1/graphdrl-plan.1"} <= files["graphdrl"]
    assert any(path.startswith("./usr/lib/libgraphdrl.so.0.1") for path in files["libgraphdrl0.1"])
    assert {"./usr/include/graphdrl/graphdrl.h", "./usr/lib/pkgconfig/graphdrl.pc"} <= files["libgraphdrl-dev"]
    assert needs["libgraphdrl-dev"].startswith("libgraphdrl0.1 (= ")
    assert "libtbb12" in needs["libgraphdrl0.1"] and "libc6" in needs["graphdrl"]
    assert all(f"./usr/share/doc/{name}/copyright" in paths for name, paths in files.items())
