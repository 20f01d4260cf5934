"""The Python package, beside the program and beside networkx."""

import concurrent.futures
import copy
import json
import os
import pathlib
import pickle
import signal
import subprocess
import sys
import threading
import time

import graphdrl
import networkx as nx
import numpy as np
import pytest
import scipy.sparse
from hypothesis import given, settings
from hypothesis import strategies as st

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
PROGRAM = pathlib.Path(os.environ["GRAPHDRL_BIN"]) / "graphdrl"
FAMILIES = [
    ("obstacles", 7, {}),
    ("maze", 7, {}),
    ("houses", 9, {}),
    ("tree", 12, {"weighted": True}),
    ("erdos-renyi", 14, {"directed": True}),
    ("geometric", 20, {"weighted": True, "directed": True}),
    ("watts-strogatz", 16, {}),
    ("barabasi-albert", 14, {"weighted": True}),
]


def run_json(*arguments):
    done = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, check=True)
    return json.loads(done.stdout)


def neutral_worlds(count):
    """Worlds of all families, as arrays: each is what a file of the command line holds, too."""
    for i in range(count):
        family, size, options = FAMILIES[i % len(FAMILIES)]
        yield graphdrl.World.random(family, size, i, **options)


def write_world(world, path):
    if world.is_grid:
        path.write_text("\n".join("".join("#" if cell else "." for cell in row) for row in world.blocked) + "\n")
        return
    ends, costs = world.edges()
    path.write_text(
        json.dumps(
            {
                "directed": world.directed,
                "multigraph": False,
                "nodes": [{"id": node} for node in range(world.node_count)],
                "edges": [{"source": int(a), "target": int(b), "cost": c} for (a, b), c in zip(ends, costs.tolist())],
            }
        )
    )


def start_of(world):
    return int(np.flatnonzero(~world.blocked.ravel())[0])


def test_walks_are_those_of_the_program(tmp_path):
    for i, world in enumerate(neutral_worlds(200)):
        path = tmp_path / f"world-{i}.{'txt' if world.is_grid else 'json'}"
        write_world(world, path)
        expected = run_json("plan", path, "--budget", "0.6x", "--start", f"#{start_of(world)}", "--json")
        answer = graphdrl.plan(world, "0.6x", start=world.names([start_of(world)])[0]).to_dict()
        assert json.dumps(answer["walk"]) == json.dumps(expected["walk"]), path
        assert answer["upper_bound"] == expected["upper_bound"]


EXPLORATIONS = [
    {},
    {"policy": "nearest", "reveal": "radius:2", "end": "start"},
    {"policy": "random-walk", "seed": 7},
    {"policy": "search:300", "reveal": "radius:1.5", "score": "seen"},
    {"policy": "explorer", "end": "start"},
    {"policy": "frontier", "until_covered": True, "score": "seen"},
]


def test_explorations_are_those_of_the_program(tmp_path):
    for i, world in enumerate(neutral_worlds(24)):
        path = tmp_path / f"world-{i}.{'txt' if world.is_grid else 'json'}"
        write_world(world, path)
        options = EXPLORATIONS[i % len(EXPLORATIONS)]
        if world.is_grid and i % 2:
            options = options | {"reveal": "sight:3"}
        budget = None if "until_covered" in options else "0.7x"
        words = ["--budget", budget] if budget else ["--until", "covered"]
        for name, value in options.items():
            words += [] if name == "until_covered" else [f"--{name}", value]
        expected = run_json("explore", path, *words, "--start", f"#{start_of(world)}", "--json")
        plan = graphdrl.explore(world, budget, start=world.names([start_of(world)])[0], **options)
        assert plan.nodes.tolist() == expected["walk"], path
        assert [world.number(node) for node in plan.seen] == expected["seen_nodes"]
        assert plan.seen_after_step.tolist() == expected["seen_after_step"]
        assert plan.to_dict() | {"elapsed_s": 0} == expected | {"elapsed_s": 0, "map": world.name}
        again = pickle.loads(pickle.dumps(plan))
        assert again.to_json() == plan.to_json() and again.prize == plan.prize and again.seen == plan.seen


