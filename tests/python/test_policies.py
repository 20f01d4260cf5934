"""Policies and training of the Python package, beside the program and beside ONNX Runtime."""

import copy
import json
import os
import pathlib
import pickle
import signal
import subprocess
import threading

import graphdrl
import numpy as np
import pytest

PROGRAM = pathlib.Path(os.environ["GRAPHDRL_BIN"]) / "graphdrl"
SHORT = {"episodes": 12, "batch_size": 4, "seed": 3}


def run_program(*arguments):
    return subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, check=False)


@pytest.fixture(scope="module")
def paper(tmp_path_factory):
    """A short run of the preset paper, and the rows that its callback was given."""
    rows = []
    run = graphdrl.train(tmp_path_factory.mktemp("paper") / "run", "paper", on_metrics=rows.append, **SHORT)
    return run, rows


def random_walk(world, rng, steps):
    """A walk as labels."""
    nodes = [int(rng.choice(np.flatnonzero(~world.blocked.ravel())))]
    ends, _ = world.edges()
    for _ in range(steps):
        near = [int(b) for a, b in ends if a == nodes[-1]]
        near += [int(a) for a, b in ends if b == nodes[-1] and not world.directed]
        near = [node for node in near if not world.blocked.ravel()[node]]
        if not near:
            break
        nodes.append(int(rng.choice(near)))
    return nodes


def random_states(count, families):
    rng = np.random.default_rng(7)
    for i in range(count):
        family, size, options = families[i % len(families)]
        world = graphdrl.World.random(family, size + 2 * (i % 4), i, **options)
        walk = world.names(random_walk(world, rng, int(rng.integers(0, 12))))
        yield world.state(walk, budget=200)


def test_training_gives_the_programs_bytes(paper, tmp_path):
    run, rows = paper
    short = ["--episodes", 12, "--batch-size", 4, "--seed", 3]
    done = run_program("train", "--preset", "paper", *short, "--out", tmp_path / "run")
    assert done.returncode == 0, done.stderr
    for name in ("policy.safetensors", "config.json", "metrics.jsonl"):
        assert (run.path / name).read_bytes() == (tmp_path / "run" / name).read_bytes(), name
    assert run.finished
    assert rows == run.metrics
    assert [row["episode"] for row in rows] == [10, 12]
    assert run.options["episodes"] == 12


def test_training_stops_and_goes_on(paper, tmp_path):
    run = graphdrl.train(tmp_path / "run", "paper", on_metrics=lambda row: row["episode"] == 10, **SHORT)
    assert not run.finished
    assert graphdrl.resume(run).finished
    assert (run.path / "policy.safetensors").read_bytes() == (paper[0].path / "policy.safetensors").read_bytes()


def test_what_a_callback_raises_comes_out_and_nothing_is_lost(tmp_path):
    def fail(row):
        raise KeyError(row["episode"])

    with pytest.raises(KeyError, match="10"):
        graphdrl.train(tmp_path / "run", "paper", on_metrics=fail, **SHORT)
    assert graphdrl.resume(tmp_path / "run").finished


def test_ctrl_c_saves(tmp_path):
    timer = threading.Timer(0.5, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        graphdrl.train(tmp_path / "run", "paper", episodes=1_000_000)
    assert json.loads((tmp_path / "run" / "config.json").read_text())["episodes"] == 1_000_000
    assert graphdrl.Run(tmp_path / "run").policy.name == "policy"


def test_training_on_worlds_in_memory_and_the_explorer(tmp_path):
    world = graphdrl.World.from_grid("..#\n...\n#..")
    run = graphdrl.train(tmp_path / "a", "paper", maps=world, episodes=12, budget="1.1x")
    assert run.finished and run.options["maps"] == ["grid"]
    small = {"rounds": 2, "walks": 4, "updates": 2, "largest": 5, "batch_size": 4, "replay_capacity": 50}
    run = graphdrl.train(tmp_path / "b", **small)
    assert [row["round"] for row in run.metrics] == [1, 2]
    assert isinstance(run.policy, graphdrl.Explorer)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"rounds": 3}, "no option of the preset paper: got 'rounds'"),
        ({"epsiodes": 3}, "no option of the preset paper: got 'epsiodes'"),
        ({"episodes": 0}, "--episodes"),
        ({"episodes": "many"}, "episodes: value of the wrong type"),
        ({"learning_rate": float("nan")}, "bad options"),
        ({"episodes": object()}, "bad options"),
        ({"device": "cuda"}, "cuda"),
        ({"maps": []}, "no maps"),
        ({"preset": "best"}, "--preset"),
    ],
)
def test_bad_options_of_a_training(tmp_path, options, message):
    with pytest.raises(graphdrl.Error, match=message) as error:
        graphdrl.train(tmp_path / "run", **{"preset": "paper", **options})
    assert "\n" not in str(error.value)
    assert not (tmp_path / "run").exists()


