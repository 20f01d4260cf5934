"""What the Python tests share: the programs under test, blocks of the docs, a reader of safetensors files."""

import fcntl
import json
import os
import pathlib
import re
import signal
import struct
import subprocess

import numpy
import pytest

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
BIN = pathlib.Path(os.environ["GRAPHDRL_BIN"])
TRAINING = ["train", "--episodes", "25", "--batch-size", "8"]  # of the fixture `trained`
WITH_TORCH = (BIN / "graphdrl-train").exists()  # the build has LibTorch, and OpenBLAS with it
DTYPES = {"F32": "<f4", "F64": "<f8", "I32": "<i4", "I64": "<i8", "U8": "u1", "U16": "<u2", "U64": "<u8"}
# What is started in the background ignores Ctrl-C, and so would all that the tests start.
signal.signal(signal.SIGINT, signal.default_int_handler)


def python_blocks(document):
    """Line, code and, where a ```text block follows at once, what it prints."""
    text = (ROOT / document).read_text(encoding="utf-8")
    for block in re.finditer(r"^```python\n(.*?)^```\n(?:\n```text\n(.*?)^```\n)?", text, re.DOTALL | re.MULTILINE):
        yield text.count("\n", 0, block.start(1)), block[1], block[2]


def read_safetensors(path):
    """Gives the tensors by name, and the metadata."""
    content = pathlib.Path(path).read_bytes()
    (length,) = struct.unpack("<Q", content[:8])
    header = json.loads(content[8 : 8 + length])
    metadata = header.pop("__metadata__", {})
    data = content[8 + length :]
    tensors = {}
    for name, entry in header.items():
        begin, end = entry["data_offsets"]
        tensors[name] = numpy.frombuffer(data[begin:end], DTYPES[entry["dtype"]]).reshape(entry["shape"]).copy()
    return tensors, metadata


@pytest.fixture
def run():
    """Runs a program of the build; gives the finished process, with its output as text."""

    def call(program, *arguments, **options):
        command = [BIN / program, *map(str, arguments)]
        return subprocess.run(command, capture_output=True, text=True, timeout=300, check=False, **options)

    return call


@pytest.fixture(scope="session")
def trained(tmp_path_factory):
    """A short run and its summary, for tests that need files of a training: one for all of pytest's processes."""
    base = tmp_path_factory.getbasetemp()
    if "PYTEST_XDIST_WORKER" in os.environ:
        base = base.parent
    folder, summary = base / "trained", base / "trained.json"
    with (base / "trained.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not summary.exists():
            command = [BIN / "graphdrl", *TRAINING, "--out", folder, "--json"]
            process = subprocess.run(command, capture_output=True, text=True, timeout=300, check=True)
            summary.write_text(process.stdout)
    return folder, json.loads(summary.read_text())