class Nearest:
    """The nearest rule, by what states say; checks that they say what visits have shown and no more."""

    def __init__(self, world):
        self.world = world
        self.states = 0

    def __call__(self, state):
        self.states += 1
        assert state.walk[0] == 0 and state.walk[-1] == state.position
        assert len(state.visits) == len(state.prizes) == len(state.seen_at)
        assert state.places.shape == (len(state.visits) if self.world.places is not None else 0, 2)
        assert not set(state.frontier) & set(np.flatnonzero(state.visits))
        graph = nx.DiGraph() if self.world.directed else nx.Graph()
        graph.add_nodes_from(range(len(state.visits)))
        graph.add_weighted_edges_from((*edge, cost) for edge, cost in zip(state.edges.tolist(), state.edge_costs))
        assert set(state.moves) <= set(graph[state.position])
        visited = set(np.flatnonzero(state.visits).tolist())
        assert not [edge for edge in graph.edges if not visited & set(edge)]  # visits alone show edges
        assert set(graph) == visited | {next for node in visited for next in graph[node]}
        for node in set(graph) - visited:
            for other in list(graph[node]):
                if graph.is_directed() or other not in visited:
                    graph.remove_edge(node, other)
        costs, ways = nx.single_source_dijkstra(graph, state.position)
        new = [(costs[node], node) for node in ways if node not in visited]
        return ways[min(new)[1]][1] if new and costs[min(new)[1]] <= state.budget - state.spent else None


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"reveal": "smell"}, "bad reveal: expected all, edges"),
        ({"reveal": None}, "bad reveal: expected text"),
        ({"score": "heard"}, "bad score: expected visited or seen"),
        ({"until_covered": True}, "bad budget: until_covered takes none, got 9"),
        ({"until_covered": 1}, "bad until_covered"),
        ({"think_time": 0}, "bad think time: expected seconds above 0, got 0"),
        ({"think_time": "long"}, "bad think time: expected a number"),
        ({"reveal": "sight:3"}, "sight needs a map of cells"),
        ({"budget": "much"}, "bad budget"),
    ],
)
def test_explorations_say_what_to_change(options, message):
    with pytest.raises(graphdrl.Error, match=message):
        graphdrl.explore(graphdrl.World.from_edges([[0, 1], [1, 2]]), **({"budget": 9} | options))


@pytest.mark.parametrize("family", ["tree", "erdos-renyi", "maze"])
def test_own_policies_see_no_more_than_is_known(family):
    world = graphdrl.World.random(family, 25, 3, weighted=family == "tree", directed=family == "erdos-renyi")
    own = Nearest(world)
    plan = graphdrl.explore(world, "0.7x", policy=own)
    assert own.states >= len(plan.walk) - 1 > 5
    assert plan.seen[0] == plan.walk[0] and set(plan.walk) <= set(plan.seen)
    assert plan.seen_after_step[-1] == len(plan.seen) <= world.valid_count
    if family != "erdos-renyi":
        nearest = graphdrl.explore(world, "0.7x", policy="nearest")
        assert plan.visited == pytest.approx(nearest.visited, abs=3)


def test_an_old_map_is_that_of_the_command(tmp_path):
    old, new = tmp_path / "old.txt", tmp_path / "new.txt"
    old.write_text("......\n.#....\n...#..\n......\n")
    new.write_text("......\n.##...\n......\n......\n")
    expected = run_json("explore", new, "--believed", old, "--budget", "18", "--json")
    worlds = [graphdrl.World.from_file(path) for path in (new, old)]
    assert graphdrl.explore(worlds[0], 18, believed=worlds[1]).nodes.tolist() == expected["walk"]
    plan = graphdrl.explore(worlds[0], 18, believed=worlds[1], policy=graphdrl.Policy.load())
    assert plan.visited > 10
    with pytest.raises(graphdrl.Error, match="with a policy that plans"):
        graphdrl.explore(worlds[0], 18, believed=worlds[1], policy=lambda state: None)


def test_policies_explore_what_they_know_alone(tmp_path):
    """Of an explorer of known maps the walk is not that of one that knows the map, as an object or in a file."""
    world = graphdrl.World.random("geometric", 40, 1)
    explorer = graphdrl.Policy.load()
    explored = graphdrl.explore(world, "0.7x", policy=explorer)
    explorer.save(tmp_path / "known.safetensors")
    assert explored.walk == graphdrl.explore(world, "0.7x", policy=str(tmp_path / "known.safetensors")).walk
    default = graphdrl.explore(world, "0.7x")
    assert default.walk == graphdrl.explore(world, "0.7x", policy="explorer").walk != explored.walk
    assert explored.walk != graphdrl.plan(world, "0.7x", policy="explorer").walk
    with pytest.raises(graphdrl.Error, match="directions"):
        graphdrl.explore(graphdrl.World.from_file("paper:a"), 9, policy=graphdrl.PaperNetwork.random())
    known = graphdrl.explore(world, "0.7x", policy="search", reveal="all")
    assert known.walk == graphdrl.plan(world, "0.7x").walk
    assert known.seen is None and known.seen_after_step is None


