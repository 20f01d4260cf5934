"""The programs as a user meets them: contracts of the output, bad input, interruption."""

import json
import os
import re
import shlex
import shutil
import signal
import struct
import subprocess
import time

import pytest

from conftest import BIN, TRAINING, WITH_TORCH, read_safetensors

MAP_A = "...#.\n.###.\n.#...\n.#...\n.....\n"


def evaluate(run, *arguments):
    process = run("graphdrl", "evaluate", "--json", *arguments)
    assert process.returncode == 0, process.stderr
    assert process.stderr == ""
    return json.loads(process.stdout)


def test_help_and_version(run):
    for arguments in (
        ["--help"],
        ["evaluate", "--help"],
        ["maps", "show", "--help"],
        ["maps", "convert", "--help"],
        ["train", "--help"],
        ["inspect", "--help"],
    ):
        process = run("graphdrl", *arguments)
        assert process.returncode == 0
        assert "Usage:" in process.stdout
    assert re.fullmatch(r"\d+\.\d+\.\d+\n", run("graphdrl", "--version").stdout)


def test_evaluate_gives_the_documented_keys(run, trained):
    folder, _ = trained
    result = evaluate(
        run, "--maps", "paper", "--policy", folder / "policy.safetensors", "--policy", "nearest", "--all-starts"
    )
    assert len(result["rows"]) == 20
    row = result["rows"][10]
    assert list(row) == "map policy valid_nodes budget episodes mean std best ci95 optimum paper".split()
    assert row["map"] == "paper:a" and row["policy"] == "nearest" and result["rows"][0]["policy"] == "policy"
    assert row["valid_nodes"] == 19 and row["episodes"] == 19 and row["budget"] == 25 and row["optimum"] == 100
    assert row["mean"] == pytest.approx(95.3, abs=0.05)
    assert row["ci95"][0] < row["mean"] < row["ci95"][1]
    assert row["paper"] == {"mean": 89.8, "std": 8.3, "best": 100.0}
    assert list(result["overall"][1]) == ["policy", "maps", "mean", "ratio_to_optimum"]
    assert result["overall"][1]["mean"] == pytest.approx(98.9, abs=0.3)


def test_evaluate_takes_ones_own_maps(run, tmp_path):
    (tmp_path / "mine.txt").write_text("....\n.##.\n....\n")
    (tmp_path / "other.txt").write_text("..\n")
    result = evaluate(
        run, "--maps", tmp_path, "--maps", "paper:a", "--policy", "nearest", "--budget", "1.1x", "--episodes", "3"
    )
    assert [row["map"] for row in result["rows"]] == ["mine", "other", "paper:a"]
    assert [row["budget"] for row in result["rows"]] == [11, 2, 20]
    assert all(row["paper"] is None for row in result["rows"])
    default = evaluate(run, "--maps", tmp_path / "other.txt")
    assert [line["policy"] for line in default["overall"]] == [
        "random",
        "dfs",
        "nearest",
        "explorer",
        "guided",
        "search",
            "exact",
    ]
    assert default["rows"][0]["episodes"] == 30
    single = evaluate(run, "--maps", tmp_path / "other.txt", "--policy", "nearest", "--episodes", "1")["rows"][0]
    assert single["std"] is None and single["ci95"] is None


def test_large_maps_have_no_optimum(run, tmp_path):
    (tmp_path / "large.txt").write_text(("." * 50 + "\n") * 50)
    policies = ["--policy", "nearest", "--policy", "exact"]
    result = evaluate(run, "--maps", tmp_path / "large.txt", "--budget", "1x", "--episodes", "4", *policies)
    rows = {row["policy"]: row for row in result["rows"]}
    assert all(row["optimum"] is None for row in rows.values())
    assert rows["exact"]["mean"] is None and rows["nearest"]["mean"] > 50
    assert result["overall"][-1] == {"policy": "exact", "maps": 0, "mean": None, "ratio_to_optimum": None}


def test_inspect_shows_tensors_features_and_q_values(run, trained):
    folder, _ = trained
    policy = folder / "policy.safetensors"
    process = run("graphdrl", "inspect", policy, "--map", "paper:a", "--walk", "0,1,1,2", "--json")
    result = json.loads(process.stdout)
    assert result["parameters"] == 240_678
    assert {tensor["name"]: tensor["shape"] for tensor in result["tensors"]} == {
        name: list(values.shape) for name, values in read_safetensors(policy)[0].items()
    }
    steps = result["steps"]
    assert [step["position"] for step in steps] == [0, 1, 1, 2]
    assert steps[0]["legal"] == [False, False, True, True]
    assert len(steps[0]["q"]) == 4 and len(steps[0]["features"]) == 25
    assert steps[2]["features"][1] == [
        0,
        1,
        0,
        2,
        1,
        2,
        1,
    ]  # row, column, obstacle, visits, wall, unvisited neighbours, current
    assert "240678 parameters" in run("graphdrl", "inspect", policy).stdout


def test_maps_info_and_show(run, tmp_path):
    assert json.loads(run("graphdrl", "maps", "info", "paper:a", "--json").stdout) == {
        "map": "paper:a", "nodes": 25, "edges": 40, "directed": False, "weighted": False, "valid_nodes": 19,
        "components": 1, "connected": True, "largest_component": 19,
        "degrees": {"min": 1, "mean": 44 / 19, "max": 4}, "costs": {"min": 1, "mean": 1, "max": 1},
        "least_budget": 20, "least_budget_start": 0, "bounding_box": [0, 0, 4, 4], "unit": "cells", "cells": [5, 5],
    }  # fmt: skip
    process = run("graphdrl", "maps", "show", "paper:a", "--walk", "0,1,2", "--svg", tmp_path / "a.svg")
    assert process.returncode == 0
    assert process.stdout.splitlines()[1:6] == ["S → E # .", ". # # # .", ". # . . .", ". # . . .", ". . . . ."]
    assert (tmp_path / "a.svg").read_text().count("<circle") == 25 + 2 + 1  # the start, the legend
    assert run("graphdrl", "maps", "show", "paper:a").stdout == "paper:a: 19 valid nodes\n" + MAP_A


