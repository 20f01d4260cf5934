"""`graphdrl plan --cover edges`: the shortest walks over all edges, beside flows and matchings of networkx."""

import itertools
import json
import os
import random

import networkx as nx
import pytest

ROUNDS = int(os.environ.get("GRAPHDRL_ROUNDS", "15"))  # 100 by hand: two minutes


def planned(run, tmp_path, graph, *arguments):
    """The plan for a graph of networkx; its edges are written in their order."""
    file = tmp_path / "graph.json"
    file.write_text(json.dumps(nx.node_link_data(graph, edges="links")), encoding="utf-8")
    process = run("graphdrl", "plan", file, "--cover", "edges", "--json", "--threads", "1", *arguments)
    assert process.returncode == 0, process.stderr
    return json.loads(process.stdout)


def checked_cost(graph, plan):
    """The cost of the walk, which must be one."""
    edges = list(graph.edges(data="weight"))
    simple = {(a, b) if graph.is_directed() else (min(a, b), max(a, b)) for a, b, _ in edges if a != b}
    if len(simple) == len(edges):  # no loops, no parallel ones: numbered by their nodes
        edges = sorted(edge if graph.is_directed() else (*sorted(edge[:2]), edge[2]) for edge in edges)
    assert len(plan["walk"]) == len(plan["walk_edges"]) + 1
    cost = 0
    for (a, b), number in zip(itertools.pairwise(plan["walk"]), plan["walk_edges"]):
        u, v, weight = edges[number]
        assert (u, v) == (a, b) or (not graph.is_directed() and (v, u) == (a, b))
        cost += weight
    assert plan["cost"] == cost and plan["edges_walked"] == len(set(plan["walk_edges"]))
    return cost


def cost_of_flow(graph, start, closed):
    """Of the shortest walk over all arcs."""
    network = nx.DiGraph()
    balance = dict.fromkeys(graph, 0)
    for a, b, weight in graph.edges(data="weight"):
        balance[a] -= 1
        balance[b] += 1
        if a != b and weight < network.get_edge_data(a, b, {"weight": float("inf")})["weight"]:
            network.add_edge(a, b, weight=weight)
    if not closed:
        balance[start] += 1
        balance["end"] = -1
        network.add_edges_from((node, "end", {"weight": 0}) for node in graph)
    network.add_nodes_from(balance)
    nx.set_node_attributes(network, {node: -extra for node, extra in balance.items()}, "demand")
    return graph.size("weight") + nx.min_cost_flow_cost(network)


def cost_of_matching(graph, start, closed):
    """Of the shortest walk over all edges."""
    odd = {node for node, degree in graph.degree() if degree % 2}
    if not closed:
        odd ^= {start}
    pairs = nx.Graph()
    for a in odd:
        lengths = nx.single_source_dijkstra_path_length(graph, a)
        pairs.add_weighted_edges_from((a, b, lengths[b]) for b in odd if a < b)
        if not closed:
            pairs.add_edge(a, "end", weight=0)
    return graph.size("weight") + sum(pairs.edges[pair]["weight"] for pair in nx.min_weight_matching(pairs))


@pytest.mark.parametrize("directed", [True, False])
def test_walks_over_all_edges_are_the_shortest(run, tmp_path, directed):
    rng = random.Random(5)
    for _ in range(ROUNDS):
        nodes = rng.randrange(3, 40)
        graph = (nx.MultiDiGraph if directed else nx.MultiGraph)()
        graph.add_nodes_from(range(nodes))
        ring = rng.sample(range(nodes), nodes)  # strongly connected
        for a, b in zip(ring, ring[1:] + ring[:1]):
            graph.add_edge(a, b, weight=rng.randrange(1, 9))
        while graph.number_of_edges() < min(200, nodes * rng.randrange(1, 6)):
            graph.add_edge(rng.randrange(nodes), rng.randrange(nodes), weight=rng.randrange(1, 9))
        closed = rng.random() < 0.5
        plan = planned(run, tmp_path, graph, "--start", "#0", "--end", "start" if closed else "anywhere")
        assert plan["optimal"] and plan["edges_walked"] == graph.number_of_edges() and plan["policy"] == "postman"
        assert plan["walk"][0] == 0 and (plan["walk"][-1] == 0 or not closed)
        expected = (cost_of_flow if directed else cost_of_matching)(graph, 0, closed)
        assert checked_cost(graph, plan) == expected


@pytest.mark.parametrize("directed", [True, False])
def test_a_budget_holds(run, tmp_path, directed):
    rng = random.Random(6)
    graph = (nx.MultiDiGraph if directed else nx.MultiGraph)()
    graph.add_nodes_from(range(20))
    for node in range(20):
        graph.add_edge(node, (node + 1) % 20, weight=2)
        graph.add_edge(node, rng.randrange(20), weight=rng.randrange(1, 5))
    before = 0
    for budget in (0, 10, 40, 80, 1000):
        for end in ("anywhere", "start"):
            plan = planned(run, tmp_path, graph, "--budget", budget, "--end", end, "--start", "#0")
            assert checked_cost(graph, plan) <= budget
            assert plan["edges_walked"] <= plan["max_edges"] <= graph.number_of_edges()
        assert plan["edges_walked"] >= before
        before = plan["edges_walked"]
    assert before == 40 and plan["optimal"]


def test_resets_and_what_is_wrong(run, tmp_path):
    tree = nx.MultiDiGraph([(0, 1, {"weight": 1}), (0, 2, {"weight": 1})])
    plan = planned(run, tmp_path, tree, "--reset-cost", "5", "--start", "#0")
    assert plan["cost"] == 7 and plan["walk_edges"].count(None) == 1 and plan["edges_walked"] == 2
    assert planned(run, tmp_path, tree, "--start", "#0")["edges_walked"] == 1
    for arguments, says in [
        (["paper:a", "--cover", "edges", "--budget", "1.1x"], "a budget in units of cost"),
        (["paper:a", "--cover", "edges", "--reset-cost", "1"], "one way"),
        (["paper:a", "--budget", "9", "--reset-cost", "1"], "edges"),
    ]:
        process = run("graphdrl", "plan", *arguments)
        assert process.returncode == 2 and says in process.stderr and process.stderr.count("\n") == 1