def test_labels_of_any_kind_come_back(tmp_path):
    graph = nx.Graph()
    labels = ["hall", ("kitchen", 2), frozenset({"attic"}), 3.5, b"cellar", 7]
    for a, b in zip(labels, labels[1:]):
        graph.add_edge(a, b, weight=2)
    graph.nodes["hall"]["prize"] = 5
    graph.nodes[7]["blocked"] = True
    world = graphdrl.World.from_networkx(graph)
    plan = graphdrl.plan(world, 20, start=("kitchen", 2), end="start")
    assert plan.walk[0] == plan.walk[-1] == ("kitchen", 2)
    assert set(plan.walk) == set(labels[:-1])
    assert plan.prize == 9 and world.total_prize == 9 and plan.optimal
    assert world.nodes == labels
    back = world.to_networkx()
    assert set(back.nodes) == set(labels) and back.edges["hall", ("kitchen", 2)]["cost"] == 2
    graph.add_edge("hall", "shed")  # the world stays what it was
    assert world.node_count == 6 and graphdrl.plan(world, 20, start="hall").walk[0] == "hall"


def test_a_plan_is_a_walk_of_networkx():
    for i in range(20):
        graph = nx.connected_watts_strogatz_graph(30, 4, 0.3, seed=i)
        rng = np.random.default_rng(i)
        for _, _, data in graph.edges(data=True):
            data["length"] = float(rng.uniform(0.5, 2))
        plan = graphdrl.plan(graphdrl.World.from_networkx(graph), 20, policy="explorer")
        cost = sum(graph.edges[a, b]["length"] for a, b in zip(plan.walk, plan.walk[1:]))
        assert cost == pytest.approx(plan.cost) and cost <= 20 + 1e-6
        assert plan.visited == len(set(plan.walk)) <= plan.bound
        assert plan.costs[-1] == pytest.approx(cost)


def test_grids():
    world = graphdrl.World.from_grid("..#\n.#.\n...\n")
    assert world.shape == (3, 3) and world.valid_count == 7
    plan = graphdrl.plan(world, 7, start=(0, 1))
    assert plan.walk[0] == (0, 1) and plan.nodes[0] == 1
    assert graphdrl.plan(world, 7, start=1).walk == plan.walk
    array = np.array(world.blocked)
    assert graphdrl.plan(graphdrl.World.from_grid(array), 7, start=(0, 1)).walk == plan.walk
    eight = graphdrl.World.from_grid(array, diagonals=True, cut_corners=True, cell_size=0.5, origin=(1, 2))
    assert eight.edge_count > world.edge_count
    assert eight.places[0].tolist() == [1.25, 3.25]
    assert "<svg" in plan._repr_svg_() and "<svg" in world._repr_svg_()


def test_sparse_matrices_of_scipy_go_both_ways():
    matrix = scipy.sparse.random(20, 20, 0.3, random_state=1, format="csr") + scipy.sparse.eye(20, k=1)
    matrix.setdiag(0)
    matrix.eliminate_zeros()
    world = graphdrl.World.from_scipy(matrix)
    assert world.directed and (world.to_scipy() != matrix).nnz == 0
    both = graphdrl.World.from_scipy(scipy.sparse.triu(matrix), directed=False)
    assert (both.to_scipy() != both.to_scipy().T).nnz == 0


@pytest.mark.parametrize("end", ["", "start"])
def test_evaluations_are_those_of_the_program(end):
    worlds = [graphdrl.World.from_file(f"paper:{letter}") for letter in "abc"]
    rows = graphdrl.evaluate(worlds, ["nearest", "explorer", "random-walk"], 25, end=end, episodes=7, seed=3)
    maps = [option for letter in "abc" for option in ("--maps", f"paper:{letter}")]
    policies = [option for name in ("nearest", "explorer", "random-walk") for option in ("--policy", name)]
    ends = ["--end", end] if end else []
    expected = run_json("evaluate", *maps, *policies, "--budget", 25, "--episodes", 7, "--seed", 3, *ends, "--json")
    for row, other in zip(rows, expected["rows"], strict=True):
        for key in ("map", "policy", "valid_nodes", "budget", "episodes", "mean", "std", "best", "optimum"):
            assert row[key] == other[key], (key, row)
        assert other["ci95"] == (None if row["ci95_low"] is None else [row["ci95_low"], row["ci95_high"]])