def test_maps_info_says_what_holds_for_which_walk(run, tmp_path):
    (tmp_path / "path.csv").write_text("b,a,2.5\nb,c,1\n")
    text = run("graphdrl", "maps", "info", tmp_path / "path.csv").stdout
    assert "  budget   no walk from b visits every node for less than 4.5\n" in text
    (tmp_path / "millions.csv").write_text("a,b,1234567\nb,c,1234567\n")
    text = run("graphdrl", "maps", "info", tmp_path / "millions.csv").stdout
    assert "costs    1234567 to 1234567" in text and "less than 2469134\n" in text
    (tmp_path / "free.txt").write_text("a b 0\nb c 0\nc a 0\n")
    assert "costs    0 to 0, 0 in the mean" in run("graphdrl", "maps", "info", tmp_path / "free.txt").stdout


@pytest.mark.parametrize("arguments", [["maps", "show", "paper"], ["maps", "info", "paper", "--json"], ["--help"]])
def test_a_closed_pipe_ends_silently(arguments):
    reader, writer = os.pipe()
    os.close(reader)
    process = subprocess.run([BIN / "graphdrl", *arguments], stdout=writer, stderr=subprocess.PIPE, check=False)
    os.close(writer)
    assert (process.returncode, process.stderr) == (141, b"")


def test_a_plan_goes_out_and_comes_back(run, tmp_path):
    endings = [".json", ".csv", ".svg", ".anim.svg", ".png", ".graphml", ".dot"]
    outs = [option for ending in endings for option in ("--out", tmp_path / ("a" + ending))]
    plan = json.loads(run("graphdrl", "plan", "paper:a", "--budget", "12", "--json", *outs).stdout)
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted("a" + ending for ending in endings)
    for ending in (".json", ".csv"):
        found = json.loads(run("graphdrl", "check", "paper:a", tmp_path / ("a" + ending), "--budget", "12", "--json",
                               "--out", tmp_path / "again.csv").stdout)  # fmt: skip
        for key in ("walk", "visited", "cost", "budget", "coverage"):
            assert found[key] == plan[key], key
        assert found["upper_bound"] >= plan["upper_bound"]
        assert (tmp_path / "again.csv").read_text() == (tmp_path / "a.csv").read_text()
    text = run("graphdrl", "check", "paper:a", tmp_path / "a.csv").stdout
    assert f"visited {plan['visited']} of 19 nodes" in text
    nodes = json.loads(run("graphdrl", "maps", "info", tmp_path / "a.graphml", "--json").stdout)
    assert (nodes["nodes"], nodes["valid_nodes"], nodes["edges"]) == (25, 19, 40)


def test_a_robot_plans_on_a_map_of_its_own(run, tmp_path):
    """A ROS map of 19.2 m a side, of two rooms and a door, in cells of half a metre."""
    side = 384
    rows = [bytearray(b"\xfe" * side) for _ in range(side)]
    for i in range(side):
        for j in (*range(4), *range(side - 4, side)):
            rows[j][i] = rows[i][j] = 0
        for j in range(190, 196):
            rows[i][j] = 0 if not 100 < i < 140 else 254
    (tmp_path / "floor.pgm").write_bytes(b"P5\n%d %d\n255\n" % (side, side) + b"".join(rows))
    yaml = "image: floor.pgm\nresolution: 0.05\norigin: [-9.6, -9.6, 0.0]\nnegate: 0\n"
    (tmp_path / "floor.yaml").write_text(yaml)
    options = ["--cell-size", "0.5", "--robot-radius", "0.3", "--connectivity", "8"]
    process = run("graphdrl", "plan", tmp_path / "floor.yaml", "--budget", "1.1x", *options, "--json",
                  "--out", tmp_path / "path.yaml", "--out", tmp_path / "path.geojson")  # fmt: skip
    assert "of free ground" in process.stderr
    plan = json.loads(process.stdout)
    assert plan["unit"] == "m"
    assert plan["coverage"] > 95
    places = plan["walk_places"]
    assert all(-9.6 < x < 9.6 and -9.6 < y < 9.6 for x, y in places)
    for (x, y), (next_x, next_y) in zip(places, places[1:]):
        assert max(abs(x - next_x), abs(y - next_y)) == pytest.approx(0.5)
    crossing = [y for (x, y), (next_x, _) in zip(places, places[1:]) if (x < 0) != (next_x < 0)]
    assert crossing and all(2.6 < y < 4.6 for y in crossing)  # through the door
    assert (tmp_path / "path.yaml").read_text().count("position") == len(places)


def test_maps_convert_keeps_the_map(run, tmp_path):
    """A grid through every format that holds it, and a list of edges as networkx writes it."""
    counts = {"map": "a", "nodes": 25, "edges": 40, "directed": False, "weighted": False, "valid_nodes": 19}
    source = "paper:a"
    for ending in (".map", ".png", ".pgm", ".txt", ".gml", ".dot", ".graphml", ".json"):
        out = tmp_path / ("a" + ending)
        assert run("graphdrl", "maps", "convert", source, "--out", out).stdout == f"Wrote {out}\n"
        assert json.loads(run("graphdrl", "maps", "info", out, "--json").stdout).items() >= counts.items()
        source = out
    assert (tmp_path / "a.txt").read_text() == MAP_A
    (tmp_path / "edges").write_text("a b {'weight': 2.5}\nb c {}\n")
    run("graphdrl", "maps", "convert", tmp_path / "edges", "--out", tmp_path / "edges.json")
    graph = json.loads((tmp_path / "edges.json").read_text())
    assert [node["id"] for node in graph["nodes"]] == ["a", "b", "c"]
    assert [link["weight"] for link in graph["links"]] == [2.5, 1]


def write_safetensors_metadata(path, metadata):
    header = json.dumps({"__metadata__": metadata}).encode()
    path.write_bytes(struct.pack("<Q", len(header)) + header)


