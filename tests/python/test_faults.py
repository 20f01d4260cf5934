"""Every command that writes, while its calls that change files fail one after the other: the exit status does not lie,
no half file stays, files that were there are the old ones or the new ones. And trainings that are killed.

Of commands with many such calls, and of trainings, this takes a sample; with GRAPHDRL_FAULTS=all (scripts/drill
--faults) all of them."""

import dataclasses
import importlib.machinery
import importlib.util
import os
import re
import shutil
import subprocess
import sys

import pytest

from conftest import BIN, ROOT

ALL = os.environ.get("GRAPHDRL_FAULTS") == "all"
MACHINE = 3  # the exit status where the machine refuses
FAULTS = ("ENOSPC", "EIO", "EROFS", "half-ENOSPC")
SQUARE = """{"directed": false, "multigraph": false, "graph": {}, "nodes": [{"id": 0, "x": 0, "y": 0},
 {"id": 1, "x": 1, "y": 0}, {"id": 2, "x": 1, "y": 1}, {"id": 3, "x": 0, "y": 1}],
 "links": [{"source": 0, "target": 1}, {"source": 1, "target": 2}, {"source": 2, "target": 3}]}"""
VARIES = re.compile(rb'"elapsed_s": ?[\d.e+-]+|nonce[-=]"?[\w+/=]+')  # what plans take; numbers of pages
PLACE = "# Mine\n\n<!-- table -->\nold\n<!-- end of table -->\n\nThe end.\n"


def load_drill():
    loader = importlib.machinery.SourceFileLoader("drill", str(ROOT / "scripts" / "drill"))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader("drill", loader))
    sys.modules["drill"] = module
    loader.exec_module(module)
    return module


drill = load_drill()


@dataclasses.dataclass(frozen=True)
class Command:
    """A command that writes into the current folder. Its other files stand in ../in."""

    arguments: str
    outputs: tuple[str, ...] = ()  # where there are several, all are tried; () where it writes a folder
    old: dict[str, str] | None = dataclasses.field(default_factory=dict)  # what must stand there; None: nothing may


def plan(*outputs, map_name="paper:a"):
    options = " ".join(f"--out {output}" for output in outputs)
    return Command(f"plan {map_name} --budget 12 --iterations 20 --walk {options}", outputs)


COMMANDS = {
    "plan geojson": plan("plan.geojson", map_name="../in/square.json"),
    "plan yaml": plan("plan.yaml", map_name="../in/square.json"),
    "plan several": plan("plan.json", "plan.csv", "plan.svg"),
    "check": Command("check paper:a ../in/walk.txt --out walk.json --out walk.csv", ("walk.json", "walk.csv")),
    "report": Command("report ../in/plan.json --map paper:a --out page.html", ("page.html",)),
    "results": Command(
        "results ../in/seeds --maps ../in/tiny.txt --figure curves.svg --into page.md",
        ("curves.svg", "page.md"),
        {"page.md": PLACE},
    ),
    "export": Command("export explorer --out explorer.onnx", ("explorer.onnx",)),
    "maps show": Command("maps show paper:a --svg map.svg --png map.png", ("map.svg", "map.png")),
    "maps generate": Command("maps generate obstacles --size 5 --count 3 --out maps", (), None),
    "completion": Command("completion --install share"),
}
for _ending in ("json", "csv", "graphml", "dot", "anim.svg", "svg", "png", "html"):
    COMMANDS[f"plan {_ending}"] = plan(f"plan.{_ending}")
for _ending in ("txt", "map", "pgm", "png"):
    COMMANDS[f"maps convert {_ending}"] = Command(f"maps convert paper:a --out map.{_ending}", (f"map.{_ending}",))
for _ending in ("json", "graphml", "gml", "dot"):
    COMMANDS[f"maps convert {_ending}"] = Command(
        f"maps convert ../in/square.json --out graph.{_ending}", (f"graph.{_ending}",)
    )


@pytest.fixture(scope="module")
def given(tmp_path_factory):
    """What the commands read."""
    folder = tmp_path_factory.mktemp("given") / "in"
    folder.mkdir()
    (folder / "square.json").write_text(SQUARE)
    (folder / "walk.txt").write_text("0\n1\n2\n")
    (folder / "tiny.txt").write_text("..\n..\n")
    arguments = (
        "plan paper:a --budget 12 --iterations 20 --out plan.json",
        "train --preset paper --episodes 1 --budget 4 --batch-size 2 --seeds 1-2 --out seeds",
    )
    for one in arguments:
        done = drill.run(one.split(), folder)
        assert done.status == 0, done
    return folder


def files_in(folder):
    """The content by path, without what differs each time."""
    paths = [path for path in folder.rglob("*") if path.is_file()]
    return {str(path.relative_to(folder)): VARIES.sub(b"", path.read_bytes()) for path in paths}


