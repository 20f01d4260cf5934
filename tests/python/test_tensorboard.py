"""The run directory's curves, read back by TensorBoard's own reader."""

import json
import shutil
import signal
import subprocess
import time

from tensorboard.backend.event_processing.event_accumulator import EventAccumulator

from conftest import BIN


def test_events_hold_the_papers_four_curves(trained):
    folder, summary = trained
    events = EventAccumulator(str(folder))
    events.Reload()
    assert sorted(events.Tags()["scalars"]) == ["epsilon", "loss", "reward", "visited_nodes"]
    lines = [json.loads(line) for line in (folder / "metrics.jsonl").read_text().splitlines()]
    assert [line["episode"] for line in lines] == [10, 20, 25]
    assert lines[-1]["steps"] == summary["steps"] == 25 * 25
    for key in ("epsilon", "loss", "reward", "visited_nodes"):
        scalars = events.Scalars(key)
        assert [scalar.step for scalar in scalars] == [line["episode"] for line in lines]
        for scalar, line in zip(scalars, lines):
            assert abs(scalar.value - line[key]) <= 1e-6 * max(1, abs(line[key]))


def test_a_run_resumed_after_a_crash_shows_no_step_twice(run, trained, tmp_path):
    whole, _ = trained
    folder = tmp_path / "run"
    shutil.copytree(whole, folder)
    # The checkpoint of an interrupted twin, older than the curves: what a crash leaves.
    twin = tmp_path / "twin"
    process = subprocess.Popen(
        [BIN / "graphdrl", "train", "--config", whole / "config.json", "--out", twin], stderr=subprocess.PIPE
    )
    while process.poll() is None and not ((twin / "metrics.jsonl").exists() and (twin / "metrics.jsonl").read_text()):
        time.sleep(0.05)
    process.send_signal(signal.SIGINT)
    process.communicate(timeout=60)
    shutil.copy(twin / "checkpoint.safetensors", folder / "checkpoint.safetensors")
    time.sleep(1)  # event files are read in order of the second they were made in
    assert run("graphdrl", "train", "--resume", folder).returncode == 0
    events = EventAccumulator(str(folder))
    events.Reload()
    assert [scalar.step for scalar in events.Scalars("reward")] == [10, 20, 25]
    assert (folder / "metrics.jsonl").read_bytes() == (whole / "metrics.jsonl").read_bytes()
