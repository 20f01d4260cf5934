"""`graphdrl plan --cover edges`: the shortest walks over all edges, beside flows and matchings of networkx."""

import itertools
import json
import pickle
import random

import networkx as nx
import pytest

import graphdrl

ROUNDS = 100


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


DOOR = """digraph { a -> b [label=go]; b -> b [label=stay]; b -> a [label=back]; a -> b [label=jump];
b -> c [label=out]; c -> a [label=home]; c -> d [label=die]; }"""


def done(run, *arguments):
    """What the program prints."""
    process = run("graphdrl", *arguments)
    assert process.returncode == 0, process.stderr
    return process.stdout


def refused(run, *arguments):
    """The line with which it refuses."""
    process = run("graphdrl", *arguments)
    assert process.returncode == 2 and process.stderr.count("\n") == 1, process.stderr
    return process.stderr


@pytest.fixture
def door(tmp_path):
    path = tmp_path / "door.dot"
    path.write_text(DOOR)
    return path


@pytest.mark.parametrize("command", ["plan", "explore"])
def test_python_covers_edges_as_the_program(command, door, tmp_path, run):
    world = graphdrl.World.from_file(door)
    walk = getattr(graphdrl, command)(world, cover="edges", reset_cost=2)
    printed = json.loads(done(run, command, door, "--cover", "edges", "--reset-cost", "2", "--json"))
    printed.pop("elapsed_s")
    document = walk.to_dict()
    document.pop("elapsed_s")
    assert document == printed
    assert walk.walk_edges == printed["walk_edges"] and walk.edges_walked == walk.edge_count == 7
    assert walk.edge_bound == 7 and walk.optimal == printed["optimal"] == (walk.cost == 9)
    assert walk.costs[-1] == walk.cost and len(walk.costs) == len(walk.walk)
    again = pickle.loads(pickle.dumps(walk))
    assert again.to_dict() | {"elapsed_s": 0, "policy": ""} == walk.to_dict() | {"elapsed_s": 0, "policy": ""}
    walk.save(tmp_path / "walk.html")


def test_explored_edges_are_known_step_by_step(door, run):
    document = json.loads(done(run, "explore", door, "--cover", "edges", "--reset-cost", "1", "--price", "1", "--json"))
    assert len(document["seen_after_step"]) == len(document["walk"]) == len(document["walk_edges"]) + 1
    assert document["known"] == {"edges_walked": 7.0, "cost": 9.0}
    assert document["price_of_ignorance"] == document["cost"] / 9


def test_walks_over_edges_are_checked(door, tmp_path, run):
    for command in ("plan", "explore"):
        done(run, command, door, "--cover", "edges", "--reset-cost", "2", "--out", tmp_path / "walk.json")
        text = done(run, "check", door, tmp_path / "walk.json")
        assert "walked 7 of 7 edges, 100.0 %" in text
        done(run, "report", tmp_path / "walk.json", "--map", door, "--out", tmp_path / "page.html")
    (tmp_path / "walk").write_text("a b b a b c d\n")
    assert "walked 6 of 7 edges" in done(run, "check", door, tmp_path / "walk", "--cover", "edges")
    (tmp_path / "walk").write_text("a b b c d a b a b c a\n")
    check = ("check", door, tmp_path / "walk", "--cover", "edges")
    assert "no edge leads from node 3 to node 0, step 5" in refused(run, *check)
    text = done(run, *check, "--reset-cost", "2")
    assert "walked 7 of 7 edges, 100.0 %, for 11 of a budget of 11, 1 reset among it" in text
    (tmp_path / "walk").write_text('{"walk": [0, 1], "walk_edges": [4], "cover": "edges"}')
    assert "edge '4' does not lead from node 0 to node 1" in refused(run, "check", door, tmp_path / "walk")
    (tmp_path / "walk").write_text('{"walk": [0, 1], "walk_edges": [], "cover": "edges"}')
    assert "walk_edges" in refused(run, "check", door, tmp_path / "walk")


def test_policies_are_compared_by_edges(door, run):
    options = ["--maps", door, "--cover", "edges", "--budget", "5", "--start", "a", "--json"]
    known = json.loads(done(run, "evaluate", *options))
    assert [(row["policy"], row["mean"]) for row in known["rows"]] == [("search", pytest.approx(500 / 7))]
    options = ["--maps", door, "--cover", "edges", "--reset-cost", "1", "--reveal", "edges", "--start", "a"]
    unknown = json.loads(done(run, "evaluate", *options, "--until", "covered", "--price", "1", "--json"))
    costs = {row["policy"]: row["mean"] for row in unknown["rows"]}
    assert list(costs) == ["dfs", "nearest", "novelty"] and min(costs.values()) >= 9
    assert all(row["known"]["mean"] == 9 for row in unknown["rows"])
    assert "not all edges can be walked" in refused(
        run,
        "evaluate", "--maps", door, "--cover", "edges", "--until", "covered", "--start", "d"
    )
    assert "no such policy" in refused(run, "evaluate", "--maps", door, "--cover", "edges", "--policy", "best")
    assert "resets go with" in refused(run, "evaluate", "--maps", door, "--reset-cost", "1")
    rows = graphdrl.evaluate(graphdrl.World.from_file(door), "search", 5, cover="edges", episodes=3)
    assert len(rows) == 1 and 0 < rows[0]["mean"] <= 100


