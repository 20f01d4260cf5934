#!/usr/bin/env python3
"""Our learning step beside the same step in PyTorch Geometric and in plain PyTorch.

The same weights, the same replay buffer of states of the paper's map a and the same number of threads; the three take
turns within one run, and their losses must agree before anything is timed. A step is: sample 32 transitions, build the
batch, both forward passes, loss, backward, clamp, Adam, soft update. benchmarks/compare_pyg sets up and runs this.
"""

import argparse
import copy
import json
import pathlib
import statistics
import struct
import subprocess
import tempfile
import time

import numpy
import torch
import torch.nn.functional as F
from torch import nn
from torch_geometric.data import Batch, Data
from torch_geometric.nn import GatedGraphConv, global_add_pool

DTYPES = {"F32": "<f4", "F64": "<f8", "I64": "<i8"}
GRAPHS, SIDE = 32, 5


def read_safetensors(path):
    content = pathlib.Path(path).read_bytes()
    (length,) = struct.unpack("<Q", content[:8])
    header = json.loads(content[8 : 8 + length])
    header.pop("__metadata__", None)
    data = content[8 + length :]
    return {
        name: torch.from_numpy(
            numpy.frombuffer(data[slice(*e["data_offsets"])], DTYPES[e["dtype"]]).reshape(e["shape"]).copy()
        )
        for name, e in header.items()
    }


def grid_edges(graphs):
    """Edge index [2, E] of `graphs` grids laid end to end."""
    cells = [(r, c) for r in range(SIDE) for c in range(SIDE)]
    pairs = [(r * SIDE + c, s * SIDE + d) for r, c in cells for s, d in cells if abs(r - s) + abs(c - d) == 1]
    edges = torch.tensor(pairs).T
    return torch.cat([edges + g * SIDE * SIDE for g in range(graphs)], dim=1)


class PlainGatedGraphConv(nn.Module):
    """GatedGraphConv of PyTorch's own operators, with its parameters' names."""

    def __init__(self, width, steps):
        super().__init__()
        self.weight = nn.Parameter(torch.empty(steps, width, width))
        self.rnn = nn.GRUCell(width, width)

    def forward(self, x, edges):
        h = F.pad(x, (0, self.weight.shape[1] - x.shape[1]))
        for theta in self.weight:
            message = torch.zeros_like(h).index_add_(0, edges[1], (h @ theta)[edges[0]])
            h = self.rnn(message, h)
        return h


class Network(nn.Module):
    def __init__(self, conv):
        super().__init__()
        self.conv1, self.conv2, self.conv3 = (conv(width, 4) for width in (7, 64, 128))
        self.bn1, self.bn2 = nn.BatchNorm1d(7), nn.BatchNorm1d(64)
        self.fc1, self.fc2 = nn.Linear(128, 256), nn.Linear(256, 4)

    def forward(self, x, edges, graph_of, keep_scale=None):
        h = self.bn1(F.elu(self.conv1(x, edges)))
        h = self.bn2(F.elu(self.conv2(h, edges)))
        h = global_add_pool(F.elu(self.conv3(h, edges)), graph_of)
        h = F.elu(self.fc1(h))
        h = F.dropout(h, 0.5, self.training) if keep_scale is None else h * keep_scale
        return self.fc2(h)


class Peer:
    """A formulation in PyTorch, with the replay buffer and the weights of our side."""

    def __init__(self, conv, t):
        self.t = t
        self.online = Network(conv)
        weights = {
            name: tensor for name, tensor in t.items() if name.split(".")[0] in dict(self.online.named_children())
        }
        missing = self.online.load_state_dict(weights, strict=False).missing_keys
        assert all(name.endswith("num_batches_tracked") for name in missing), missing
        self.target = copy.deepcopy(self.online).eval()
        self.adam = torch.optim.Adam(self.online.parameters(), lr=1e-3)

    def loss(self, indices, keep_scale=None):
        with torch.no_grad():
            target = self.t["rewards"][indices] + 0.99 * self.target(*self.batch("next_x", indices)).max(1)[0]
        q = self.online(*self.batch("x", indices), keep_scale)
        return F.mse_loss(q.gather(1, self.t["actions"][indices, None]).squeeze(1), target)

    def learn(self, count):
        start = time.perf_counter()
        for _ in range(count):
            indices = torch.from_numpy(numpy.random.randint(0, len(self.t["x"]), GRAPHS))
            self.adam.zero_grad()
            self.loss(indices).backward()
            for parameter in self.online.parameters():
                parameter.grad.clamp_(-1, 1)
            self.adam.step()
            with torch.no_grad():
                for ours, theirs in zip(self.target.state_dict().values(), self.online.state_dict().values()):
                    if ours.is_floating_point():
                        ours.lerp_(theirs, 1e-3)
        return 1e3 * (time.perf_counter() - start) / count

    def move(self, count):
        self.online.eval()
        start = time.perf_counter()
        for i in range(count):
            with torch.no_grad():
                self.online(*self.batch("x", [i])).argmax().item()
        elapsed = time.perf_counter() - start
        self.online.train()
        return 1e3 * elapsed / count