def bad_inputs(tmp_path, policy):
    """Arguments, and what the one line must say."""
    (tmp_path / "strange.txt").write_text("..x\n...\n")
    (tmp_path / "ragged.txt").write_text("...\n..\n")
    (tmp_path / "full.txt").write_text("##\n##\n")
    (tmp_path / "walk.csv").write_text("node\n0\n2\n")
    (tmp_path / "home.csv").write_text("0\n1\n0\n")
    content = policy.read_bytes()
    (tmp_path / "cut.safetensors").write_bytes(content[:-1000])
    (tmp_path / "shape.safetensors").write_bytes(content.replace(b"[192,64]", b"[64,192]", 1))
    (tmp_path / "type.safetensors").write_bytes(content.replace(b'"F32"', b'"I32"', 1))
    (tmp_path / "long.safetensors").write_bytes(b"\xff" * 8 + content[8:])
    (tmp_path / "other.safetensors").write_bytes(
        content.replace(b'\\"kind\\":\\"paper\\"', b'\\"kind\\":\\"other\\"', 1)
    )
    (tmp_path / "config.json").write_text('{"episodes": 3, "speed": 9}')
    (tmp_path / "broken.json").write_text('{"episodes": ')
    deep = "[" * 1_000_000 + "]" * 1_000_000
    (tmp_path / "deep.json").write_text('{"preset": "paper", "maps": ' + deep + "}")
    (tmp_path / "list.json").write_text(deep)
    for name, config in {"older": policy.parent / "config.json", "deep": tmp_path / "deep.json"}.items():
        (tmp_path / name).mkdir()
        shutil.copy(config, tmp_path / name / "config.json")
    write_safetensors_metadata(tmp_path / "older" / "checkpoint.safetensors", {"progress": '{"episode": 25}'})
    (tmp_path / "file").write_text("")
    graph = {"nodes": [{"id": 0}, {"id": 1}], "links": [{"source": 0, "target": 1, "weight": 2}]}
    (tmp_path / "graph.json").write_text(json.dumps(graph))
    graph["links"][0]["weight"] = -2
    (tmp_path / "cost.json").write_text(json.dumps(graph))
    graph["links"][0]["weight"] = 2
    graph["nodes"][1]["prize"] = -1
    (tmp_path / "prize.json").write_text(json.dumps(graph))
    (tmp_path / "labels.json").write_text('{"nodes": [{"id": "dock"}, {"id": "shelf"}], "links": []}')
    (tmp_path / "deep.json").write_text('{"nodes":[' + "[" * 10**6 + "]" * 10**6 + '],"links":[]}')
    evaluate_nearest = ["evaluate", "--policy", "nearest"]
    return [
        ([*evaluate_nearest, "--maps", tmp_path / "strange.txt"], "strange.txt:1:3: strange character"),
        ([*evaluate_nearest, "--maps", tmp_path / "ragged.txt"], "ragged.txt:2: rows of unequal length"),
        ([*evaluate_nearest, "--maps", tmp_path / "full.txt"], "no valid node"),
        ([*evaluate_nearest, "--maps", tmp_path / "missing.txt"], "no such map"),
        ([*evaluate_nearest, "--budget", "-1"], "bad budget"),
        ([*evaluate_nearest, "--budget=-1"], "bad budget"),
        ([*evaluate_nearest, "--budget", "lots"], "bad budget"),
        ([*evaluate_nearest, "--budget", "nan"], "bad budget"),
        ([*evaluate_nearest, "--episodes", "0"], "too few episodes"),
        ([*evaluate_nearest, "--episodes", "some"], "--episodes"),
        ([*evaluate_nearest, "--episodes", "3", "--all-starts"], "--all-starts"),
        ([*evaluate_nearest, "--threads", "0"], "--threads"),
        (["evaluate", "--policy", "magic"], "no such policy"),
        (["evaluate", "--fast"], "--fast"),
        (["evaluate", "--policy", tmp_path / "cut.safetensors"], "lies outside the file"),
        (["evaluate", "--policy", tmp_path / "shape.safetensors"], "the file is damaged"),
        (["evaluate", "--policy", tmp_path / "type.safetensors"], "the file is damaged"),
        (["evaluate", "--policy", tmp_path / "long.safetensors"], "not a whole safetensors file"),
        (["evaluate", "--policy", tmp_path / "other.safetensors"], "the file is damaged"),
        (["evaluate", "--policy", tmp_path], "cannot read the file"),
        (["inspect", tmp_path / "cut.safetensors"], "lies outside the file"),
        (["inspect", policy, "--map", "paper:a"], "--walk"),
        (["inspect", policy, "--map", "paper:a", "--walk", "3"], "start on an obstacle"),
        (["inspect", policy, "--map", "paper:a", "--walk", "0,2"], "no such step"),
        (["inspect", policy, "--map", "paper", "--walk", "0"], "expected one map, got 10"),
        (["plan", "paper:a"], "--budget"),
        (["plan", "paper", "--budget", "9"], "expected one map, got 10"),
        (["plan", "paper:a", "--budget", "nan"], "bad budget"),
        (["plan", "paper:a", "--budget", "9", "--start", "3"], "start on an obstacle"),
        (["plan", "paper:a", "--budget", "9", "--start", "99"], "start outside the map"),
        (["plan", "paper:a", "--budget", "9", "--policy", "beam:0"], "bad beam width"),
        (["plan", "paper:a", "--budget", "9", "--policy", "beam:many"], "bad beam width"),
        (["plan", "paper:a", "--budget", "9", "--end", "3"], "end on an obstacle"),
        (["plan", "paper:a", "--budget", "9", "--end", "home"], "end outside the map"),
        (
            ["plan", "paper:a", "--budget", "2", "--end", "24", "--policy", "exact"],
            "the end cannot be reached within the budget",
        ),
        (["plan", "paper:a", "--budget", "2", "--end", "24"], "the end cannot be reached within the budget"),
        (["plan", "paper:a", "--budget", "9", "--iterations", "0"], "bad number of iterations"),
        (["plan", "paper:a", "--budget", "9", "--iterations", "many"], "--iterations"),
        (["plan", "paper:a", "--budget", "9", "--policy", "beam", "--iterations", "9"], "goes with the policy search"),
        (["evaluate", "--maps", "paper:a", "--end", "3"], "end on an obstacle"),
        (["evaluate", "--maps", "paper:a", "--budget", "2", "--end", "24"], "the end cannot be reached"),
        (["plan", "paper:a", "--budget", "9", "--time-limit", "-1"], "bad time limit"),
        (["plan", "paper:a", "--budget", "9", "--time-limit", "nan"], "bad time limit"),
        (["plan", tmp_path / "cost.json", "--budget", "9"], "links[0]: bad weight"),
        (["plan", tmp_path / "graph.json", "--budget", "9", "--policy", policy], "directions, on grid maps only"),
        (["plan", "paper:a", "--budget", "9", "--out", tmp_path / "a.pdf"], "no plan is written in a file with this"),
        (["plan", "paper:a", "--budget", "9", "--out", tmp_path / "a.geojson"], "needs coordinates"),
        (["plan", "paper:a", "--budget", "9", "--connectivity", "6"], "--connectivity"),
        (["plan", "paper:a", "--budget", "9", "--cut-corners"], "--connectivity"),
        (["plan", "paper:a", "--budget", "9", "--robot-radius", "-1"], "a number above 0"),
        (["plan", "paper:a", "--budget", "9", "--cell-size", "2"], "--cell-size goes with maps that say how large"),
        (["maps", "info", tmp_path / "graph.json", "--cost-attribute", "speed"], "no edge has this attribute"),
        (["check", "paper:a", tmp_path / "nowhere"], "nowhere"),
        (["report", tmp_path / "home.csv", "--out", tmp_path / "a.html"], "a plan needs its map: expected --map MAP"),
        (["report", tmp_path / "home.csv", "--map", "paper:a"], "expected either --out FILE or --watch"),
        (["report", tmp_path, "--out", tmp_path / "a.html"], "metrics.jsonl: cannot read the file"),
        (["report", tmp_path, "--watch", "--port", "65536"], "--port: bad port"),
        (["report", tmp_path / "home.csv", "--scores", "explorer", "--out", tmp_path / "a.html"], "expected --map MAP"),
        (["check", "paper:a", tmp_path / "walk.csv"], "not a walk: no edge leads from node 0 to node 2, step 1"),
        (["check", "paper:a", tmp_path / "home.csv", "--budget", "1"], "the walk costs more than the budget"),
        (["check", "paper:a", tmp_path / "home.csv", "--end", "1"], "the walk ends elsewhere"),
        (["train", "--maps", tmp_path / "graph.json", "--out", tmp_path / "new"], "need a grid map"),
        (["train", "--device", "tpu", "--out", tmp_path / "new"], "--device"),
        (["maps", "show", "paper:a", "--walk", "0,25"], "no such step"),
        (["maps", "show", "paper:a", "--walk", "0,b"], "--walk"),
        (["maps", "show", "paper:a", "--svg", tmp_path / "nowhere" / "a.svg"], "cannot write the file"),
        (["maps", "show", "paper:z"], "no such map"),
        (["maps", "convert", "paper:a", "--out", tmp_path / "a.gr"], ".json, .graphml, .png, .pgm, .map, .dot, .gml"),
        (["maps", "convert", tmp_path / "graph.json", "--out", tmp_path / "a.map"], "this format holds grids only"),
        (["maps", "convert", "paper", "--out", tmp_path / "a.map"], "more than one map"),
        (["maps", "show", "paper:a", "--walk", ""], "--walk"),
        (["maps", "show", "paper:a", "--svg", "/dev/null"], "something else stands there"),
        (
            [*evaluate_nearest, "--seed", "-1"],
            "--seed: expected a whole number from 0 to 18446744073709551615, got '-1'",
        ),
        (["plan", "paper:a", "--budget", "9", "--seed", "1.5"], "--seed: expected a whole number"),
        (["maps", "generate", "maze", "--size", "9", "--seed", "-1"], "--seed: expected a whole number"),
        (
            ["plan", tmp_path / "labels.json", "--budget", "9", "--start", "1"],
            "start outside the map: expected a label of the map, or #N for node id N, got '1'",
        ),
        (
            ["plan", "paper:a", "--budget", "9", "--start", "#25"],
            "start outside the map: expected a valid node's id or row,col",
        ),
        (["plan", tmp_path / "deep.json", "--budget", "9"], "nested too deeply"),
        (["plan", tmp_path / "prize.json", "--budget", "9"], "nodes[1]: bad prize"),
        (
            ["maps", "generate", "maze", "--size", "9", "--blocked", "0.2", "--out", tmp_path / "new"],
            "for the family obstacles",
        ),
        (
            ["maps", "generate", "obstacles", "--size", "9", "--blocked", "0.95", "--out", tmp_path / "new"],
            "expected 0 to 0.9",
        ),
        ([*evaluate_nearest, "--\x1b[31m"], "\\x1b[31m"),
        (["train", "--resume", ""], "--resume"),
        (["train", "--seeds", "2-1"], "--seeds: bad seeds"),
        (["train", "--maps", "no-map", "--seeds", "1-2", "--out", tmp_path / "new"], "no such map"),
        (["results", tmp_path / "nothing"], "there is no run"),
        (["results", policy.parent, "--figure", "curves.gif"], "FILE.svg or FILE.png"),
        (["results", policy.parent, "--into", tmp_path / "nothing.md"], "cannot read the file"),
        (["results"], "runs is required"),
        (["train", "--out", ""], "--out"),
        (["train", "--start", "3", "--out", tmp_path / "new"], "start on an obstacle"),
        (["train", "--seed", "-1", "--out", tmp_path / "new"], "--seed: expected a whole number"),
        (["maps"], "subcommand"),
        ([], "subcommand"),
        (["train", "--episodes", "0", "--out", tmp_path / "new"], "--episodes"),
        (["train", "--preset", "best", "--out", tmp_path / "new"], "--preset"),
        (["train", "--swiftly"], "--swiftly"),
        (["train", "--rounds", "0", "--out", tmp_path / "new"], "--rounds"),
        (
            ["train", "--rounds", "3", "--episodes", "3", "--out", tmp_path / "new"],
            "--rounds is no option of the preset paper",
        ),
        (
            ["train", "--preset", "explorer", "--maps", "paper:a", "--out", tmp_path / "new"],
            "--maps is no option of the preset explorer",
        ),
        (["plan", "paper:a", "--budget", "9", "--policy", "guided:0"], "bad beam width"),
        (["plan", "paper:a", "--budget", "9", "--policy", f"guided:4:{policy}"], "the policy is no explorer"),
        (["plan", "paper:a", "--budget", "9", "--policy", "guided:4:nothing"], "cannot read the file"),
        (["plan", "paper:a", "--budget", "9", "--policy", "guided:4:"], "no policy file is named"),
        (
            ["inspect", policy, "--map", "paper:a", "--walk", "0,1", "--budget", "9"],
            "the paper's network looks at no budget",
        ),
        (["plan", "paper:a", "--budget", "-1"], "bad budget"),
        (["maps", "generate", "maze", "--size", "8", "--out", tmp_path / "new"], "an odd number of cells a side"),
        (["maps", "generate", "cave", "--size", "8", "--out", tmp_path / "new"], "no such family of worlds"),
        (
            ["maps", "generate", "maze", "--size", "9", "--weighted", "--out", tmp_path / "new"],
            "neither costs nor directions",
        ),
        (["maps", "generate", "maze", "--size", "9", "--out", policy.parent], "the folder is not empty"),
        (["maps", "generate", "maze", "--size", "9", "--split", "exam"], "--split"),
        (["train", "--budget", "70000", "--out", tmp_path / "new"], "budget out of range"),
        (["train", "--maps", tmp_path / "strange.txt", "--out", tmp_path / "new"], "strange character"),
        (["train", "--out", tmp_path / "file" / "run"], "cannot create the folder"),
        (["train", "--out", policy.parent], "holds a run already"),
        (["train", "--resume", tmp_path / "nothing"], "there is no run to go on with"),
        (["train", "--resume", policy.parent, "--seed", "3"], "--seed does not go with --resume"),
        (["train", "--config", tmp_path / "config.json", "--out", tmp_path / "new"], "speed"),
        (["train", "--config", tmp_path / "broken.json", "--out", tmp_path / "new"], "not valid JSON"),
        (["train", "--config", tmp_path / "no.json", "--out", tmp_path / "new"], "no.json"),
        (["train", "--config", tmp_path / "deep.json", "--out", tmp_path / "new"], "nested too deeply"),
        (["train", "--config", tmp_path / "list.json", "--out", tmp_path / "new"], "not able to parse [[["),
        (["train", "--resume", tmp_path / "deep"], "the run cannot be gone on with"),
        (["train", "--resume", tmp_path / "older"], "begin anew"),
        (["train", "--device", "cuda", "--out", tmp_path / "new"], "cuda"),
    ]


