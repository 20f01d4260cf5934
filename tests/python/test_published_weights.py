"""Weights in the form that the paper's author published, converted and held against that network in plain PyTorch.

Where GRAPHDRL_PUBLISHED_WEIGHTS names the file that the author's Table 2 is of, it is tested too.
"""

import collections
import json
import os
import pathlib
import subprocess
import sys

import graphdrl
import numpy as np
import pytest
import torch
import torch.nn.functional as F
from graphdrl import published

from test_pytorch_agreement import q_values

VARIABLE = "GRAPHDRL_PUBLISHED_WEIGHTS"
# The tensors of a state dict that the author's code saves.
SHAPES = {
    f"{layer}.{name}": shape
    for layer, width in (("conv1", 7), ("conv2", 64), ("conv3", 128))
    for name, shape in {
        "weight": (4, width, width),
        "rnn.weight_ih": (3 * width, width),
        "rnn.weight_hh": (3 * width, width),
        "rnn.bias_ih": (3 * width,),
        "rnn.bias_hh": (3 * width,),
    }.items()
} | {"fc1.weight": (256, 128), "fc1.bias": (256,), "fc2.weight": (4, 256), "fc2.bias": (4,)}
for layer, width in (("bn1", 7), ("bn2", 64)):
    SHAPES |= {f"{layer}.{name}": (width,) for name in ("weight", "bias", "running_mean", "running_var")}


def random_state_dict():
    generator = torch.Generator().manual_seed(11)
    state = collections.OrderedDict()
    for name, shape in SHAPES.items():
        state[name] = torch.rand(shape, generator=generator) - 0.5
        if name.endswith("weight") and not name.startswith("bn"):
            state[name] *= 2 / shape[-1] ** 0.5
        if name.endswith("running_var"):
            state[name] += 1
    for name in ("bn1", "bn2"):
        state[f"{name}.num_batches_tracked"] = torch.tensor(1000)
    return state


@pytest.fixture(params=["random", "published"])
def weights(request, tmp_path):
    """A file of PyTorch's."""
    if request.param == "published":
        if VARIABLE not in os.environ:
            pytest.skip(f"{VARIABLE} names no file with the author's published weights (docs/paper.md)")
        return pathlib.Path(os.environ[VARIABLE])
    torch.save(random_state_dict(), tmp_path / "weights.pt")
    return tmp_path / "weights.pt"


def convert(*arguments):
    command = [sys.executable, "-m", "graphdrl.published", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)


def author_features(world, walk):
    """[N, 7], by the author's definitions, and the edges between neighbouring cells, both ways."""
    height, width = world.blocked.shape
    row, column = (index.ravel() for index in np.indices((height, width)))
    visits = np.zeros(height * width)
    for cell in walk:
        visits[cell] += 1
    apart = np.abs(row[:, None] - row) + np.abs(column[:, None] - column)
    neighbours = apart == 1
    wall = np.isin(row, (0, 9)) | np.isin(column, (0, 9))
    current = np.arange(height * width) == walk[-1]
    columns = [row, column, world.blocked.ravel(), visits, wall, neighbours.astype(int) @ (visits == 0), current]
    return np.stack(columns, axis=1).astype(np.float32), np.stack(np.nonzero(neighbours))


def random_states(count):
    """Worlds and walks of cells; a blocked move repeats the cell."""
    rng = np.random.default_rng(3)
    worlds = [graphdrl.World.from_file(f"paper:{letter}") for letter in "abcdefghij"]
    worlds += [graphdrl.World.random("obstacles", size, seed) for size in (4, 10, 12) for seed in range(3)]
    for i in range(count):
        world = worlds[i % len(worlds)]
        height, width = world.blocked.shape
        walk = [int(rng.choice(np.flatnonzero(~world.blocked.ravel())))]
        for _ in range(int(rng.integers(0, 25))):
            row, column = divmod(walk[-1], width)
            down, right = [(0, -1), (-1, 0), (0, 1), (1, 0)][rng.integers(4)]
            row, column = row + down, column + right
            inside = 0 <= row < height and 0 <= column < width
            walk.append(row * width + column if inside and not world.blocked[row, column] else walk[-1])
        yield world, walk


