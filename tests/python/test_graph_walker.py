"""GraphWalker's REST service, led by AltWalker as it comes from the Python package index."""

import json
import random
import re
import subprocess
import sys

import pytest

from conftest import BIN

# Elements by name: vertices, and edges as (name, from, to); the first edge comes from nowhere.
LOGIN = (
    ["v_start", "v_home", "v_error", "v_help"],
    [
        ("e_open", None, 0), ("e_log_in", 0, 1), ("e_mistake", 0, 2), ("e_retry", 2, 0), ("e_log_out", 1, 0),
        ("e_refresh", 1, 1), ("e_ask", 1, 3), ("e_ask_why", 2, 3), ("e_close", 3, 0),
    ],
)  # fmt: skip
SHOP = (
    ["v_shop", "v_product", "v_cart", "v_paid", "v_search"],
    [
        ("e_enter", None, 0), ("e_look", 0, 1), ("e_add", 1, 2), ("e_more", 2, 0), ("e_pay", 2, 3), ("e_on", 3, 0),
        ("e_remove", 2, 2), ("e_find", 0, 4), ("e_pick", 4, 1), ("e_find_more", 4, 4), ("e_leave", 1, 0),
    ],
)  # fmt: skip
RING = (
    [f"v_{i}" for i in range(8)],
    [
        ("e_in", None, 0),
        *[(f"e_on_{i}", i, (i + 1) % 8) for i in range(8)],
        *[(f"e_out_{i}", i, 0) for i in range(1, 8)],
    ],
)
MODELS = {"Login": LOGIN, "Shop": SHOP, "Ring": RING}


def document(name):
    vertices, edges = MODELS[name]
    ends = [{"sourceVertexId": f"v{a}", "targetVertexId": f"v{b}"} for _, a, b in edges]
    model = {
        "name": name,
        "generator": "random(edge_coverage(100))",
        "startElementId": "e0",
        "vertices": [{"id": f"v{i}", "name": vertex} for i, vertex in enumerate(vertices)],
        "edges": [{"id": f"e{i}", "name": edge[0], **end} for i, (edge, end) in enumerate(zip(edges, ends))],
    }
    del model["edges"][0]["sourceVertexId"]
    return {"name": name, "models": [model]}


def steps_of_random_walk(name, rng):
    """What `random(edge_coverage(100))` is documented to do: any edge that leaves, until all have been walked."""
    _, edges = MODELS[name]
    walked, at, steps = {0}, 0, 1
    while len(walked) < len(edges):
        edge = rng.choice([i for i, (_, a, _) in enumerate(edges) if a == at])
        walked.add(edge)
        at = edges[edge][2]
        steps += 1
    return 2 * steps


@pytest.mark.parametrize("name", MODELS)
def test_altwalker_covers_all_edges(name, tmp_path):
    model = tmp_path / "model.json"
    model.write_text(json.dumps(document(name)), encoding="utf-8")
    vertices, edges = MODELS[name]
    methods = "".join(f"    def {one}(self):\n        pass\n\n" for one in [*vertices, *[edge[0] for edge in edges]])
    (tmp_path / "tests").mkdir()
    (tmp_path / "tests" / "__init__.py").touch()
    (tmp_path / "tests" / "test.py").write_text(f"class {name}:\n{methods}", encoding="utf-8")
    generator = "random(edge_coverage(100))"
    command = [BIN / "graphdrl", "serve", "--port", "0", "--model", model, generator]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as server:
        try:
            port = re.search(r":(\d+)/", server.stdout.readline())[1]
            altwalker = [sys.executable, "-m", "altwalker", "online", "tests", "--gw-host", "127.0.0.1"]
            done = subprocess.run(
                [*altwalker, "--gw-port", port, "-m", model, generator, "--report-path"],
                cwd=tmp_path, capture_output=True, text=True, timeout=120, check=False,
            )  # fmt: skip
        finally:
            server.kill()
    assert done.returncode == 0, done.stdout + done.stderr
    assert "Status: PASSED" in done.stdout or "PASS" in done.stdout
    path = [step["name"] for step in json.loads((tmp_path / "path.json").read_text(encoding="utf-8"))]
    assert {edge[0] for edge in edges} | set(vertices) == set(path)
    rng = random.Random(1)
    simulated = sorted(steps_of_random_walk(name, rng) for _ in range(200))
    assert len(path) < simulated[len(simulated) // 20], "fewer steps than nineteen of twenty random walks"
    print(name, len(path), sum(simulated) / len(simulated))  # the table of docs/live.md, by pytest -s