def test_policies_answer_as_the_program_does(paper, tmp_path):
    policy = paper[0].policy
    world = graphdrl.World.from_file("paper:h")
    walk = [0, 0, 5, 10]
    file = paper[0].path / "policy.safetensors"
    shown = run_program("inspect", file, "--map", "paper:h", "--walk", "0,0,5,10", "--json")
    last = json.loads(shown.stdout)["steps"][-1]
    state = world.state(walk, budget=4)
    np.testing.assert_array_equal(policy.q_values(state), np.float32(last["q"]))
    np.testing.assert_array_equal(policy.inputs(state)["x"], np.float32(last["features"]))

    shown = run_program("inspect", "explorer", "--map", "paper:h", "--walk", "0,5,10", "--budget", "20", "--json")
    last = json.loads(shown.stdout)["steps"][-1]
    visits = graphdrl.Policy.load().first_visits(world.state([0, 5, 10], budget=20))
    assert visits.nodes.tolist() == [visit["node"] for visit in last["first_visits"]]
    np.testing.assert_array_equal(visits.shortfalls, np.float32([visit["shortfall"] for visit in last["first_visits"]]))
    assert visits.nodes[visits.choice] == last["choice"]
    assert visits.ceiling == last["ceiling"]


def test_loaded_policies_plan_and_evaluate_as_their_files(paper, tmp_path):
    world = graphdrl.World.from_file("paper:b")
    explorer = graphdrl.Policy.load("explorer")
    explorer.save(tmp_path / "copy.safetensors")
    network = paper[0].policy
    file = str(paper[0].path / "policy.safetensors")
    for policy, name in ((explorer, "explorer"), (explorer, str(tmp_path / "copy.safetensors")), (network, file)):
        assert graphdrl.plan(world, 25, policy=policy).walk == graphdrl.plan(world, 25, policy=name).walk
        own, named = (graphdrl.evaluate(world, choice, 25, all_starts=True)[0] for choice in (policy, name))
        assert own["mean"] == named["mean"]
    walk = graphdrl.plan(world, 25, policy=lambda state: state.moves[0] if len(state.walk) < 4 else None).walk
    assert 2 <= len(walk) <= 4  # the rest visits nothing new
    with pytest.raises(graphdrl.Error, match="bad policy"):
        graphdrl.plan(world, 25, policy=7)


def test_tensors_go_out_and_come_back(paper, tmp_path):
    for policy in (graphdrl.Policy.load(), paper[0].policy):
        again = type(policy)(policy.tensors, "again")
        again.save(tmp_path / "again.safetensors")
        policy.save(tmp_path / "policy.safetensors")
        assert (tmp_path / "again.safetensors").read_bytes() == (tmp_path / "policy.safetensors").read_bytes()
        restored = pickle.loads(pickle.dumps(policy))
        assert restored.name == policy.name
        assert all(np.array_equal(restored.tensors[key], values) for key, values in policy.tensors.items())
        assert copy.deepcopy(policy) is policy
    assert graphdrl.PaperNetwork.random(1).parameter_count == 240_678
    first, second = graphdrl.PaperNetwork.random(1), graphdrl.PaperNetwork.random(2)
    assert not np.array_equal(first.tensors["fc1.weight"], second.tensors["fc1.weight"])


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda t: t.pop("fc1.weight"), "fc1.weight"),
        (lambda t: t.update(extra=np.zeros(1)), "extra"),
        (lambda t: t.update({"fc1.weight": t["fc1.weight"].T}), "bad shape of tensor 'fc1.weight'"),
        (lambda t: t.update({"fc2.bias": [1, 2, np.nan, 4]}), "a value that no network can have"),
        (lambda t: t.update({"bn1.running_var": -t["bn1.running_var"]}), "a value that no network can have"),
        (lambda t: t.update({"fc2.bias": "text"}), "bad tensor 'fc2.bias'"),
    ],
)
def test_bad_tensors(change, message):
    tensors = graphdrl.PaperNetwork.random().tensors
    change(tensors)
    with pytest.raises(graphdrl.Error, match=message) as error:
        graphdrl.PaperNetwork(tensors)
    assert "\n" not in str(error.value)


