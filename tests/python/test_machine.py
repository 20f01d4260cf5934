"""What the machine refuses, and what it must not be asked for: threads, memory, disks, terminals."""

import gzip
import json
import os
import resource
import shutil
import signal
import struct
import subprocess
import tempfile
import time
import zlib
from pathlib import Path

import pytest

from conftest import BIN

MIB = 1 << 20


def limited(kind, amount):
    """For preexec_fn: a soft limit of the child."""
    return lambda: resource.setrlimit(kind, (amount, resource.getrlimit(kind)[1]))


def check_refused(process, *words):
    assert process.returncode == 3, (process.returncode, process.stderr)
    lines = process.stderr.splitlines()
    assert len(lines) == 1 and lines[0].startswith("graphdrl"), process.stderr
    for word in words:
        assert word in lines[0]


def png_of(width, height, bits=1):
    """A white picture of one colour, as small as PNG can make it."""

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    packer = zlib.compressobj(9)
    row = b"\0" + b"\xff" * ((width * bits + 7) // 8)
    rows = b"".join(packer.compress(row) for _ in range(height)) + packer.flush()
    header = struct.pack(">IIBBBBB", width, height, bits, 0, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", rows) + chunk(b"IEND", b"")


# Threads


def test_threads_that_cannot_be_made(run):
    tight = {"preexec_fn": limited(resource.RLIMIT_AS, 500_000 << 10)}
    check_refused(
        run("graphdrl", "plan", "paper:a", "--budget", "25", "--threads", "1024", **tight),
        "cannot make 1024 threads",
        "smaller --threads",
    )
    for arguments in (["--help"], ["--version"], ["plan", "--help"], ["maps", "info", "paper:a"]):
        assert run("graphdrl", *arguments, **tight).returncode == 0


@pytest.mark.skipif(os.getuid() != 0, reason="only root may become another user")
def test_a_user_with_few_processes():
    def become_nobody():
        resource.setrlimit(resource.RLIMIT_NPROC, (4, 4))
        os.setgroups([])
        os.setgid(65534)
        os.setuid(65534)

    with tempfile.TemporaryDirectory() as folder:
        os.chmod(folder, 0o755)
        program = shutil.copy(BIN / "graphdrl", folder)

        def as_nobody(*arguments):
            command = [program, *arguments]
            return subprocess.run(
                command, capture_output=True, text=True, preexec_fn=become_nobody, timeout=300, cwd="/"
            )

        assert as_nobody("--help").returncode == 0
        assert as_nobody("plan", "paper:a", "--budget", "25", "--threads", "1").returncode == 0
        check_refused(as_nobody("plan", "paper:a", "--budget", "25", "--threads", "64"), "cannot make 64 threads")


# Memory


@pytest.fixture(scope="module")
def grid(tmp_path_factory):
    path = tmp_path_factory.mktemp("memory") / "grid.txt"
    side = 150
    path.write_text(
        "".join("".join("#" if (7 * r + 3 * c) % 11 == 0 else "." for c in range(side)) + "\n" for r in range(side))
    )
    return path


PLANS = {
    "search": ["--policy", "search", "--iterations", "20000", "--budget", "2000"],
    "beam": ["--policy", "beam", "--budget", "120"],
    "nearest": ["--policy", "nearest", "--budget", "1x"],
    "explorer": ["--policy", "explorer", "--budget", "60"],
    "png": ["--policy", "nearest", "--budget", "1x", "--out", "plan.png", "--out", "plan.html"],
}


def seen(process):
    """What a plan says, but for the time that it took."""
    plan = json.loads(process.stdout)
    del plan["elapsed_s"]
    return plan


@pytest.mark.parametrize("name", [*PLANS, "exact", "bound"])
def test_plans_within_any_memory(run, tmp_path, grid, name):
    if name == "exact":
        command = ["plan", "paper:j", "--policy", "exact", "--budget", "25", "--json"]
    elif name == "bound":
        command = ["plan", "paper:c", "--policy", "search", "--budget", "12", "--end", "start", "--json"]
    else:
        command = ["plan", grid, *PLANS[name], "--json"]
    whole = run("graphdrl", *command, "--threads", "2", cwd=tmp_path)
    assert whole.returncode == 0, whole.stderr
    for made in tmp_path.iterdir():
        made.unlink()
    fitted = 0
    for megabytes in (0.1, 1, 2, 3, 4, 6, 8, 10, 12, 14, 16, 20, 24, 28, 32, 40, 48, 64, 96, 128, 256, 1024):
        limit = f"{megabytes}M"
        process = run("graphdrl", *command, "--threads", "2", "--memory-limit", limit, cwd=tmp_path)
        if process.returncode == 0:
            fitted += 1
            assert seen(process) == seen(whole) and process.stderr == ""
        elif process.stdout:  # there was a plan, and a file that could not be made
            assert process.returncode == 3 and seen(process) == seen(whole)
            assert all("out of memory" in line for line in process.stderr.splitlines())
        else:
            assert process.returncode == 3 and process.stderr, (limit, process.returncode, process.stderr)
            for line in process.stderr.splitlines():  # one for each file and for the plan
                assert line.endswith(
                    (
                        f"out of memory: expected a larger --memory-limit, got {limit}",
                        "a smaller --threads, or more memory",
                    )
                )
        for made in tmp_path.iterdir():  # whole, or not there
            assert made.read_bytes().rstrip().endswith({".png": b"IEND\xaeB`\x82", ".html": b"</html>"}[made.suffix])
            made.unlink()
    assert 0 < fitted < 22


@pytest.mark.parametrize("preset", ["paper", "explorer"])
def test_trainings_within_any_memory(run, tmp_path, preset):
    short = {
        "paper": ["--episodes", "2", "--batch-size", "8"],
        "explorer": ["--rounds", "1", "--walks", "4", "--updates", "4", "--largest", "5"],
    }
    command = ["train", "--preset", preset, *short[preset], "--threads", "1"]
    whole = run("graphdrl", *command, "--out", tmp_path / "whole")
    assert whole.returncode == 0, whole.stderr
    fitted = 0
    for megabytes in (1, 2, 4, 8, 12, 16, 24, 32, 48, 64, 128, 256, 1024):
        folder = tmp_path / str(megabytes)
        process = run("graphdrl", *command, "--out", folder, "--memory-limit", f"{megabytes}M")
        if process.returncode == 0:
            fitted += 1
            policy = (folder / "policy.safetensors").read_bytes()
            assert policy == (tmp_path / "whole/policy.safetensors").read_bytes()
        else:
            assert process.returncode == 3, (megabytes, process.returncode, process.stderr)
            assert f"out of memory: expected a larger --memory-limit, got {megabytes}M" in process.stderr
            if (folder / "checkpoint.safetensors").exists():  # nothing of it is half-written
                assert run("graphdrl", "train", "--resume", folder, "--threads", "1").returncode == 0
                assert (folder / "policy.safetensors").read_bytes() == (
                    tmp_path / "whole/policy.safetensors"
                ).read_bytes()
    assert fitted > 0


def test_memory_limits_have_a_unit(run):
    for size in ("500M", "0.5G", "536870912", "512MiB", "1T"):
        assert (
            run("graphdrl", "evaluate", "--maps", "paper:a", "--policy", "nearest", "--memory-limit", size).returncode
            == 0
        )
    for size in ("", "x", "5X", "-1G", "0", "1e99", "G", "nan", "inf", "1" * 60):
        process = run("graphdrl", "plan", "paper:a", "--budget", "25", "--memory-limit", size)
        assert process.returncode == 2 and "500M or 2G" in process.stderr, size


def test_a_shells_limit_stays(run, tmp_path):
    (tmp_path / "large.txt").write_text(("." * 3000 + "\n") * 3000)  # a world of 500 MB
    # OpenBLAS reserves 256 MB as it is loaded, and tries for ever where it cannot.
    tight = {"preexec_fn": lambda: resource.setrlimit(resource.RLIMIT_DATA, (350 * MIB, 350 * MIB))}
    command = ["plan", tmp_path / "large.txt", "--policy", "nearest", "--budget", "9", "--threads", "1"]
    check_refused(run("graphdrl", *command, "--memory-limit", "2G", **tight), "out of memory")
    check_refused(run("graphdrl", *command, **tight), "out of memory")


# Files


def test_outputs_are_tried_before_the_work(run, tmp_path):
    (tmp_path / "taken.json").mkdir()
    (tmp_path / "old.csv").write_text("old")
    long = [
        "plan",
        "paper:a",
        "--budget",
        "25",
        "--time-limit",
        "1000",
        "--policy",
        "search",
        "--iterations",
        "2000000000",
    ]
    for bad in ("missing/x.json", "taken.json", "x.unknown", "n" * 300 + ".json", "old.csv/x.json"):
        process = run("graphdrl", *long, "--out", "old.csv", "--out", bad, cwd=tmp_path)
        assert process.returncode == 2 and process.stdout == "" and len(process.stderr.splitlines()) == 1
        assert bad[:50] in process.stderr
    for arguments in (
        ["report", "missing.json", "--out", "missing/x.html"],
        ["results", "missing", "--figure", "missing/x.svg"],
        ["results", "missing", "--into", "missing/x.md"],
        ["results", "missing", "--into", "old.csv"],
        ["export", "missing.safetensors", "-o", "missing/x.onnx"],
        ["check", "missing.txt", "missing.csv", "--out", "missing/x.json"],
        ["maps", "convert", "missing.txt", "--out", "missing/x.txt"],
        ["maps", "show", "missing.txt", "--png", "missing/x.png"],
    ):
        process = run("graphdrl", *arguments, cwd=tmp_path)
        assert process.returncode == 2 and (
            "missing/x" in process.stderr or "no place" in process.stderr
        ), process.stderr
    assert sorted(os.listdir(tmp_path)) == ["old.csv", "taken.json"] and (tmp_path / "old.csv").read_text() == "old"


def test_a_plan_is_not_lost_where_a_file_cannot_be_written(run, tmp_path):
    small = {"preexec_fn": limited(resource.RLIMIT_FSIZE, 2000), "cwd": tmp_path}
    (tmp_path / "plan.png").write_text("old")
    outputs = ["--out", "plan.png", "--out", "plan.html", "--out", "plan.csv"]
    process = run("graphdrl", "plan", "paper:a", "--budget", "25", "--policy", "nearest", "--json", *outputs, **small)
    assert process.returncode == 3 and json.loads(process.stdout)["visited"] > 0
    said = process.stderr.splitlines()
    assert len(said) == 2 and "plan.png" in said[0] and "plan.html" in said[1] and "too large" in said[0]
    assert (tmp_path / "plan.csv").read_text().startswith("step,node")
    assert (tmp_path / "plan.png").read_text() == "old" and sorted(os.listdir(tmp_path)) == ["plan.csv", "plan.png"]


def test_a_full_standard_output(tmp_path):
    plan = ["plan", "paper:a", "--budget", "25", "--out", tmp_path / "plan.json"]
    for arguments in (["--help"], plan, ["maps", "info", "paper"]):
        with open("/dev/full", "w") as full:
            command = [BIN / "graphdrl", *arguments]
            process = subprocess.run(command, stdout=full, stderr=subprocess.PIPE, text=True, check=False)
        check_refused(process, "cannot write to standard output", "No space left")
    assert json.loads((tmp_path / "plan.json").read_text())["visited"] > 0


def test_escape_codes_stay_out_of_the_terminal(run, tmp_path):
    for code in ("\033[31m", "\u009b31m", "\a"):
        name = f"m{code}ap.txt"
        (tmp_path / name).write_text("...\n.#.\n")
        policy = f"p{code}.safetensors"
        for arguments in (
            ["plan", name, "--budget", "3"],
            ["plan", name, "--budget", "3", "--json"],
            ["plan", name, "--budget", "3", "--out", f"{code}/x.json"],
            ["plan", name, "--budget", "3", "--walk"],
            ["maps", "show", name],
            ["maps", "info", name],
            ["maps", "convert", name, "--out", f"{code}.map"],
            ["evaluate", "--maps", name, "--policy", "nearest"],
            ["evaluate", "--maps", name, "--policy", "nearest", "--json"],
            ["plan", "paper:a", "--budget", "25", "--policy", policy],
            ["maps", "generate", "obstacles", "--size", "4", "--count", "1", "--out", f"o{code}"],
            ["train", "--preset", "paper", "--episodes", "1", "--batch-size", "2", "--out", f"run{code}"],
            ["train", "--resume", f"run{code}"],
        ):
            process = run("graphdrl", *arguments, cwd=tmp_path)
            shown = process.stdout + process.stderr
            assert code not in shown and "\033" not in shown, (arguments, shown)
            if arguments[0] == "train":
                assert process.returncode == 0, process.stderr
        shutil.rmtree(tmp_path / f"run{code}")


# Signals


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_a_plan_lets_signals_ignored_before(number, grid):
    def ignore():
        signal.signal(number, signal.SIG_IGN)

    command = [BIN / "graphdrl", "plan", grid, "--budget", "3000", "--time-limit", "2", "--json", "--threads", "1"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, preexec_fn=ignore) as process:
        status = Path(f"/proc/{process.pid}/status")
        for _ in range(8):
            time.sleep(0.1)
            if process.poll() is None:
                ignored = int(status.read_text().split("SigIgn:")[1].split()[0], 16)
                assert ignored >> (number - 1) & 1
                process.send_signal(number)
        assert json.loads(process.stdout.read())["visited"] > 0
    assert process.returncode == 0


# Readers


def test_small_files_ask_for_little_memory(run, tmp_path):
    files = {
        "claims.oplib": b"NAME : a\nTYPE : OP\nDIMENSION : 20000\nCOST_LIMIT : 9\nEDGE_WEIGHT_TYPE : EXPLICIT\n"
        b"EDGE_WEIGHT_FORMAT : FULL_MATRIX\nEDGE_WEIGHT_SECTION\n0 1\n",
        "vast.png": png_of(10_000, 10_000),
        "vast8.png": png_of(10_000, 10_000, bits=8),
        "vast.pgm": b"P5 10000 10000 255\n",
        "vast.txt.gz": gzip.compress((b"." * 9_999 + b"\n") * 9_999),
        "bits.pbm.gz": gzip.compress(b"P4 11000 11000\n" + bytes(1375 * 11_000)),
        "claims.net": b"*Vertices 2000000000\n*Edges\n1 2\n",
        "claims.gr": b"p sp 2000000000 1\na 1 2 1\n",
        "claims.graph": b"900000000 1\n2\n1\n",
        "claims.map": b"type octile\nheight 40000\nwidth 50000\nmap\n..\n",
        "team.txt": b"n 100000\nm 1\ntmax 9\n0 0 1\n",
        "claims.npy": b"\x93NUMPY\x01\0v\0"
        + b"{'descr': '|u1', 'fortran_order': False, 'shape': (20000, 20000), }".ljust(117)
        + b"\n",
        "ragged.txt": b"." * 40_000 + b"\n" * 40_000,
        "deep.json": b"[" * 1_000_000,
        "alias.yaml": b"image: a.png\nresolution: 1\na: &a [x,x,x,x,x,x,x,x,x]\n"
        + b"".join(
            b"%c: &%c [%s]\n" % (n + 1, n + 1, b",".join([b"*%c" % n] * 9)) for n in range(ord("a"), ord("j"))
        ),
        "long.yaml": b"image: a.png\nresolution: 1\nx: [" + b"[]," * 1_000_000 + b"]\n",
    }
    for name, content in files.items():
        (tmp_path / name).write_bytes(content)
        process = run("graphdrl", "plan", tmp_path / name, "--memory-limit", "60M")
        assert process.returncode == 2, (name, process.returncode, process.stderr)
        assert name not in ("vast.png", "vast8.png") or "--cell-pixels" in process.stderr


def test_blank_maps_are_read(run, tmp_path):
    (tmp_path / "blank.png").write_bytes(png_of(2000, 2000))
    assert run("graphdrl", "maps", "convert", tmp_path / "blank.png", "--out", tmp_path / "blank.txt").returncode == 0
    assert (tmp_path / "blank.txt").read_text() == ("." * 2000 + "\n") * 2000
    (tmp_path / "plan.png").write_bytes(png_of(5000, 5000))
    (tmp_path / "plan.yaml").write_text("image: plan.png\nresolution: 0.05\norigin: [0, 0, 0]\n")
    process = run("graphdrl", "maps", "show", tmp_path / "plan.yaml")
    assert process.returncode == 2 and "--cell-size" in process.stderr
    coarser = ["--cell-size", "1", "--out", tmp_path / "plan.txt"]
    assert run("graphdrl", "maps", "convert", tmp_path / "plan.yaml", *coarser).returncode == 0
    assert (tmp_path / "plan.txt").read_text() == ("." * 250 + "\n") * 250