def test_own_policies():
    world = graphdrl.World.from_file("paper:a")
    kept = []

    def first_new(state):
        kept.append(state)
        assert state.walk[-1] == state.position and state.spent == len(state.walk) - 1
        assert state.visited_count == np.count_nonzero(state.visits)
        return next((node for node in state.moves if state.visits[node] == 0), None)

    rows = graphdrl.evaluate(world, ["nearest", first_new], all_starts=True)
    assert [row["policy"] for row in rows] == ["nearest", "first_new"]
    assert 20 < rows[1]["mean"] < rows[0]["mean"]
    with pytest.raises(graphdrl.Error, match="over"):
        _ = kept[0].moves
    with pytest.raises(graphdrl.Error, match="no step leads to"):
        graphdrl.evaluate(world, lambda state: 10**9)
    expected = "gave no node: expected the number of a node, one of state.moves, or None, got 'left'"
    with pytest.raises(graphdrl.Error, match=expected):
        graphdrl.evaluate(world, lambda state: "left")
    with pytest.raises(ZeroDivisionError):
        graphdrl.evaluate(world, lambda state: 1 // 0)


def test_worlds_and_plans_pickle_and_copy():
    graph = nx.DiGraph([("a", "b"), ("b", "a"), ("b", ("c", 1)), (("c", 1), "a")])
    nx.set_node_attributes(graph, {"a": 1.5, "b": 0.1, ("c", 1): 2}, "score")
    nx.set_node_attributes(graph, {"a": (0, 0), "b": (1, 0.3), ("c", 1): (2, 2)}, "pos")
    grid = graphdrl.World.from_grid(np.zeros((3, 4)) > 0, diagonals=True, cell_size=0.1)
    for world in [graphdrl.World.from_networkx(graph), grid, graphdrl.World.random("geometric", 30, weighted=True)]:
        plan = graphdrl.plan(world, 5.5, end="start")
        for again in [pickle.loads(pickle.dumps(plan)), copy.copy(plan), copy.deepcopy(plan)]:
            assert again.to_json() == plan.to_json()
            assert again.walk == plan.walk and again.bound == plan.bound and again.elapsed_s == plan.elapsed_s
        other = pickle.loads(pickle.dumps(world))
        assert other.nodes == world.nodes and np.array_equal(other.prizes, world.prizes)
        assert np.array_equal(other.places, world.places)
        assert all(np.array_equal(x, y) for x, y in zip(other.edges(), world.edges()))


def test_plans_are_saved_in_every_format(tmp_path):
    graph = nx.path_graph(4)
    nx.set_node_attributes(graph, {node: (node, 0.5) for node in graph}, "pos")
    plan = graphdrl.plan(graphdrl.World.from_networkx(graph), 3)
    for ending in "json csv graphml dot geojson yaml svg anim.svg png html".split():
        plan.save(tmp_path / f"plan.{ending}")
        assert (tmp_path / f"plan.{ending}").stat().st_size > 0
    assert len(nx.read_graphml(tmp_path / "plan.graphml")) == 4
    with pytest.raises(graphdrl.Error):
        plan.save(tmp_path / "plan.docx")


def test_memory_stays_flat_and_plans_outlive_worlds():
    def resident():
        return int(pathlib.Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")

    def some(count):
        for i in range(count):
            world = graphdrl.World.from_edges([[0, 1], [1, 2], [2, 3]], [1.0, 2.0, 0.5])
            plan = graphdrl.plan(world, 3, policy="nearest")
            del world
            assert plan.walk == [0, 1, 2]
            if i % 100 == 0:
                pickle.loads(pickle.dumps(plan))

    def some_on_four_threads(count):
        with concurrent.futures.ThreadPoolExecutor(4) as pool:
            for done in [pool.submit(some, count // 4) for _ in range(4)]:
                done.result()

    some_on_four_threads(4000)
    before = resident()
    some_on_four_threads(25_000)
    assert resident() - before < 1 << 20


def test_eight_threads_plan_at_once():
    worlds = list(neutral_worlds(16))
    alone = [graphdrl.plan(world, "0.5x", policy="search:3000").walk for world in worlds]
    together = [None] * len(worlds)

    def work(first):
        for i in range(first, len(worlds), 8):
            together[i] = graphdrl.plan(worlds[i], "0.5x", policy="search:3000").walk

    threads = [threading.Thread(target=work, args=(first,)) for first in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert together == alone


def test_the_lock_is_released_and_progress_is_told():
    world = graphdrl.World.random("obstacles", 40, 1)
    news, turns = [], [0]
    over = threading.Event()

    def count():
        while not over.is_set():
            turns[0] += 1
            time.sleep(0.005)

    other = threading.Thread(target=count)
    other.start()
    graphdrl.plan(world, "0.7x", time_limit=1.0, on_progress=lambda visited, bound: news.append((visited, bound)))
    over.set()
    other.join()
    assert turns[0] > 10
    assert news and all(0 < visited <= bound for visited, bound in news)
    with pytest.raises(ZeroDivisionError):
        graphdrl.plan(world, "0.7x", time_limit=60.0, on_progress=lambda visited, bound: 1 // 0)
    assert graphdrl.plan(world, "0.7x", policy="search:1000").visited > 100  # planning goes on


def test_ctrl_c_ends_a_plan():
    code = """
import graphdrl, sys
world = graphdrl.World.random("obstacles", 60, 1)
print("ready", flush=True)
try:
    graphdrl.plan(world, "0.7x", time_limit=500)
except KeyboardInterrupt:
    print("interrupted", graphdrl.plan(world, 9, policy="nearest").visited > 5)
"""
    with subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout.readline() == "ready\n"
        time.sleep(0.5)
        process.send_signal(signal.SIGINT)
        assert process.communicate(timeout=60)[0] == "interrupted True\n"


def test_notes_are_warnings(tmp_path):
    graph = nx.path_graph(3)
    graph.nodes[0]["x"] = graph.nodes[0]["y"] = 1.0
    nx.write_gml(graph, tmp_path / "some.gml")
    with pytest.warns(UserWarning, match="coordinates"):
        graphdrl.World.from_file(tmp_path / "some.gml")


GOOD = graphdrl.World.from_edges([[0, 1], [1, 2]])
LABELLED = graphdrl.World.from_edges([[0, 1], [1, 2]], labels=["a", "start", ("c", 1)])
TURNED = graphdrl.World.from_edges([[0, 1], [1, 2]], labels=[("c", 1), "start", "a"])


def from_weighted(**options):
    """A path of three nodes: one has a prize, one edge a weight."""
    graph = nx.path_graph(3)
    graph.edges[0, 1]["weight"] = 4
    graph.nodes[1].update(prize=7, shut="false")
    return graphdrl.World.from_networkx(graph, **options)


def test_attributes_that_only_some_have():
    assert from_weighted().edges()[1].tolist() == from_weighted(cost="weight").edges()[1].tolist() == [4, 1]
    assert from_weighted().prizes.tolist() == from_weighted(prize="prize").prizes.tolist() == [1, 7, 1]
    plain = from_weighted(cost="none", prize="none")
    assert not plain.weighted and plain.total_prize == 3
    assert graphdrl.World.from_networkx(nx.empty_graph(2), cost="weight").edge_count == 0


def test_attributes_mean_the_same_in_files_and_in_networkx(tmp_path):
    graph = nx.path_graph(4)
    graph.edges[0, 1]["weight"] = 5.0
    graph.edges[1, 2].update(length=7.0, weight=2.0)
    graph.edges[2, 3]["Distance"] = 3.0
    for node, data in graph.nodes(data=True):
        data.update(lon=-122.0, lat=42.0 + node, x=float(node), y=1.0, score=float(node))
    graph.nodes[0]["Prize"] = 9.0
    nx.write_graphml(graph, tmp_path / "some.graphml")
    with pytest.warns(UserWarning, match="costs come from weight and distance"):
        by_file = graphdrl.World.from_file(tmp_path / "some.graphml")
    with pytest.warns(UserWarning, match="prizes come from Prize and score"):
        world = graphdrl.World.from_networkx(graph)
    for one in (by_file, world):
        assert one.edges()[1].tolist() == [5, 2, 3]
        assert one.prizes.tolist() == [9, 1, 2, 3]
        assert one.places.tolist() == [[0, 1], [1, 1], [2, 1], [3, 1]]
    plain = graphdrl.World.from_file(tmp_path / "some.graphml", cost_attribute="none", prize_attribute="none")
    assert not plain.weighted and plain.total_prize == 4


@pytest.mark.parametrize(
    ("places", "why"),
    [
        ([{"pos": (0, 0)}, {}], "pos is on 1 of 2 nodes"),
        ([{"pos": (0, 0)}, {"pos": (1, 2, 3)}], r"a node's pos is not x and y: \(1, 2, 3\)"),
        ([{"pos": (0, 0)}, {"pos": None}], "a node's pos is not x and y: None"),
        ([{"pos": (0, 0)}, {"pos": "ab"}], "a node's pos is not x and y: 'ab'"),
        ([{"x": 0, "y": 0}, {"x": 0}], "x and y are on 1 of 2 nodes"),
    ],
)
def test_coordinates_left_out_are_warned_of(places, why):
    graph = nx.path_graph(2)
    for node, data in enumerate(places):
        graph.nodes[node].update(data)
    with pytest.warns(UserWarning, match=f"the coordinates are left out: {why}") as told:
        assert graphdrl.World.from_networkx(graph).places is None
    assert told[0].filename == __file__
    for node in graph:
        graph.nodes[node].update(lon=node, lat=1)
    assert graphdrl.World.from_networkx(graph).places.tolist() == [[0, 1], [1, 1]]


def test_grids_of_numbers():
    numbers = np.array([[0, 1, 0], [0, 0, 0]])
    for dtype in (bool, np.uint8, int, np.float32, float):
        assert graphdrl.World.from_grid(numbers.astype(dtype)).blocked.tolist() == (numbers == 1).tolist()
    assert graphdrl.World.from_grid(np.zeros((60, 80))).valid_count == 4800


def test_ends_of_evaluations_are_those_of_plans():
    for end in (None, "start", "anywhere", "a", ("c", 1)):
        (row,) = graphdrl.evaluate(LABELLED, "exact", 3, end=end, all_starts=True)
        walks = [graphdrl.plan(LABELLED, 3, start, end, policy="exact").coverage for start in LABELLED.nodes]
        assert row["mean"] == pytest.approx(100 * np.mean(walks))
    both = graphdrl.evaluate([LABELLED, LABELLED], "exact", 3, end=("c", 1), all_starts=True)
    assert both[0]["mean"] == both[1]["mean"]
    grids = [graphdrl.World.from_grid("...\n..."), graphdrl.World.from_grid("....\n....")]
    assert graphdrl.evaluate(grids, "exact", 9, end=(1, 1)) == graphdrl.evaluate(grids, "exact", 9, end="1,1")
    by_label = graphdrl.evaluate([LABELLED, TURNED], "exact", 3, end="a", all_starts=True)
    assert by_label[0]["mean"] == by_label[1]["mean"]
ODD = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(),
    st.floats(),
    st.text(max_size=5),
    st.lists(st.one_of(st.integers(), st.floats(), st.text(max_size=2)), max_size=4),
    st.lists(st.lists(st.one_of(st.integers(-3, 5), st.floats()), max_size=3), max_size=4),
    st.builds(lambda shape, dtype: np.ones(shape, dtype), st.sampled_from([(), (0,), (2,), (2, 2), (0, 2), (2, 2, 2)]),
              st.sampled_from([bool, np.int8, np.int64, np.uint64, np.float32, np.float64, complex, "U2", object])),
)  # fmt: skip


@settings(max_examples=200, deadline=None, derandomize=True)
@given(which=st.integers(0, 9), odd=ODD)
def test_bad_input_is_an_exception_and_never_a_crash(which, odd):
    world = graphdrl.World
    calls = [
        lambda: world.from_edges(odd),
        lambda: world.from_edges([[0, 1], [1, 2]], odd),
        lambda: world.from_edges([[0, 1]], node_count=odd),
        lambda: world.from_edges([[0, 1], [1, 2]], blocked=odd, prizes=odd),
        lambda: world.from_edges([[0, 1]], labels=odd),
        lambda: world.from_grid(odd),
        lambda: graphdrl.plan(GOOD, odd),
        lambda: graphdrl.plan(GOOD, 2, start=odd, policy="nearest"),
        lambda: graphdrl.plan(GOOD, 2, end=odd, policy="nearest"),
        lambda: graphdrl.evaluate(GOOD, "nearest", 2, episodes=odd),
    ]
    try:
        calls[which]()
    except graphdrl.Error as error:
        assert "\n" not in str(error)
    assert graphdrl.plan(GOOD, 2, start=0, policy="nearest").walk == [0, 1, 2]


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: graphdrl.plan(GOOD), "no budget"),
        (lambda: graphdrl.plan(GOOD, -1), "bad budget"),
        (lambda: graphdrl.plan(GOOD, 2, start=7), "no such node: 7"),
        (lambda: graphdrl.plan(GOOD, 2, policy="nowhere"), "no such policy"),
        (lambda: graphdrl.plan(GOOD, 2, time_limit=float("nan")), "bad time limit"),
        (lambda: graphdrl.upper_bound(GOOD, 2, time_limit=float("nan")), "bad time limit"),
        (lambda: graphdrl.World.from_file("no/such/file"), "no such map"),
        (lambda: graphdrl.World.from_edges([[0, 1]], [float("nan")]), "bad cost"),
        (lambda: graphdrl.World.from_edges([[0, 1]], [1.0, 2.0]), "shape of costs"),
        (lambda: graphdrl.World.from_edges([[0, 1]], prizes=[1, float("inf")]), "bad prize"),
        (lambda: graphdrl.World.from_edges([[0, -1]]), "outside the graph"),
        (lambda: graphdrl.World.from_edges([[0, 1]], labels=["a", "a"]), "different"),
        (lambda: graphdrl.World.from_grid(["..", "."]), "one length"),
        (lambda: graphdrl.World.from_grid(["##"]), "no valid node"),
        (lambda: graphdrl.World.from_networkx(nx.Graph()), "number of nodes"),
        (lambda: graphdrl.World.random("lake", 5), "lake"),
        (lambda: graphdrl.set_threads(0), "threads"),
        (lambda: graphdrl.plan(GOOD, 2, seed=-1), "bad seed: expected a whole number from 0 up, got -1"),
        (lambda: graphdrl.plan(GOOD, 2, seed="x"), "bad seed: expected a whole number from 0 up, got 'x'"),
        (lambda: graphdrl.plan(GOOD, 2, seed=None), "bad seed"),
        (lambda: graphdrl.plan(GOOD, 2, seed=1.5), "bad seed"),
        (lambda: graphdrl.plan(GOOD, 2, seed=True), "bad seed"),
        (lambda: graphdrl.plan(GOOD, 2, seed=2**70), "bad seed: expected a whole number from 0 to 184467"),
        (lambda: graphdrl.plan(GOOD, 2, time_limit="x"), "bad time limit: expected a number, got 'x'"),
        (lambda: graphdrl.upper_bound(GOOD, 2, time_limit="x"), "bad time limit: expected a number, got 'x'"),
        (lambda: graphdrl.plan(GOOD, 10**400), "bad budget"),
        (lambda: graphdrl.plan(GOOD, "\ud800"), "bad budget"),
        (lambda: graphdrl.plan(GOOD, 2, policy="\ud800"), "bad policy"),
        (lambda: graphdrl.plan(GOOD, 2, on_progress=5), "bad on_progress: expected a function, got 5"),
        (lambda: graphdrl.plan(nx.path_graph(3), 4), "expected a World, got <networkx"),
        (lambda: graphdrl.evaluate("paper:a", "nearest", 4), "expected a World, got 'paper:a'"),
        (lambda: graphdrl.evaluate(None, "nearest", 4), "expected a World, got None"),
        (lambda: graphdrl.evaluate([GOOD, 5], "nearest", 4), "expected a World, got 5"),
        (lambda: graphdrl.evaluate(GOOD, 5, 4), "bad policies"),
        (lambda: graphdrl.evaluate(GOOD, "nearest", 4, episodes="x"), "bad number of episodes"),
        (lambda: graphdrl.evaluate(GOOD, "nearest", 4, seed=-1), "bad seed"),
        (lambda: graphdrl.evaluate(GOOD, "nearest", 4, seed=None), "bad seed"),
        (lambda: graphdrl.evaluate(GOOD, "nearest", 4, all_starts="yes"), "bad all_starts: expected True or False"),
        (lambda: graphdrl.set_threads("x"), "bad number of threads: expected a whole number from 1 to 1024, got 'x'"),
        (lambda: graphdrl.set_threads(None), "bad number of threads"),
        (lambda: graphdrl.World.random("tree", "x"), "bad size: expected a whole number from 1 up, got 'x'"),
        (lambda: graphdrl.World.random("tree", 5.0), "bad size"),
        (lambda: graphdrl.World.random("tree", 5, seed=-1), "bad seed"),
        (lambda: graphdrl.World.random("tree", 5, weighted="no"), "bad weighted: expected True or False, got 'no'"),
        (lambda: graphdrl.World.random("obstacles", 5, blocked="x"), "bad blocked: expected a number, got 'x'"),
        (lambda: graphdrl.World.random(None, 5), "bad family: expected text, got None"),
        (lambda: graphdrl.World.from_edges([[0, 1]], node_count="x"), "bad node_count"),
        (lambda: graphdrl.World.from_edges([[0, 1]], name=5), "bad name: expected text, got 5"),
        (lambda: graphdrl.World.from_edges([[0, 1]], name=None), "bad name"),
        (lambda: graphdrl.World.from_edges([[0, 1]], name="\ud800"), "bad name: .* got '.ud800'"),
        (lambda: graphdrl.World.from_edges([[0, 1]], directed="yes"), "bad directed"),
        (lambda: graphdrl.World.from_edges([[0, 1]], unit=3), "bad unit"),
        (lambda: graphdrl.World.from_edges([[0, 1]], labels=5), "bad labels"),
        (lambda: graphdrl.World.from_edges([[0, 1]], labels=["a", "\ud800"]), "bad label: .* got '.ud800'"),
        (lambda: graphdrl.World.from_grid("..", name=5), "bad name"),
        (lambda: graphdrl.World.from_grid("..", diagonals="no"), "bad diagonals"),
        (lambda: graphdrl.World.from_grid("..", cell_size="x"), "bad cell_size"),
        (lambda: graphdrl.World.from_grid("..", cell_size=1, origin=5), "bad origin: expected x and y, got 5"),
        (lambda: graphdrl.World.from_networkx([1, 2]), r"bad graph: expected a graph of networkx, got \[1, 2\]"),
        (lambda: graphdrl.World.from_networkx(nx.path_graph(3), name=5), "bad name"),
        (lambda: graphdrl.World.from_scipy(np.ones((3, 3))), "bad matrix: expected a sparse matrix of SciPy"),
        (lambda: graphdrl.World.from_file(b"paper:a"), "bad path: expected text, got b'paper:a'"),
        (lambda: graphdrl.World.from_file(5), "bad path"),
        (lambda: graphdrl.World.from_file("paper:a", cell_pixels="x"), "bad cell_pixels"),
        (lambda: graphdrl.World.from_file("paper:a", robot_radius="x"), "bad robot_radius"),
        (lambda: graphdrl.World.from_file("paper:a", connectivity="x"), "bad connectivity"),
        (lambda: GOOD.names([99]), "bad number of a node: expected a whole number from 0 to 2, got 99"),
        (lambda: GOOD.names([-1]), "bad number of a node"),
        (lambda: GOOD.names(5), "bad numbers"),
        (lambda: GOOD.state(5, 3), "bad walk"),
        (lambda: graphdrl.plan(GOOD, 2).save(5), "bad path"),
        (lambda: graphdrl.evaluate(GOOD, "nearest", 4, end=5), "no such node: 5"),
        (lambda: graphdrl.evaluate(GOOD, "nearest", 4, end=[1]), "no such node"),
        (lambda: graphdrl.evaluate(GOOD, "nearest", 4, end="door"), "end outside the map"),
        (lambda: graphdrl.evaluate([GOOD, LABELLED], "nearest", 9, end=("c", 1)), "no such node: .'c', 1."),
        (lambda: graphdrl.evaluate([LABELLED, TURNED], "nearest", 9, end=("c", 1)), "same number in all worlds"),
        (lambda: from_weighted(cost="wieght"), "bad cost: no edge has this attribute: 'wieght'"),
        (lambda: from_weighted(prize="prise"), "bad prize: no node has this attribute: 'prise'"),
        (lambda: from_weighted(cost=5), "bad cost: expected text, got 5"),
        (lambda: from_weighted(prize={0: 1}), "bad prize: expected text, got {0: 1}"),
        (lambda: from_weighted(blocked=5), "bad blocked: expected text, got 5"),
        (lambda: from_weighted(blocked="shut"), "bad shut: expected True or False, got 'false'"),
        (
            lambda: graphdrl.World.from_grid([[0, 100]]),
            r"expected 0 \(free\) or 1 \(blocked\), got 100; for ROS maps see World.from_file",
        ),
        (lambda: graphdrl.World.from_grid(np.full((2, 2), 0.5)), "got 0.5"),
        (lambda: graphdrl.World.from_grid([[0, float("nan")]]), "got nan"),
    ],
)
def test_errors_say_what_to_change(call, message):
    with pytest.raises(graphdrl.Error, match=message) as caught:
        call()
    assert isinstance(caught.value, ValueError) and "\n" not in str(caught.value)


def test_the_notebook_runs(tmp_path, monkeypatch):
    """Cell by cell; a cell that ends in a plan shows its picture."""
    monkeypatch.chdir(tmp_path)
    notebook = json.loads((ROOT / "examples" / "python" / "plan_a_networkx_graph.ipynb").read_text(encoding="utf-8"))
    cells = [cell for cell in notebook["cells"] if cell["cell_type"] == "code"]
    names = {}
    for cell in cells:
        source = "".join(cell["source"])
        if source == "plan":
            assert names["plan"]._repr_svg_().startswith("<svg")
            assert any("image/svg+xml" in output.get("data", {}) for output in cell["outputs"])
        exec(compile(source, "notebook", "exec"), names)
    assert (tmp_path / "crossings.csv").exists()


def test_python_may_end_while_a_thread_plans():
    code = """
import graphdrl, threading, time
world = graphdrl.World.random("obstacles", 60, 1)
threading.Thread(target=lambda: graphdrl.plan(world, "0.7x", time_limit=30.0), daemon=True).start()
time.sleep(0.5)
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=20, check=False)
    assert (done.returncode, done.stderr) == (0, "")


def test_ctrl_c_ends_an_evaluation_of_an_own_policy():
    code = """
import graphdrl, os, signal
world = graphdrl.World.random("obstacles", 10, 1)
calls = 0
def policy(state):
    global calls
    calls += 1
    if calls == 100:
        os.kill(os.getpid(), signal.SIGINT)
    return state.moves[0]
try:
    graphdrl.evaluate(world, policy, 20, episodes=1_000_000)
except KeyboardInterrupt:
    print("interrupted", calls)
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60, check=False)
    interrupted, calls = done.stdout.split()
    assert interrupted == "interrupted" and int(calls) < 2_000_000  # of the 20 million of all episodes


def test_a_time_limit_holds_between_the_steps_of_an_own_policy():
    calls = []

    def slow(state):
        calls.append(state.position)
        time.sleep(0.05)
        return state.moves[0]

    graphdrl.plan(graphdrl.World.random("obstacles", 20, 1), 200, policy=slow, time_limit=0.5)
    assert len(calls) < 100