def test_the_wall_that_a_network_sees(tmp_path):
    """It stays with the network, whatever way that goes, and every user of the network sees it."""
    tensors = graphdrl.PaperNetwork.random(5).tensors
    border, author = (graphdrl.PaperNetwork(tensors, wall=wall) for wall in ("border", "zero_or_nine"))
    assert graphdrl.PaperNetwork(tensors).wall == border.wall == "border"
    world = graphdrl.World.from_file("paper:h")
    state = world.state([0, 5], budget=4)
    rows, columns = np.indices((5, 5))
    first = (rows == 0) | (columns == 0)
    seen = {network.wall: network.inputs(state)["x"][:, 4].reshape(5, 5) for network in (border, author)}
    np.testing.assert_array_equal(seen["border"], first | (rows == 4) | (columns == 4))
    np.testing.assert_array_equal(seen["zero_or_nine"], first)
    assert not np.array_equal(border.q_values(state), author.q_values(state))

    file = tmp_path / "author.safetensors"
    author.save(file)
    for again in (graphdrl.Policy.load(file), pickle.loads(pickle.dumps(author)), copy.copy(author)):
        assert again.wall == "zero_or_nine"
        np.testing.assert_array_equal(again.q_values(state), author.q_values(state))
    shown = run_program("inspect", file, "--map", "paper:h", "--walk", "0,5", "--json")
    last = json.loads(shown.stdout)["steps"][-1]
    np.testing.assert_array_equal(np.float32(last["q"]), author.q_values(state))
    np.testing.assert_array_equal(np.float32(last["features"]), author.inputs(state)["x"])
    for policy in (border, author):
        policy.save(file)
        shown = run_program("evaluate", "--policy", file, "--maps", "paper:h", "--all-starts", "--json")
        row = graphdrl.evaluate(world, policy, 25, all_starts=True)[0]
        assert json.loads(shown.stdout)["rows"][0]["mean"] == row["mean"]
        assert graphdrl.plan(world, 25, policy=str(file)).walk == graphdrl.plan(world, 25, policy=policy).walk

    for wall in ("edge", "", None, 9):
        with pytest.raises(graphdrl.Error, match="'wall': expected border or zero_or_nine, got ") as error:
            graphdrl.PaperNetwork(tensors, wall=wall)
        assert "\n" not in str(error.value)
    for network, described in ((border, {}), (author, {"wall": "zero_or_nine"})):
        network.export_onnx(tmp_path / "m.onnx")
        session = pytest.importorskip("onnxruntime").InferenceSession(tmp_path / "m.onnx")
        description = json.loads(session.get_modelmeta().custom_metadata_map["network"])
        assert {key: value for key, value in description.items() if key == "wall"} == described


