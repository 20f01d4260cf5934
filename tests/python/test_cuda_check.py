"""benchmarks/cuda_check, on the CPU: the script works where a GPU is at last at hand."""

import json
import os
import pathlib
import subprocess

ROOT = pathlib.Path(__file__).resolve().parents[2]
BIN = pathlib.Path(os.environ["GRAPHDRL_BIN"])


def test_the_check_of_cuda_runs_on_the_cpu():
    sizes = ["--seeds", "1,2", "--episodes", "2", "--cpu-episodes", "10"]
    command = [ROOT / "benchmarks/cuda_check", "--bin", BIN, "--device", "cpu", *sizes]
    report = json.loads(subprocess.run(command, stdout=subprocess.PIPE, check=True).stdout)
    assert report["tests"] == "passed"
    assert report["losses"]["difference"] == [0] and report["losses"]["cpu"][0] > 0
    assert [run["seeds"] for run in report["runs"]] == [1, 2]
    assert all(run["minutes_of_full_runs"] > 0 for run in report["runs"])
    assert set(report["quality"]["float32"]) == {"paper:a", "unseen"}
