"""Files that other programs write, read by `graphdrl maps info` with the counts that those programs state."""

import json
import os
import pathlib
import random
import subprocess

import igraph
import networkx
import numpy
import pytest
from programs import require_program

GRAPHDRL = pathlib.Path(os.environ["GRAPHDRL_BIN"]) / "graphdrl"


def info(path, *options):
    done = subprocess.run([GRAPHDRL, "maps", "info", path, "--json", *options], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def counts(path):
    found = info(path)
    return found["nodes"], found["edges"], found["directed"], found["weighted"], found["components"]


def stated(graph, weighted):
    components = networkx.number_connected_components(graph.to_undirected())
    return graph.number_of_nodes(), graph.number_of_edges(), graph.is_directed(), weighted, components


def weighted_graph(directed):
    chance = random.Random(7)
    graph = networkx.gnp_random_graph(40, 0.12, seed=3, directed=directed)
    graph = networkx.relabel_nodes(graph, {node: f'Ort "{node}" & ü' for node in graph})
    for node, data in graph.nodes(data=True):
        data.update(x=chance.random(), y=chance.random(), prize=chance.randint(1, 9))
    for _, _, data in graph.edges(data=True):
        data["weight"] = round(chance.uniform(0.5, 3), 3)
    return graph


NETWORKX = {
    "graph.graphml": networkx.write_graphml,
    "graph.gml": networkx.write_gml,
    "graph.json": lambda graph, path: path.write_text(json.dumps(networkx.node_link_data(graph, edges="edges"))),
    "graph.dot": lambda graph, path: networkx.nx_pydot.write_dot(graph, path),
}


@pytest.mark.parametrize("directed", [False, True])
@pytest.mark.parametrize("name", NETWORKX)
def test_networkx(tmp_path, name, directed):
    graph = weighted_graph(directed)
    NETWORKX[name](graph, tmp_path / name)
    assert counts(tmp_path / name) == stated(graph, True)


def test_networkx_lists_and_pajek(tmp_path):
    graph = networkx.convert_node_labels_to_integers(weighted_graph(False))
    with_edges = graph.edge_subgraph(graph.edges)
    networkx.write_weighted_edgelist(graph, tmp_path / "weighted.txt")
    networkx.write_edgelist(graph, tmp_path / "data.txt")
    for name in ("weighted.txt", "data.txt"):
        assert counts(tmp_path / name) == stated(with_edges, True)
    networkx.write_pajek(networkx.Graph((a, b, {"weight": d["weight"]}) for a, b, d in graph.edges(data=True)),
                         tmp_path / "graph.net")
    assert counts(tmp_path / "graph.net") == stated(with_edges, True)


@pytest.mark.parametrize("name", ["graph.graphml", "graph.gml", "graph.net", "graph.dot", "graph.txt", "graph.ncol"])
def test_igraph(tmp_path, name):
    random.seed(5)
    graph = igraph.Graph.Barabasi(60, 3)
    graph.vs["name"] = [f"n{i}" for i in range(60)]
    if name != "graph.txt":
        graph.es["weight"] = [0.5 + i for i in range(graph.ecount())]
    path = tmp_path / name
    if name.endswith("txt"):
        graph.write_edgelist(str(path))
    else:
        getattr(graph, "write_" + {"net": "pajek"}.get(path.suffix[1:], path.suffix[1:]))(str(path))
    assert counts(path) == (60, graph.ecount(), False, name != "graph.txt", len(graph.connected_components()))


def test_numpy(tmp_path):
    grid = networkx.to_numpy_array(networkx.grid_2d_graph(5, 5))
    obstacles = numpy.zeros((25, 25))
    obstacles[3, 3] = obstacles[6, 6] = 1
    numpy.save(tmp_path / "author.npy", numpy.array([grid, obstacles]))
    assert counts(tmp_path / "author.npy") == (25, 40, False, False, 1)
    assert info(tmp_path / "author.npy")["valid_nodes"] == 23
    numpy.save(tmp_path / "ring.npy", numpy.roll(numpy.eye(7, dtype=numpy.int32), 1, axis=1))
    assert counts(tmp_path / "ring.npy") == (7, 7, True, False, 1)


@pytest.mark.parametrize("layout", ["dot", "neato", "sfdp"])
def test_graphviz(tmp_path, layout):
    source = """digraph "G" { rankdir=LR; node [shape=box]; start -> {a b c}; a -> b [label="x" weight=3];
        subgraph cluster_1 { c; d; c -> d } d -> start; "node with \\"quotes\\"" -> a; { rank=same; a; b } }"""
    program = require_program(layout, "-V", "graphviz version")
    laid = subprocess.run([program, "-Tdot"], input=source, capture_output=True, text=True, check=True).stdout
    (tmp_path / "laid.dot").write_text(laid)
    assert counts(tmp_path / "laid.dot") == (6, 7, True, True, 1)
    assert info(tmp_path / "laid.dot")["bounding_box"] is not None


@pytest.mark.parametrize("command", ["map.png", "map.pgm", "-compress none map.pgm", "map.pbm", "map.ppm",
                                     "-depth 16 map.png", "-colors 8 -type Palette map.png", "-alpha on map.png",
                                     "-interlace PNG map.png"])  # fmt: skip
def test_imagemagick(tmp_path, command):
    options = command.split()
    convert = require_program("convert", "-version", "^Version: ImageMagick")
    subprocess.run([convert, "-size", "40x30", "xc:white", "-fill", "black", "-draw", "rectangle 5,5 10,20",
                    "-draw", "rectangle 20,0 20,25", *options], cwd=tmp_path, check=True)
    found = info(tmp_path / options[-1])
    assert (found["nodes"], found["valid_nodes"], found["components"]) == (1200, 1200 - 6 * 16 - 26, 1)
    cells = info(tmp_path / options[-1], "--cell-pixels", "5")
    assert (cells["nodes"], cells["valid_nodes"]) == (48, 48 - 2 * 4 - 6)