def test_states_of_bad_walks():
    world = graphdrl.World.from_file("paper:a")
    for walk, budget in (([], 5), ([(0, 0), (4, 4)], 5), ([99], 5), ([(0, 0), (0, 1), (0, 2)], 1), ([(0, 0)], "x")):
        with pytest.raises(graphdrl.Error):
            world.state(walk, budget)
    graph = graphdrl.World.random("tree", 9)
    with pytest.raises(graphdrl.Error, match="grid"):
        graphdrl.PaperNetwork.random().q_values(graph.state([0], 5))
    with pytest.raises(graphdrl.Error, match="no such file|cannot"):
        graphdrl.Policy.load("nowhere.safetensors")


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: graphdrl.PaperNetwork.random(seed=-1), "bad seed: expected a whole number from 0 up, got -1"),
        (lambda: graphdrl.PaperNetwork.random(seed="x"), "bad seed"),
        (lambda: graphdrl.PaperNetwork.random(seed=None), "bad seed"),
        (lambda: graphdrl.PaperNetwork.random().q_values(None), "bad states: expected a State or several, got None"),
        (lambda: graphdrl.PaperNetwork.random().inputs([5]), "bad state: expected a State"),
        (lambda: graphdrl.Policy.load().first_visits(None), "bad state: expected a State"),
        (lambda: graphdrl.Policy.load(5), "bad path"),
        (lambda: graphdrl.Policy.load().save(5), "bad path"),
        (lambda: graphdrl.Explorer(5), "bad tensors"),
        (lambda: graphdrl.PaperNetwork(graphdrl.PaperNetwork.random().tensors, name=5), "bad name"),
        (lambda: graphdrl.train(5), "bad path"),
        (lambda: graphdrl.train("run", maps=5), "bad maps"),
        (lambda: graphdrl.train("run", on_metrics=3), "bad on_metrics: expected a function, got 3"),
        (lambda: graphdrl.resume("run", on_metrics=3), "bad on_metrics: expected a function, got 3"),
    ],
)
def test_wrong_types_are_errors_of_one_line(tmp_path, monkeypatch, call, message):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(graphdrl.Error, match=message) as error:
        call()
    assert "\n" not in str(error.value)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("kind", ["paper", "explorer"])
def test_onnx_models_give_our_numbers(paper, tmp_path, kind):
    """1,000 states, ragged batches of them, to 1e-4 relative."""
    onnxruntime = pytest.importorskip("onnxruntime")
    grids = [("obstacles", 5, {}), ("maze", 5, {}), ("rooms", 9, {}), ("open", 3, {})]
    graphs = [("tree", 5, {}), ("geometric", 30, {"weighted": True}), ("erdos-renyi", 20, {"directed": True})]
    policy = paper[0].policy if kind == "paper" else graphdrl.Policy.load()
    states = list(random_states(1000, grids if kind == "paper" else grids + graphs))
    if kind == "explorer":
        states = [state for state in states if len(policy.first_visits(state).nodes) > 0]
        assert len(states) > 900
    # The program writes the same file.
    policy.export_onnx(tmp_path / "model.onnx")
    policy.save(tmp_path / "policy.safetensors")
    done = run_program("export", tmp_path / "policy.safetensors", "-o", tmp_path / "by_program.onnx")
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "by_program.onnx").read_bytes() == (tmp_path / "model.onnx").read_bytes()

    session = onnxruntime.InferenceSession(tmp_path / "model.onnx")
    assert json.loads(session.get_modelmeta().custom_metadata_map["network"])["kind"] == kind
    begin = 0
    for size in [1, 2, 7, 40, 150] * 5:
        batch, begin = states[begin : begin + size], begin + size
        if not batch:
            break
        (got,) = session.run(None, policy.inputs(batch))
        if kind == "paper":
            expected = policy.q_values(batch)
        else:
            expected = np.concatenate([policy.first_visits(state).shortfalls for state in batch])
        assert got.shape == expected.shape
        assert np.abs(got - expected).max() <= 1e-4 * np.abs(expected).max()


def test_export_of_the_program(tmp_path):
    for arguments, message in (
        (["explorer", "-o", tmp_path / "model.txt"], "FILE.onnx"),
        ([tmp_path / "none.safetensors", "-o", tmp_path / "m.onnx"], "none.safetensors"),
        (["explorer", "-o", tmp_path / "no" / "folder" / "m.onnx"], "m.onnx"),
        (["explorer"], "--out"),
    ):
        done = run_program("export", *arguments)
        assert done.returncode == 2 and message in done.stderr and done.stderr.count("\n") == 1, done.stderr
    assert not list(tmp_path.iterdir())


def test_onnx_of_a_single_node(tmp_path):
    onnxruntime = pytest.importorskip("onnxruntime")
    world = graphdrl.World.from_grid(".")
    network = graphdrl.PaperNetwork.random(4)
    network.export_onnx(tmp_path / "m.onnx")
    state = world.state([0], 3)
    (got,) = onnxruntime.InferenceSession(tmp_path / "m.onnx").run(None, network.inputs(state))
    np.testing.assert_allclose(got[0], network.q_values(state), rtol=1e-4)