def snapshot(folder):
    """What is there. A folder's time may change: a lock comes and goes in it."""
    paths = sorted(folder.rglob("*"))
    return {path: path.is_file() and (path.stat().st_mtime_ns, path.stat().st_size) for path in paths}


def test_bad_input_is_one_line_and_status_2_and_changes_nothing(run, trained, tmp_path):
    run_folder = tmp_path / "run"
    shutil.copytree(trained[0], run_folder)
    cases = bad_inputs(tmp_path, run_folder / "policy.safetensors")
    before = snapshot(tmp_path)
    for arguments, expected in cases:
        process = run("graphdrl", *arguments, cwd=tmp_path)
        assert process.returncode == 2, (arguments, process)
        assert process.stdout == "", arguments
        assert process.stderr.count("\n") == 1 and process.stderr.endswith("\n"), (arguments, process.stderr)
        assert expected in process.stderr and len(process.stderr) < 1000, (arguments, process.stderr)
    assert snapshot(tmp_path) == before


def test_config_reads_a_run_back(run, trained, tmp_path):
    folder, _ = trained
    process = run("graphdrl", "train", "--config", folder / "config.json", "--out", tmp_path / "again")
    assert process.returncode == 0, process.stderr
    assert (tmp_path / "again/config.json").read_bytes() == (folder / "config.json").read_bytes()
    assert (tmp_path / "again/policy.safetensors").read_bytes() == (folder / "policy.safetensors").read_bytes()
    (tmp_path / "lines.toml").write_text("episodes = 2\nmaps = ['paper:b', 'paper:c']\nend-at-full-coverage = true\n")
    process = run("graphdrl", "train", "--config", tmp_path / "lines.toml", "--out", tmp_path / "lines")
    assert process.returncode == 0, process.stderr
    config = json.loads((tmp_path / "lines/config.json").read_text())
    assert (
        config["episodes"] == 2
        and config["maps"] == ["paper:b", "paper:c"]
        and config["end_at_full_coverage"] is True
    )