def test_the_converted_network_is_the_authors(weights, tmp_path):
    done = convert(weights, "-o", tmp_path / "author.safetensors")
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    policy = graphdrl.Policy.load(tmp_path / "author.safetensors")
    assert policy.wall == "zero_or_nine"
    state_dict = torch.load(weights, map_location="cpu", weights_only=True)
    p = {name: tensor.double() for name, tensor in state_dict.items() if not name.endswith("tracked")}
    assert len(p) == 27
    for world, walk in random_states(300):
        features, edges = author_features(world, walk)
        state = world.state([tuple(map(int, divmod(cell, world.blocked.shape[1]))) for cell in walk], budget=100)
        np.testing.assert_array_equal(policy.inputs(state)["x"], features)
        edges = {"from": torch.from_numpy(edges[0]), "to": torch.from_numpy(edges[1])}
        x = torch.from_numpy(features).double()
        graph_of = torch.zeros(len(x), dtype=torch.long)
        expected = F.log_softmax(q_values(p, x, edges, graph_of, 1, training=False, keep_scale=1.0)[0], dim=0)
        got = F.log_softmax(torch.from_numpy(policy.q_values(state)).double(), dim=0)
        assert (got - expected).abs().max() < 1e-4 * max(1, expected.abs().max()), (world, walk)
        assert expected[got.argmax()] > expected.max() - 1e-4, (world, walk)


def test_published_weights_give_their_coverage(run, tmp_path):
    """Over all starts of the ten maps; the author's table has 89.8 and 67.2, of 30 random starts each."""
    if VARIABLE not in os.environ:
        pytest.skip(f"{VARIABLE} names no file with the author's published weights (docs/paper.md)")
    assert convert(os.environ[VARIABLE], "-o", tmp_path / "author.safetensors").returncode == 0
    done = run("graphdrl", "evaluate", "--policy", tmp_path / "author.safetensors", "--all-starts", "--json")
    means = {row["map"]: row["mean"] for row in json.loads(done.stdout)["rows"]}
    assert means.pop("paper:a") == pytest.approx(92.2, abs=0.05)
    assert np.mean(list(means.values())) == pytest.approx(65.5, abs=0.05)


def test_names_of_a_later_pytorch_geometric(tmp_path):
    state = random_state_dict()
    torch.save(state, tmp_path / "old.pt")
    later = {name.replace("bn1.", "bn1.module.").replace("bn2.", "bn2.module."): state[name] for name in state}
    torch.save(later, tmp_path / "new.pt")
    old, new = (published.read_published(tmp_path / name).tensors for name in ("old.pt", "new.pt"))
    assert all(np.array_equal(old[name], new[name]) for name in old)
    for name, values in old.items():
        np.testing.assert_array_equal(values, state[name].numpy())


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda s: s.pop("fc1.bias"), "'fc1.bias'"),
        (lambda s: s.update(extra=torch.zeros(1)), "'extra'"),
        (lambda s: s.update({"conv1.weight": torch.zeros(3, 7, 7)}), "expected [4, 7, 7], got [3, 7, 7]"),
        (lambda s: s.update({"fc2.bias": torch.full((4,), torch.nan)}), "a value that no network can have"),
        (lambda s: s.update({"fc2.bias": 7}), "bad tensor 'fc2.bias': expected numbers, got 'int'"),
    ],
)
def test_other_tensors_are_refused(tmp_path, change, message):
    state = random_state_dict()
    change(state)
    torch.save(state, tmp_path / "bad.pt")
    refused(convert(tmp_path / "bad.pt", "-o", tmp_path / "out"), "bad.pt", message)
    assert not (tmp_path / "out").exists()


class Call:
    """Unpickles as a call of print."""

    def __reduce__(self):
        return print, ("executed",)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "not a PyTorch file"),
        (b"no weights", "not a PyTorch file"),
        (b"PK\x03\x04 no archive", "not a PyTorch file"),
        (torch.zeros(3), "expected a state dict, got 'Tensor'"),
        ({"fc2.bias": Call()}, "not a PyTorch file with tensors alone"),
    ],
)
def test_other_files_are_refused(tmp_path, content, message):
    if isinstance(content, bytes):
        (tmp_path / "bad.pt").write_bytes(content)
    else:
        torch.save(content, tmp_path / "bad.pt")
    refused(convert(tmp_path / "bad.pt", "-o", tmp_path / "out"), "bad.pt", message)


def test_bad_arguments(tmp_path):
    torch.save(random_state_dict(), tmp_path / "good.pt")
    refused(convert(tmp_path / "none.pt", "-o", tmp_path / "out"), "none.pt", "No such file")
    refused(convert(tmp_path, "-o", tmp_path / "out"), "Is a directory")
    refused(convert(tmp_path / "good.pt", "-o", tmp_path / "no" / "out"), "out")
    refused(convert(tmp_path / "good.pt"), "-o")


def refused(done, *parts):
    assert done.returncode == 2 and done.stdout == "" and done.stderr.count("\n") == 1, done
    for part in parts:
        assert part in done.stderr
