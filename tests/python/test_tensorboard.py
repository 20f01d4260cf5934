"""The run directory's curves, read back by TensorBoard's own reader."""

import json

from tensorboard.backend.event_processing.event_accumulator import EventAccumulator


def test_events_hold_the_papers_four_curves(trained):
    folder, summary = trained
    events = EventAccumulator(str(folder))
    events.Reload()
    assert sorted(events.Tags()["scalars"]) == ["epsilon", "loss", "nodes_visited", "reward"]
    lines = [json.loads(line) for line in (folder / "metrics.jsonl").read_text().splitlines()]
    assert [line["episode"] for line in lines] == [10, 20, 25]
    assert lines[-1]["steps"] == summary["steps"] == 25 * 25
    for tag, key in {"epsilon": "epsilon", "loss": "loss", "nodes_visited": "visited_nodes", "reward": "reward"}.items():
        scalars = events.Scalars(tag)
        assert [scalar.step for scalar in scalars] == [line["episode"] for line in lines]
        for scalar, line in zip(scalars, lines):
            assert abs(scalar.value - line[key]) <= 1e-6 * max(1, abs(line[key]))