@pytest.mark.parametrize("number, status", [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_interrupted_training_goes_on_where_it_was(run, trained, tmp_path, number, status):
    whole, _ = trained
    folder = tmp_path / "run"
    command = [BIN / "graphdrl", *TRAINING, "--out", folder]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    while process.poll() is None and not (folder / "metrics.jsonl").exists():
        time.sleep(0.05)
    while process.poll() is None and not (folder / "metrics.jsonl").read_text():
        time.sleep(0.05)
    process.send_signal(number)
    _, errors = process.communicate(timeout=60)
    assert process.returncode == status, errors
    assert f"graphdrl train --resume {folder}" in errors
    resumed = run("graphdrl", "train", "--resume", folder, "--json")
    assert resumed.returncode == 0, resumed.stderr
    assert json.loads(resumed.stdout)["episodes"] == 25
    assert (folder / "policy.safetensors").read_bytes() == (whole / "policy.safetensors").read_bytes()
    assert (folder / "metrics.jsonl").read_bytes() == (whole / "metrics.jsonl").read_bytes()


def test_many_seeds_train_side_by_side_and_become_a_distribution(run, tmp_path):
    training = ["train", "--preset", "paper", "--episodes", "10", "--batch-size", "2"]
    process = run("graphdrl", *training, "--seeds", "1-2,5", "--out", "all", "--threads", "2", "--json", cwd=tmp_path)
    assert process.returncode == 0, process.stderr
    runs = json.loads(process.stdout)["runs"]
    assert [one["seed"] for one in runs] == [1, 2, 5]
    assert [one["run"] for one in runs] == ["all/seed-1", "all/seed-2", "all/seed-5"]
    assert all(one["episodes"] == 10 and one["steps"] == 250 for one in runs)
    assert "3 of 3 seeds done" in process.stderr
    assert run("graphdrl", *training, "--seed", "5", "--out", "alone", cwd=tmp_path).returncode == 0
    for name in ("policy.safetensors", "metrics.jsonl"):
        assert (tmp_path / "alone" / name).read_bytes() == (tmp_path / "all/seed-5" / name).read_bytes()

    again = run("graphdrl", "train", "--config", "all/seeds.json", "--out", "again", cwd=tmp_path)
    assert again.returncode == 0, again.stderr
    assert (tmp_path / "again/seeds.json").read_bytes() == (tmp_path / "all/seeds.json").read_bytes()
    damaged = (tmp_path / "all/seeds.json").read_text().replace('"episodes": 10', '"episodes": 11')
    (tmp_path / "damaged.json").write_text(damaged)
    refused = run("graphdrl", "train", "--config", "damaged.json", "--out", "damaged", cwd=tmp_path)
    assert refused.returncode == 2 and "the file is damaged" in refused.stderr
    assert not (tmp_path / "damaged").exists()
    twice = run("graphdrl", "results", "all", "all/seed-1", cwd=tmp_path)
    assert twice.returncode == 2 and "two runs of seed 1" in twice.stderr

    (tmp_path / "page.md").write_text("before\n<!-- table -->\nold\n<!-- end of table -->\nafter\n")
    process = run("graphdrl", "results", "all", "--figure", "curves.svg", "--into", "page.md", "--json", cwd=tmp_path)
    assert process.returncode == 0, process.stderr
    result = json.loads(process.stdout)
    assert result["seeds"] == [1, 2, 5] and [row["map"] for row in result["rows"]][-2:] == ["unseen", "all"]
    page = (tmp_path / "page.md").read_text()
    assert page.startswith("before\n<!-- table -->\n| map |") and page.endswith("<!-- end of table -->\nafter\n")
    assert "old" not in page and page.count("\n| paper:") == 10
    assert "The mean of 3 seeds" in (tmp_path / "curves.svg").read_text()
    text = run("graphdrl", "results", "all/seed-1", "all/seed-2", "--maps", "paper:a", cwd=tmp_path).stdout
    assert text.startswith("Over 2 seeds") and "paper:a" in text


def test_a_kill_in_the_middle_of_many_seeds_changes_nothing(run, tmp_path):
    training = ["train", "--preset", "paper", "--episodes", "30", "--batch-size", "4", "--seeds", "3-4"]
    assert run("graphdrl", *training, "--out", tmp_path / "whole").returncode == 0
    command = [BIN / "graphdrl", *training, "--out", tmp_path / "killed"]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    first = tmp_path / "killed" / "seed-3" / "metrics.jsonl"
    while process.poll() is None and not (first.exists() and first.read_text()):
        time.sleep(0.05)
    process.kill()
    process.communicate(timeout=60)
    assert process.returncode == -signal.SIGKILL
    resumed = run("graphdrl", "train", "--resume", tmp_path / "killed", "--json")
    assert resumed.returncode == 0, resumed.stderr
    assert [one["episodes"] for one in json.loads(resumed.stdout)["runs"]] == [30, 30]
    for seed in (3, 4):
        for name in ("policy.safetensors", "metrics.jsonl"):
            whole = tmp_path / "whole" / f"seed-{seed}" / name
            assert (tmp_path / "killed" / f"seed-{seed}" / name).read_bytes() == whole.read_bytes()


def loaded_libraries(program):
    output = subprocess.run(["ldd", BIN / program], capture_output=True, text=True, check=True).stdout
    return dict(re.findall(r"(\S+) => (\S+)", output))


def test_graphdrl_loads_no_libtorch_and_no_openblas_but_the_openmp_build():
    small = loaded_libraries("graphdrl")
    assert not [name for name in small if "torch" in name]
    # CLP's own libraries load whichever BLAS there is.
    for name, library in small.items():
        assert "openblas" not in name or "openblas-openmp" in os.path.realpath(library)
    if not WITH_TORCH:
        return
    large = loaded_libraries("graphdrl-train")
    assert [name for name in large if name.startswith("libtorch_cpu")]
    for name in ("libopenblas.so.0", "libblas.so.3", "liblapack.so.3"):
        assert "openblas-openmp" in os.path.realpath(large[name])


def test_graphdrl_trains_alone_and_asks_for_graphdrl_train_where_cuda_does(run, tmp_path):
    shutil.copy(BIN / "graphdrl", tmp_path / "graphdrl")
    small = ["--preset", "paper", "--episodes", "1"]
    assert run(tmp_path / "graphdrl", "train", *small, "--out", tmp_path / "run").returncode == 0
    process = run(tmp_path / "graphdrl", "train", *small, "--device", "cuda", "--out", tmp_path / "cuda")
    assert process.returncode == 2 and process.stderr.count("\n") == 1
    assert "training on cuda needs graphdrl-train beside graphdrl" in process.stderr
    assert not (tmp_path / "cuda").exists()
    # It takes the same arguments, as they are.
    program = tmp_path / "graphdrl-train"
    program.write_text('#!/bin/sh\necho "$@"\n')
    program.chmod(0o755)
    arguments = [*small, "--device", "cuda", "--out", "a b"]
    assert run(tmp_path / "graphdrl", "train", *arguments).stdout == " ".join(arguments) + "\n"
    tune = ["tune", "--device", "cuda", "--out", "a b"]
    assert run(tmp_path / "graphdrl", *tune).stdout == " ".join(tune) + "\n"


def test_closed_streams_are_no_crash():
    def status(command):
        return subprocess.run(["bash", "-c", command], capture_output=True, text=True, check=False).stdout.split()[-1]

    graphdrl = shlex.quote(str(BIN / "graphdrl"))
    assert status(f"{graphdrl} evaluate --policy nearest | true; echo ${{PIPESTATUS[0]}}") == "141"
    assert status(f"{graphdrl} evaluate --fast 2>&-; echo $?") == "2"
    assert status(f"{graphdrl} evaluate --policy nearest >/dev/full; echo $?") == "3"


def test_network_policies_take_large_maps(run, trained, tmp_path):
    (tmp_path / "large.txt").write_text(("." * 70 + "\n") * 70)
    policy = trained[0] / "policy.safetensors"
    result = evaluate(run, "--maps", tmp_path / "large.txt", "--policy", policy, "--budget", "1", "--episodes", "5")
    assert result["rows"][0]["valid_nodes"] == 4900


def test_bench_gives_the_documented_keys(run):
    first = json.loads(run("graphdrl", "bench", "--json").stdout)
    assert list(first) == "signature signature_learned env_steps_per_s move_ms learning_step_ms".split()
    for key in ("env_steps_per_s", "learning_step_ms"):
        assert list(first[key]) == ["1", "2"] and all(value > 0 for value in first[key].values())


def plan(run, *arguments):
    process = run("graphdrl", "plan", *arguments, "--json")
    assert process.returncode == 0, process.stderr
    return json.loads(process.stdout)


PLAN_KEYS = (
    "map policy start end budget walk walk_cells visited coverage cost upper_bound max_visited gap optimal unreachable "
    "elapsed_s"
).split()


def test_plan_gives_a_walk_its_bound_and_the_documented_keys(run, trained):
    best = plan(run, "paper:a", "--budget", "25", "--start", "0,1")
    assert list(best) == PLAN_KEYS
    assert best["walk"][0] == best["start"] == 1 and best["walk_cells"][0] == [0, 1]
    assert all(abs(a - c) + abs(b - d) == 1 for (a, b), (c, d) in zip(best["walk_cells"], best["walk_cells"][1:]))
    assert best["visited"] == len(set(best["walk"])) == 19 and best["cost"] == len(best["walk"]) - 1 <= 25
    assert best["coverage"] == best["upper_bound"] == 100 and best["gap"] == 0 and best["optimal"]
    for policy in ("random", "random-walk", "dfs", "nearest", "exact", "beam:1", trained[0] / "policy.safetensors"):
        other = plan(run, "paper:g", "--budget", "1.0x", "--policy", policy)
        assert other["coverage"] <= other["upper_bound"] and other["cost"] <= 17
        assert other["gap"] == pytest.approx(other["upper_bound"] - other["coverage"])
    assert plan(run, "paper:a", "--budget", "0")["walk"] == [0]


def test_numbers_stand_on_one_line_in_json(run):
    text = run("graphdrl", "plan", "paper:a", "--budget", "3", "--policy", "dfs", "--json").stdout
    assert (
        '  "walk": [0, 1, 2, 1],\n  "walk_cells": [[0, 0], [0, 1], [0, 2], [0, 1]],\n' in text
        or '  "walk": [0, 1, 2],\n' in text
    )
    assert text.startswith('{\n  "map": "paper:a",\n') and text.endswith("\n}\n")
    rows = run("graphdrl", "evaluate", "--policy", "nearest", "--maps", "paper:a", "--json").stdout
    assert re.search(r'\n {6}"ci95": \[[0-9.]+, [0-9.]+\],\n', rows) and '\n  "rows": [\n    {\n' in rows


def test_plan_ends_where_it_must_and_collects_prizes(run, tmp_path):
    home = plan(run, "paper:a", "--budget", "12", "--end", "start", "--policy", "exact")
    assert home["end"] == home["walk"][0] == home["walk"][-1] == 0 and home["optimal"] and home["cost"] <= 12
    for policy in ("random", "random-walk"):
        assert plan(run, "paper:a", "--budget", "12", "--end", "0,2", "--policy", policy)["walk"][-1] == 2
    nodes = [{"id": name, "prize": prize} for name, prize in {"dock": 0, "a": 1, "b": 5, "c": 2}.items()]
    links = [{"source": a, "target": b} for a, b in (("dock", "a"), ("dock", "b"), ("b", "c"))]
    (tmp_path / "prizes.json").write_text(json.dumps({"nodes": nodes, "links": links}))
    best = plan(run, tmp_path / "prizes.json", "--budget", "3", "--policy", "exact", "--end", "dock")
    assert best["walk_labels"] == ["dock", "b", "dock"] and best["prize"] == 5 and best["max_prize"] == 5
    assert best["upper_bound"] == 100 * 5 / 8 and best["coverage"] == 50 and "max_visited" not in best


def test_every_policy_plans_within_a_time_limit(run):
    for policy in ("dfs", "nearest", "random", "beam:4", "explorer", "guided:4", "exact"):
        result = plan(run, "paper:c", "--budget", "20", "--policy", policy, "--time-limit", "0.05")
        assert result["visited"] <= result["max_visited"] <= 18 and result["cost"] <= 20


def test_nodes_are_named_by_labels_or_ids(run, tmp_path):
    nodes = [{"id": name} for name in ("dock", "0", "shelf")]
    (tmp_path / "labels.json").write_text(json.dumps({"nodes": nodes, "links": []}))
    for start, node in {"dock": 0, "0": 1, "#0": 0, "#2": 2}.items():
        assert plan(run, tmp_path / "labels.json", "--budget", "1", "--start", start)["start"] == node
    assert plan(run, "paper:a", "--budget", "1", "--start", "#1")["start"] == 1
    assert "#N" in run("graphdrl", "plan", "--help").stdout


def test_obstacles_have_the_share_asked_for(run, tmp_path):
    command = [
        "maps",
        "generate",
        "obstacles",
        "--size",
        "101",
        "--blocked",
        "0.2",
        "--count",
        "1",
        "--out",
        tmp_path / "worlds",
    ]
    assert run("graphdrl", *command).returncode == 0
    (file,) = (tmp_path / "worlds").iterdir()
    assert file.name == "obstacles-101-0000.txt"
    info = json.loads(run("graphdrl", "maps", "info", file, "--json").stdout)
    assert info["connected"] and abs(info["valid_nodes"] - 0.8 * 101 * 101) < 200


def test_plan_takes_any_graph_and_says_what_cannot_be_reached(run, tmp_path):
    one_way = [("dock", "a", 2.0), ("a", "b", 1.5), ("b", "dock", 1.0), ("a", "dead end", 3.0)]
    graph = {
        "directed": True,
        "nodes": [{"id": name} for name in ("dock", "a", "b", "dead end", "island")]
        + [{"id": "wall", "blocked": True}],
        "links": [{"source": a, "target": b, "weight": w} for a, b, w in one_way]
        + [{"source": "dock", "target": "wall"}],
    }
    (tmp_path / "plant.json").write_text(json.dumps(graph))
    result = plan(run, tmp_path / "plant.json", "--budget", "9.5", "--start", "dock")
    assert result["walk_labels"] == ["dock", "a", "b", "dock", "a", "dead end"]
    assert result["cost"] == 9.5 and result["visited"] == 4 and result["optimal"] and result["unreachable"] == 1
    short = plan(run, tmp_path / "plant.json", "--budget", "9.4", "--policy", "exact")
    assert short["visited"] == 3 and short["walk_labels"] == ["dock", "a", "b"]
    text = run("graphdrl", "plan", tmp_path / "plant.json", "--budget", "9.5").stdout
    assert "dock (node 0)" in text and "1 node cannot be reached" in text and "optimal" in text
    info = json.loads(run("graphdrl", "maps", "info", tmp_path / "plant.json", "--json").stdout)
    assert info["directed"] and info["weighted"] and info["edges"] == 5 and info["components"] == 2
    rows = evaluate(
        run,
        "--maps",
        tmp_path / "plant.json",
        "--budget",
        "9.5",
        "--all-starts",
        "--policy",
        "nearest",
        "--policy",
        "exact",
    )["rows"]
    assert rows[0]["mean"] <= rows[1]["mean"] == rows[1]["optimum"]


def test_plan_uses_the_time_it_is_given(run, tmp_path):
    (tmp_path / "large.txt").write_text(("." * 9 + "\n" + ".#" * 4 + ".\n") * 5)
    quick = plan(run, tmp_path / "large.txt", "--budget", "1x", "--policy", "beam:1")
    longer = plan(run, tmp_path / "large.txt", "--budget", "1x", "--policy", "beam:1", "--time-limit", "2")
    assert longer["visited"] > quick["visited"] or longer["optimal"]
    exact = plan(run, tmp_path / "large.txt", "--budget", "1x", "--policy", "exact", "--time-limit", "0.1")
    assert exact["visited"] >= quick["visited"]


def test_generated_worlds_are_read_back_and_the_same_again(run, tmp_path):
    for name, arguments in {
        "mazes": ["maze", "--size", "7", "--count", "3"],
        "graphs": ["geometric", "--size", "30", "--weighted", "--directed", "--count", "2", "--split", "test"],
    }.items():
        for folder in (tmp_path / name, tmp_path / f"{name} again"):
            assert run("graphdrl", "maps", "generate", *arguments, "--out", folder).returncode == 0
        files = sorted((tmp_path / name).iterdir())
        assert [file.read_bytes() for file in files] == [
            file.read_bytes() for file in sorted((tmp_path / f"{name} again").iterdir())
        ]
        assert (
            len({file.read_bytes() for file in files}) == len(files) == int(arguments[arguments.index("--count") + 1])
        )
        infos = json.loads(run("graphdrl", "maps", "info", tmp_path / name, "--json").stdout)
        assert all(info["connected"] and info["weighted"] == info["directed"] == (name == "graphs") for info in infos)
        for policy in ("explorer", "guided:4"):
            result = plan(run, files[0], "--budget", "1x", "--policy", policy)
            assert result["coverage"] <= result["upper_bound"] and result["cost"] <= result["budget"] * (1 + 1e-9)


def test_an_explorer_is_trained_used_and_looked_into(run, tmp_path):
    small = ["--largest", "5", "--walks", "20", "--updates", "5", "--batch-size", "8", "--teacher-steps", "1"]
    process = run("graphdrl", "train", "--rounds", "2", *small, "--out", tmp_path / "run", "--json")
    assert process.returncode == 0, process.stderr
    result = json.loads(process.stdout)
    assert result["rounds"] == 2 and result["states"] > 20
    again = run("graphdrl", "train", "--config", tmp_path / "run/config.json", "--out", tmp_path / "again")
    assert again.returncode == 0, again.stderr
    policy = tmp_path / "run/policy.safetensors"
    assert (tmp_path / "again/policy.safetensors").read_bytes() == policy.read_bytes()
    assert json.loads((tmp_path / "run/metrics.jsonl").read_text().splitlines()[-1])["round"] == 2
    for name in (policy, f"guided:3:{policy}"):
        assert plan(run, "paper:a", "--budget", "25", "--policy", name)["visited"] >= 10
    shown = json.loads(
        run("graphdrl", "inspect", policy, "--map", "paper:a", "--walk", "0,1", "--budget", "25", "--json").stdout
    )
    first = shown["steps"][0]
    assert [visit["node"] for visit in first["first_visits"]] == [1, 5] and first["ceiling"] == 18
    assert (
        len(first["nodes"]) == 19
        and first["nodes"][0]["current"] == 1
        and first["first_visits"][1]["features"]["cost"] == 0.125
    )
    assert "head2.weight" in run("graphdrl", "inspect", "explorer").stdout


def test_search_is_the_default_and_never_below_the_explorer(run, tmp_path):
    assert plan(run, "paper:a", "--budget", "25")["policy"] == "search"
    limited = plan(run, "paper:a", "--budget", "18", "--end", "start", "--time-limit", "0.1")
    assert limited["policy"] == "search" and limited["walk"][-1] == 0 and limited["visited"] == 12
    run("graphdrl", "maps", "generate", "obstacles", "--size", "15", "--out", tmp_path / "worlds")
    world = next((tmp_path / "worlds").iterdir())
    found = [plan(run, world, "--budget", "1x", "--threads", threads, "--seed", "3") for threads in ("1", "2")]
    assert found[0]["walk"] == found[1]["walk"]
    assert found[0]["visited"] >= plan(run, world, "--budget", "1x", "--policy", "explorer")["visited"]
    tour = plan(run, world, "--budget", "1x", "--iterations", "100", "--end", "start")
    assert tour["policy"] == "search:100" and tour["walk"][0] == tour["walk"][-1]


def test_an_interrupted_plan_is_printed_whole(tmp_path):
    (tmp_path / "room.txt").write_text(("." * 60 + "\n" + ".#" * 30 + "\n") * 30)
    arguments = ["--budget", "0.7x", "--iterations", "1000000000", "--json"]
    command = [BIN / "graphdrl", "plan", tmp_path / "room.txt", *arguments]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    time.sleep(3)
    process.send_signal(signal.SIGINT)
    output, _ = process.communicate(timeout=60)
    assert process.returncode == 130
    result = json.loads(output)
    assert result["cost"] <= result["budget"] and result["visited"] == len(set(result["walk"]))


def test_evaluate_knows_ends_and_prizes(run, tmp_path):
    nodes = [{"id": node, "prize": node} for node in range(4)]
    links = [{"source": node, "target": node + 1} for node in range(3)]
    (tmp_path / "path.json").write_text(json.dumps({"nodes": nodes, "links": links}))
    arguments = ["--maps", tmp_path / "path.json", "--budget", "4", "--policy", "search", "--policy", "nearest"]
    for end in ("anywhere", "start"):
        rows = evaluate(run, *arguments, "--end", end, "--all-starts")["rows"]
        assert rows[0]["mean"] == pytest.approx(rows[0]["optimum"])
        assert rows[1]["mean"] <= rows[1]["optimum"]


def test_odd_worlds_get_a_clear_answer(run, tmp_path):
    (tmp_path / "one.txt").write_text(".\n")
    (tmp_path / "two.txt").write_text(".#.\n")
    links = [
        {"source": 0, "target": 0},
        {"source": 0, "target": 1, "weight": 3},
        {"source": 1, "target": 0, "weight": 2},
    ]
    (tmp_path / "loops.json").write_text(json.dumps({"nodes": [{"id": 0}, {"id": 1}], "links": links}))
    for policy in ("search", "explorer", "guided", "beam", "exact", "nearest"):
        assert plan(run, tmp_path / "one.txt", "--budget", "9", "--policy", policy)["coverage"] == 100
        assert plan(run, tmp_path / "one.txt", "--budget", "0", "--policy", policy)["walk"] == [0]
        parts = plan(run, tmp_path / "two.txt", "--budget", "9", "--policy", policy)
        assert parts["walk"] == [0] and parts["unreachable"] == 1 and parts["optimal"]
        both = plan(run, tmp_path / "loops.json", "--budget", "2", "--policy", policy)
        assert both["walk"] == [0, 1] and both["cost"] == 2