def sample(things, count):
    """Evenly spread."""
    return things if ALL or len(things) <= count else things[len(things) % 7 :: -(-len(things) // count)]


def calls_in(log):
    """That change files: "NAME PATH"."""
    return log.read_text().splitlines()


def trials_of(calls):
    """Which call, from 1, what it is, how it fails, and whether all later ones do."""
    return [
        (at, call, fault, on)
        for at, call in enumerate(calls, 1)
        for fault in FAULTS
        for on in (False, True)
        if not (fault.startswith("half-") and not call.startswith("write ")) and not (on and fault == "EIO")
    ]


def words_of(at, call, fault, on):
    name, path = call.split(" ", 1)
    return f"{fault}{' from then on' if on else ''} at call {at}, {name} {os.path.basename(path)}"


def problems_of(command, done, printed, files, before, after, call, once):
    """What a command did wrong whose call failed."""
    problems = []
    if done.status not in (0, MACHINE):
        problems.append(f"status {done.status}")
    names = files.keys() | before.keys() | after.keys()
    left = {name for name in names if drill.LEFTOVER.fullmatch(os.path.basename(name))}
    if left and once and not call.startswith("unlink "):
        problems.append(f"{left} is left")
    names -= left
    new = {name for name in names if files.get(name) == after.get(name)}
    old = {name for name in names if files.get(name) == before.get(name)}
    problems += [f"{name} is neither old nor new" for name in sorted(names - old - new)]
    if done.status == 0:
        problems += [f"status 0, but {name} is not new" for name in sorted(names - new)]
        return problems
    lines = done.stderr.count("\n")
    if not done.stderr.endswith("\n") or (lines != 1 if once else not 1 <= lines <= max(1, len(command.outputs))):
        problems.append(f"{lines} lines on standard error")
    if len(command.outputs) > 1 or command.arguments.startswith(("plan", "check")):
        nothing_done = old == names and done.stdout == "" and call.startswith(("open ", "mkdir ", "chmod "))
        if done.stdout != printed and not nothing_done:
            problems.append("not printed")
        if once and len(names - new) > 1 and not nothing_done:
            problems.append(f"not all are tried: {sorted(names - new)}")
    return problems


@pytest.mark.parametrize("name", COMMANDS)
def test_no_lie_and_no_half_file_when_a_call_fails(name, given, tmp_path):
    command = COMMANDS[name]
    shutil.copytree(given, tmp_path / "in")
    folder = tmp_path / "out"
    arguments = command.arguments.split()

    def prepare(old):
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir()
        for path, content in old.items():
            (folder / path).parent.mkdir(parents=True, exist_ok=True)
            (folder / path).write_text(content)
        return files_in(folder)

    def run(**orders):
        return drill.run(arguments, folder, drill.fault_orders(folder, **orders))

    # What stands there, and the calls then: nothing that need not, or older files of all names.
    prepare(command.old or {})
    done = run(log=tmp_path / "calls")
    assert done.status == 0 and done.stderr == "", done
    after = files_in(folder)
    assert set(after) >= set(command.outputs)
    standing = [(command.old or {}, calls_in(tmp_path / "calls"))]
    if command.old is not None:
        old = {path: command.old.get(path, "old\n") for path in after}
        prepare(old)
        assert run(log=tmp_path / "more calls").status == 0 and files_in(folder) == after
        standing.append((old, calls_in(tmp_path / "more calls")))
    trials = [(old, *trial) for old, calls in standing for trial in trials_of(calls)]
    failures = []
    for old, at, call, fault, on in sample(trials, 60):
        before = prepare(old)
        failed = run(at=at, do=fault, on=int(on))
        problems = problems_of(command, failed, done.stdout, files_in(folder), before, after, call, once=not on)
        failures += [f"{words_of(at, call, fault, on)}: {problem}; {failed.last_line()}" for problem in problems]
    assert not failures, "\n".join([f"{len(failures)}", *failures[:20]])


@pytest.fixture(scope="module")
def references(tmp_path_factory):
    folder = tmp_path_factory.mktemp("references")
    made = {}

    def reference(name):
        if name not in made:
            made[name] = drill.Reference(drill.KINDS[name], folder)
        return made[name]

    return reference


@pytest.mark.parametrize("name, count", {"paper": 6, "explorer": 6, "seeds": 3, "tune": 3}.items())
def test_trainings_say_when_a_call_fails_and_go_on_to_the_same_bytes(name, count, references, tmp_path):
    reference = references(name)
    failures = []
    for number, (at, call, fault, on) in enumerate(sample(trials_of(reference.calls), count)):
        folder = tmp_path / str(number)
        folder.mkdir()
        orders = drill.fault_orders(folder, at=at, do=fault, on=int(on))
        done = drill.run(reference.kind.start(1 + number % 2), folder, orders)
        problems = []
        if done.status == 0:
            problems = reference.problems(folder, done)
        else:
            if done.status != MACHINE or len(done.notes()) != 1:
                problems.append(f"status {done.status}, {len(done.notes())} lines")
            again = drill.go_on(reference.kind, folder, 2 - number % 2, log=[])
            problems += reference.problems(folder, again)
        failures += [f"{words_of(at, call, fault, on)}: {problem}; {done.last_line()}" for problem in problems]
        shutil.rmtree(folder)
    assert not failures, "\n".join(failures[:20])


@pytest.mark.skipif(ALL, reason="scripts/drill is what runs this")
def test_a_few_kills_and_flipped_bits():
    command = [ROOT / "scripts" / "drill", "8", "--flips", "4", "--jobs", "1"]
    done = subprocess.run(command, env={**os.environ, "GRAPHDRL_BIN": str(BIN)}, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
