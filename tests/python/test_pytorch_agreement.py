"""The paper's network and learning step, written again in plain PyTorch: equal weights must give equal numbers."""

import json

import pytest
import torch
import torch.nn.functional as F

from conftest import read_safetensors


def relative_error(got, expected):
    return ((got - expected).abs().max() / expected.abs().max().clamp_min(1e-12)).item()


def gated_graph_conv(p, name, x, edges):
    weight = p[f"{name}.weight"]
    h = F.pad(x, (0, weight.shape[1] - x.shape[1]))
    for theta in weight:
        sent = h @ theta
        message = torch.zeros_like(sent).index_add(0, edges["to"], sent[edges["from"]])
        h = torch.gru_cell(
            message, h, *(p[f"{name}.rnn.{part}"] for part in ("weight_ih", "weight_hh", "bias_ih", "bias_hh"))
        )
    return h


def q_values(p, x, edges, graph_of, graphs, training, keep_scale):
    h = x
    for layer in (1, 2, 3):
        h = F.elu(gated_graph_conv(p, f"conv{layer}", h, edges))
        if layer < 3:
            bn = [p[f"bn{layer}.{part}"] for part in ("running_mean", "running_var", "weight", "bias")]
            h = F.batch_norm(h, *bn, training=training, momentum=0.1, eps=1e-5)
    pooled = torch.zeros(graphs, h.shape[1], dtype=h.dtype).index_add(0, graph_of, h)
    hidden = F.elu(F.linear(pooled, p["fc1.weight"], p["fc1.bias"])) * keep_scale
    return F.linear(hidden, p["fc2.weight"], p["fc2.bias"])


@pytest.mark.parametrize("algorithm", [[], ["--double-dqn"]])
def test_learning_step(run, tmp_path, algorithm):
    process = run("learning_step_probe", tmp_path / "probe", *algorithm)
    assert process.returncode == 0, process.stderr
    t = {name: torch.from_numpy(values) for name, values in read_safetensors(tmp_path / "probe")[0].items()}
    # In double: what is left of a difference is the kernel's own rounding.
    part = lambda prefix: {k[len(prefix) :]: v.double() for k, v in t.items() if k.startswith(prefix)}
    online, target, after, grad = part("online."), part("target."), part("after."), part("grad.")
    edges = {"from": t["edges.from"], "to": t["edges.to"]}
    graphs = len(t["first_nodes"]) - 1
    graph_of = torch.repeat_interleave(torch.arange(graphs), t["first_nodes"].diff())
    x, next_x = t["x"].double(), t["next_x"].double()

    def q_of(p, features, training=False, keep_scale=1.0):
        return q_values(p, features, edges, graph_of, graphs, training, keep_scale)

    assert relative_error(t["q"].double(), q_of(online, x)) < 1e-4

    next_q = q_of(target, next_x)
    chooser = q_of(online, next_x) if algorithm else next_q
    best = next_q.gather(1, chooser.argmax(1, keepdim=True)).squeeze(1)
    expected_target = t["rewards"].double() + t["discount"] * best * (t["terminal"] == 0)

    trainable = [name for name in online if "running" not in name]
    for name in trainable:
        online[name].requires_grad_(True)
    q = q_of(online, x, training=True, keep_scale=t["keep_scale"].double())
    loss = F.mse_loss(q.gather(1, t["actions"][:, None]).squeeze(1), expected_target)
    loss.backward()
    assert relative_error(t["loss"], loss.detach()) < 1e-4
    assert sum(online[name].numel() for name in trainable) == 240_678
    for name in trainable:
        assert relative_error(grad[name], online[name].grad) < 1e-4, name
    for name in online:  # the forward pass in train mode moved batch norm's running statistics
        if "running" in name:
            assert relative_error(after[name], online[name]) < 1e-5, name


def test_policy_file_is_a_state_dict(run, trained):
    """A PyTorch model with the file's tensors gives the Q-values that `inspect` shows."""
    folder, _ = trained
    tensors, metadata = read_safetensors(folder / "policy.safetensors")
    assert '"kind":"paper"' in metadata["network"]
    assert len(tensors) == 27
    p = {name: torch.from_numpy(values) for name, values in tensors.items()}
    assert all(tensor.dtype == torch.float32 for tensor in p.values())
    arguments = ["--map", "paper:h", "--walk", "0,0,5,10", "--json"]
    steps = json.loads(run("graphdrl", "inspect", folder / "policy.safetensors", *arguments).stdout)["steps"]
    pairs = [
        (r * 5 + c, s * 5 + d)
        for r in range(5)
        for c in range(5)
        for s in range(5)
        for d in range(5)
        if abs(r - s) + abs(c - d) == 1
    ]
    edges = {"to": torch.tensor([a for a, _ in pairs]), "from": torch.tensor([b for _, b in pairs])}
    for step in steps:
        features = torch.tensor(step["features"], dtype=torch.float32)
        q = q_values(p, features, edges, torch.zeros(25, dtype=torch.long), 1, training=False, keep_scale=1.0)
        assert relative_error(torch.tensor(step["q"]), q[0]) < 1e-4