def test_bounds_are_those_of_edges(door):
    world = graphdrl.World.from_file(door)
    assert graphdrl.upper_bound(world, 3, cover="edges") == 3
    assert graphdrl.upper_bound(world, 100, start="d", cover="edges") == 0
    assert graphdrl.upper_bound(world, 100, start="c", cover="edges", reset_cost=1) == 7
    for wrong in ({"cover": "faces"}, {"reset_cost": 1}, {"cover": "edges", "reset_cost": -1}):
        with pytest.raises(graphdrl.Error):
            graphdrl.upper_bound(world, 3, **wrong)


def test_loops_and_parallel_edges_of_networkx_are_covered():
    graph = nx.MultiGraph([("a", "b"), ("a", "b"), ("b", "b"), ("b", "c")])
    world = graphdrl.World.from_networkx(graph)
    walk = graphdrl.plan(world, cover="edges", end="start")
    assert (walk.edges_walked, walk.edge_count, walk.cost) == (4, 4, 5)
    edges = world.all_edges()
    assert edges.ends.tolist() == [[0, 1], [0, 1], [1, 1], [1, 2]] and edges.costs.tolist() == [1] * 4
    assert edges.labels == [] and edges.prizes.tolist() == []
    assert sorted(walk.walk_edges) == [0, 1, 2, 3, 3] and world.edge_count == 2
    again = pickle.loads(pickle.dumps(world)).all_edges()
    assert again.ends.tolist() == edges.ends.tolist() and again.costs.tolist() == [1] * 4


MIXED = """<graphml xmlns="http://graphml.graphdrawing.org/xmlns"><graph edgedefault="directed">
<node id="a"/><node id="b"/><node id="c"/>
<edge source="a" target="b"/>
<edge source="b" target="c" directed="false"/><edge source="a" target="c" directed="false"/>
</graph></graphml>"""


def test_edges_that_lead_both_ways_count_once_beside_others(tmp_path, run):
    (tmp_path / "mixed.graphml").write_text(MIXED)
    done(run, "maps", "convert", tmp_path / "mixed.graphml", "--out", tmp_path / "again.graphml")
    world = graphdrl.World.from_file(tmp_path / "again.graphml")
    for same in (world, pickle.loads(pickle.dumps(world))):
        assert same.all_edges().both_ways == [False, True, True]
        for explored in (graphdrl.plan(same, cover="edges", end="start"), graphdrl.explore(same, cover="edges")):
            assert (explored.edges_walked, explored.edge_count, explored.cost) == (3, 3, 3)
    for command in ("plan", "explore"):
        done(run, command, tmp_path / "mixed.graphml", "--cover", "edges", "--out", tmp_path / "walk.json")
        text = done(run, "check", tmp_path / "mixed.graphml", tmp_path / "walk.json")
        assert "walked 3 of 3 edges" in text and "optimal" in text


def test_edges_have_prizes_of_their_own(tmp_path, run):
    graph = nx.DiGraph()
    graph.add_edge("a", "b", prize=5)
    graph.add_edge("b", "a")
    graph.add_edge("a", "c", prize=0)
    graph.add_edge("c", "a", prize=2.5)
    for name, text in {
        "g.json": json.dumps(nx.node_link_data(graph, edges="links")),
        "g.graphml": "\n".join(nx.generate_graphml(graph)),
        "g.dot": "digraph { a -> b [prize=5]; b -> a; a -> c [prize=0]; c -> a [prize=2.5]; }",
    }.items():
        (tmp_path / name).write_text(text)
        for ending in ("json", "graphml", "dot"):  # written and read again
            done(run, "maps", "convert", tmp_path / name, "--out", tmp_path / f"again.{ending}")
            walk = json.loads(
                done(run, "plan", tmp_path / f"again.{ending}", "--cover", "edges", "--budget", "2", "--json")
            )
            assert (walk["edge_prize"], walk["max_edge_prize"], walk["optimal"]) == (6, 6, True)
    world = graphdrl.World.from_networkx(graph)
    for same in (world, pickle.loads(pickle.dumps(world)), graphdrl.World.from_file(tmp_path / "g.dot")):
        assert same.all_edges().prizes.tolist() == [5, 0, 1, 2.5] or same.all_edges().prizes.tolist() == [5, 1, 0, 2.5]
        assert graphdrl.plan(same, 2, cover="edges").edge_prize == 6
        assert graphdrl.upper_bound(same, 1, cover="edges") == 5
    text = done(run, "plan", tmp_path / "g.dot", "--cover", "edges", "--budget", "1")
    assert "prize 5 of 8.5, 58.8 %" in text and "no walk is worth more" in text