class PlainPeer(Peer):
    """States as rows of one tensor, edges and graph numbers built once."""

    def __init__(self, t):
        super().__init__(PlainGatedGraphConv, t)
        self.edges = {count: grid_edges(count) for count in (1, GRAPHS)}
        self.graph_of = {count: torch.arange(count).repeat_interleave(SIDE * SIDE) for count in (1, GRAPHS)}

    def batch(self, key, indices):
        return self.t[key][indices].flatten(0, 1), self.edges[len(indices)], self.graph_of[len(indices)]


class GeometricPeer(Peer):
    """As the author's code: states as Data objects, collected into a Batch when sampled."""

    def __init__(self, t):
        super().__init__(GatedGraphConv, t)
        edges = grid_edges(1)
        self.states = {key: [Data(x=x, edge_index=edges) for x in t[key]] for key in ("x", "next_x")}

    def batch(self, key, indices):
        batch = Batch.from_data_list([self.states[key][i] for i in indices])
        return batch.x, batch.edge_index, batch.batch


class Ours:
    def __init__(self, program, file, threads):
        self.process = subprocess.Popen(
            [program, file, str(threads)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )
        self.ask("learn 1")

    def ask(self, line):
        self.process.stdin.write(line + "\n")
        self.process.stdin.flush()
        return float(self.process.stdout.readline())

    def learn(self, count):
        return self.ask(f"learn {count}")

    def move(self, count):
        return self.ask(f"move {count}")


def compare(program, threads, rounds):
    torch.set_num_threads(threads)
    torch.manual_seed(1)
    with tempfile.TemporaryDirectory() as folder:
        file = f"{folder}/batch.safetensors"
        ours = Ours(program, file, threads)
        t = read_safetensors(file)
        sides = {
            "GraphDRL": ours,
            "plain PyTorch": PlainPeer(t),
            "PyTorch Geometric": GeometricPeer(t),
        }
        for name, side in sides.items():
            if side is not ours:
                loss = side.loss(torch.arange(GRAPHS), t["keep_scale"]).item()
                assert abs(loss - t["loss"].item()) < 1e-4 * abs(loss), (name, loss, t["loss"].item())
        print(f"{threads} thread{'s' if threads > 1 else ''}, losses agree ({t['loss'].item():.6f})")
        for task, count in (("learn", 5), ("move", 50)):
            times = {name: [] for name in sides}
            for name, side in sides.items():  # warm up
                getattr(side, task)(count)
            for _ in range(rounds):
                for name, side in sides.items():
                    time.sleep(0.05)  # the side before still has threads that wait in a loop
                    times[name].append(getattr(side, task)(count))
            base = times["GraphDRL"]
            for name, values in times.items():
                ratio = statistics.median(value / own for value, own in zip(values, base))
                print(f"  {task:5}  {name:17}  {statistics.median(values):8.3f} ms   {ratio:6.2f} times ours")
        ours.process.stdin.close()
        ours.process.wait()


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program", help="learning_step_peer of the build")
    parser.add_argument("--threads", type=int, nargs="+", default=[1, 2])
    parser.add_argument("--rounds", type=int, default=9)
    arguments = parser.parse_args()
    for threads in arguments.threads:
        compare(arguments.program, threads, arguments.rounds)


if __name__ == "__main__":
    main()
