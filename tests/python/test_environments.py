"""The environments for Gymnasium, beside Gymnasium's own tools and a plain environment in NumPy."""

import inspect
import os
import subprocess
import sys
import warnings

import graphdrl
import graphdrl.environments
import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

os.environ.setdefault("SDL_VIDEODRIVER", "dummy")  # render_mode="human" without a screen
GRID = "GraphDRL/Grid-v0"
GRAPH = "GraphDRL/Graph-v0"
FIRST_VISIT = "GraphDRL/FirstVisit-v0"
UNKNOWN = "GraphDRL/Unknown-v0"
SETTINGS = [
    (GRID, {}),
    (GRID, {"reward": "coverage_gain", "map": "paper:j"}),
    (GRID, {"map": "paper:j", "budget": 7}),
    (GRID, {"family": "open", "size": 5, "budget": "0.6x"}),
    (GRID, {"family": "obstacles", "size": 6, "budget": "0.5x"}),
    (GRAPH, {}),
    (GRAPH, {"map": graphdrl.World.random("geometric", 15, 1, weighted=True), "return_to_start": True}),
    (GRAPH, {"family": "erdos-renyi", "size": 12, "directed": True, "reward": "coverage_gain", "budget": "0.6x"}),
    (FIRST_VISIT, {}),
    (FIRST_VISIT, {"map": graphdrl.World.random("tree", 14, 1, weighted=True), "return_to_start": True}),
    (FIRST_VISIT, {"family": "barabasi-albert", "size": 18, "weighted": True, "reward": "visit_penalty"}),
    (UNKNOWN, {}),
    (UNKNOWN, {"map": "paper:j", "reveal": "sight:2", "score": "seen", "max_visits": 3}),
    (UNKNOWN, {"family": "geometric", "size": 18, "weighted": True, "return_to_start": True, "reveal": "radius:2"}),
    (UNKNOWN, {"family": "erdos-renyi", "size": 15, "directed": True, "reward": "visit_penalty"}),
    (UNKNOWN, {"family": "maze", "size": 9, "reveal": "radius:3", "score": "seen", "return_to_start": True}),
]
MAPS = ["paper:a", "paper:f", "paper:j"]


class PlainGrid:
    """The paper's process as its text says it: features from scratch, one environment."""

    MOVES = ((0, -1), (-1, 0), (0, 1), (1, 0))

    def __init__(self, blocked, budget):
        self.blocked, self.budget = blocked, budget

    def reset(self, start):
        self.row, self.column = start
        self.visits = np.zeros(self.blocked.shape)
        self.visits[start] = 1
        self.left = self.budget
        return self.features()

    def step(self, action):
        rows, columns = self.blocked.shape
        row, column = self.row + self.MOVES[action][0], self.column + self.MOVES[action][1]
        bumps = not (0 <= row < rows and 0 <= column < columns) or self.blocked[row, column]
        if not bumps:
            self.row, self.column = row, column
        before = self.visits[self.row, self.column]
        reward = -0.5 if bumps else 0.1 if before == 0 else -0.1 * before
        self.visits[self.row, self.column] += 1
        self.left -= 1
        return self.features(), reward, False, self.left < 1

    def features(self):
        rows, columns = self.blocked.shape
        out = np.zeros((rows, columns, 7), np.float32)
        out[..., 0] = np.arange(rows)[:, None]
        out[..., 1] = np.arange(columns)
        out[..., 2] = self.blocked
        out[..., 3] = self.visits
        out[[0, -1], :, 4] = out[:, [0, -1], 4] = 1
        unvisited = np.pad((self.visits == 0).astype(np.float32), 1)
        out[..., 5] = unvisited[:-2, 1:-1] + unvisited[2:, 1:-1] + unvisited[1:-1, :-2] + unvisited[1:-1, 2:]
        out[self.row, self.column, 6] = 1
        return out.ravel()


@pytest.mark.parametrize(("name", "options"), SETTINGS)
def test_gymnasiums_checker_has_nothing_to_say(name, options):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warnings.filterwarnings("ignore", module="pygame|pkg_resources")  # its own
        check_env(gymnasium.make(name, **options).unwrapped)
        check_env(gymnasium.make(name, render_mode="rgb_array", **options).unwrapped, skip_render_check=True)
        if name != GRID:
            check_env(gymnasium.make(name, observation="graph", **options).unwrapped, skip_render_check=True)


@pytest.mark.parametrize("name", MAPS)
def test_steps_are_the_papers(name):
    env = gymnasium.make(GRID, map=name, budget=40)
    plain = PlainGrid(np.array(env.unwrapped.world.blocked), 40)
    random = np.random.default_rng(4)
    observation, info = env.reset(seed=3)
    expected = plain.reset(divmod(info["position"], 5))
    for _ in range(2000):
        assert np.array_equal(observation, expected)
        assert info["visited"] == np.count_nonzero(plain.visits)
        action = int(random.integers(4))
        observation, reward, terminated, truncated, info = env.step(action)
        expected, *others = plain.step(action)
        assert [pytest.approx(reward), terminated, truncated] == others
        if terminated or truncated:
            assert np.array_equal(observation, expected)
            observation, info = env.reset()
            expected = plain.reset(divmod(info["position"], 5))


def test_no_direction_is_masked():
    assert gymnasium.make(GRID).unwrapped.action_masks().tolist() == [True] * 4
    envs = gymnasium.make_vec(GRID, num_envs=2)
    envs.reset(seed=1)
    envs.step(np.zeros(2, np.int64))
    assert envs.unwrapped.action_masks().tolist() == [[True] * 4] * 2


def test_moves_that_are_free_and_lead_nowhere_new_are_truncated():
    world = graphdrl.World.from_edges([[0, 1], [1, 2]], [0.0, 7.0])
    env = gymnasium.make(GRAPH, map=world, budget=3, start=0)
    env.reset()
    steps, over = 0, False
    while not over:
        *_, terminated, truncated, _ = env.step(0)
        steps, over = steps + 1, terminated or truncated
    assert truncated and not terminated and steps == 1 + 10 * 3


@pytest.mark.parametrize(
    "line",
    [
        "import graphdrl, gymnasium; gymnasium.make('GraphDRL/Grid-v0')",
        "import gymnasium, graphdrl; gymnasium.make_vec('GraphDRL/Graph-v0', num_envs=2)",
        "import gymnasium; gymnasium.make('graphdrl:GraphDRL/FirstVisit-v0')",
        "import sys; sys.modules['gymnasium'] = None; import graphdrl",  # without Gymnasium
    ],
)
def test_gymnasium_knows_the_names(line):
    subprocess.run([sys.executable, "-c", line], check=True)


def test_options_are_shown_one_by_one():
    assert str(inspect.signature(graphdrl.environments.GridVectorEnv)).startswith("(num_envs: int = 1, map: str | ")
    assert "max_visits: int = 16" in str(inspect.signature(graphdrl.environments.FirstVisitEnv))
    with pytest.raises(TypeError, match="unexpected keyword argument 'weighted'"):
        gymnasium.make(GRID, weighted=True)


@pytest.mark.parametrize(("name", "options"), SETTINGS)
def test_many_environments_equal_gymnasiums_one_by_one(name, options):
    ours = gymnasium.make_vec(name, num_envs=9, vectorization_mode="vector_entry_point", **options)
    theirs = gymnasium.make_vec(name, num_envs=9, vectorization_mode="sync", **options)
    assert type(ours.unwrapped).__module__ == "graphdrl.environments"
    assert ours.observation_space == theirs.observation_space and ours.action_space == theirs.action_space
    random = np.random.default_rng(0)

    def assert_equal(one, other):
        assert len(one) == len(other)
        for a, b in zip(one[:-1], other[:-1]):
            assert np.array_equal(a, b) and a.dtype == b.dtype and a.shape == b.shape
        assert one[-1].keys() == other[-1].keys()
        for key, values in one[-1].items():
            assert np.array_equal(values, other[-1][key]), key

    assert_equal(ours.reset(seed=7), theirs.reset(seed=7))
    for step in range(300):
        actions = random.integers(ours.single_action_space.n, size=9)
        assert_equal(ours.step(actions), theirs.step(actions))
        if step == 150:
            assert_equal(ours.reset(), theirs.reset())
        if step == 200 and "family" not in options:
            start = {"options": {"start": ours.unwrapped._kind.options.world.nodes[0]}}
            assert_equal(ours.reset(**start), theirs.reset(**start))


def test_what_a_step_gave_stays_as_it_was_unless_asked_for():
    for copy in (True, False):
        envs = gymnasium.make_vec(GRID, num_envs=3, copy=copy)
        first, _ = envs.reset(seed=1)
        before = first.copy()
        second, rewards, *_ = envs.step(np.zeros(3, np.int64))
        kept = rewards.copy()
        envs.step(np.ones(3, np.int64))
        assert np.array_equal(rewards, kept)
        assert np.array_equal(first, before) == copy
        assert (second is first) == (not copy)


def test_pictures():
    env = gymnasium.make(GRID, map=graphdrl.World.from_grid("..\n.#"), start=(0, 0), render_mode="ansi")
    env.reset()
    env.step(2)
    assert env.render() == "o@\n.#\n"
    env = gymnasium.make(GRID, map="paper:a", render_mode="rgb_array")
    env.reset()
    picture = env.render()
    assert picture.shape == (120, 120, 3) and picture.dtype == np.uint8 and len(np.unique(picture)) > 3


@pytest.mark.parametrize(("family", "weighted"), [("maze", False), ("geometric", True), ("watts-strogatz", False)])
def test_walks_of_plans_go_through_a_graph(family, weighted):
    """Every step of a plan can be taken, costs what it should, and visits what the plan says."""
    world = graphdrl.World.random(family, 21, 2, weighted=weighted)
    plan = graphdrl.plan(world, "0.6x", end="start")
    env = gymnasium.make(
        GRAPH, map=world, budget="0.6x", start=plan.walk[0], return_to_start=True, reward="coverage_gain"
    )
    _, info = env.reset()
    rewards = 0.0
    for node in plan.nodes[1:]:
        action = int(np.flatnonzero(info["targets"] == node)[0])
        assert info["action_mask"][action] and env.unwrapped.action_masks()[action]
        observation, reward, terminated, truncated, info = env.step(action)
        rewards += reward
        assert info["position"] == node and not truncated
    assert info["visited"] == plan.visited
    assert (rewards * world.valid_count + 1) == pytest.approx(plan.visited)
    assert observation[-2] == pytest.approx(1 - plan.cost / plan.budget, abs=1e-6)
    assert observation[-1] == pytest.approx(plan.coverage)


@pytest.mark.parametrize("options", [{"family": "tree", "size": 20, "weighted": True}, {"family": "rooms", "size": 11}])
@pytest.mark.parametrize("returns", [False, True])
def test_the_explorer_walks_first_visits(options, returns):
    """Its choices, taken in the environment, are its plan; what the environment shows is what it sees."""
    explorer = graphdrl.Policy.load()
    env = gymnasium.make(
        FIRST_VISIT, budget="0.9x", reward="visit_penalty", return_to_start=returns, max_visits=96, **options
    )
    for seed in range(5):
        observation, info = env.reset(seed=seed)
        world = env.unwrapped.world
        start = world.names([info["position"]])[0]
        terminated, walk = False, [info["position"]]
        while not terminated:
            walk = env.unwrapped._kind.episodes.walk(0)
            visits = explorer.first_visits(world.state(world.names(walk), "0.9x", start if returns else None))
            count = len(visits.nodes)
            assert info["targets"][:count].tolist() == visits.nodes.tolist()
            assert info["action_mask"].sum() == count
            seen = explorer.inputs(world.state(world.names(walk), "0.9x", start if returns else None))["visit_x"]
            np.testing.assert_array_equal(observation.reshape(-1, 12)[:count, 1:], seen)
            observation, reward, terminated, truncated, info = env.step(visits.choice)
            assert not truncated
        plan = graphdrl.plan(world, "0.9x", start, end="start" if returns else None, policy="explorer")
        walk = env.unwrapped._kind.episodes.walk(0)
        assert walk.tolist() == plan.nodes[: len(walk)].tolist()
        assert info["visited"] == plan.visited


@pytest.mark.parametrize("returns", [False, True])
def test_an_unknown_map_is_explored_as_plans_explore_it(returns):
    """The first action of all is the nearest rule; rewards are the share of the nodes it gains."""
    for seed in range(5):
        world = graphdrl.World.random("obstacles", 12, seed)
        start = world.nodes[world.valid_count // 2] if not world.is_grid else tuple(np.argwhere(~world.blocked)[9])
        options = {"map": world, "budget": "0.8x", "start": start, "return_to_start": returns}
        env = gymnasium.make(UNKNOWN, **options)
        observation, info = env.reset(seed=1)
        terminated, gained, seen = False, 0.0, info["seen"]
        assert info["position"] == 0
        while not terminated:
            assert info["action_mask"][0] and info["targets"][0] < info["seen"]
            rows = observation[:-2].reshape(-1, 7)
            assert np.array_equal(rows[:, 0] == 1, info["action_mask"])
            assert np.all(np.diff(rows[info["action_mask"], 5]) >= 0)
            observation, reward, terminated, truncated, info = env.step(0)
            assert not truncated and info["seen"] >= seen
            gained, seen = gained + reward, info["seen"]
        plan = graphdrl.explore(world, "0.8x", start, end="start" if returns else None, policy="nearest")
        walk = env.unwrapped.walk
        assert walk == plan.walk[: len(walk)]
        assert gained * world.valid_count + 1 == pytest.approx(plan.visited)
        assert info["visited"] == plan.visited and info["seen"] == len(plan.seen)


def test_the_graph_of_an_unknown_map_grows():
    world = graphdrl.World.random("geometric", 25, 2, weighted=True)
    env = gymnasium.make(UNKNOWN, map=world, observation="graph", score="seen", max_visits=2, budget=1e6)
    observation, info = env.reset(seed=4)
    gained, terminated, first = 0.0, False, info["seen"]
    while not terminated:
        assert len(observation.nodes) == info["seen"] and observation.edge_links.max() < info["seen"]
        targets = info["targets"][info["action_mask"]]
        assert sorted(targets) == np.flatnonzero(observation.nodes[:, 0]).tolist()
        assert np.flatnonzero(observation.nodes[:, 8]).tolist() == [info["position"]]
        assert observation.nodes[:, 7].sum() == info["visited"]
        observation, reward, terminated, _, info = env.step(0)
        gained += reward
    assert gained * world.valid_count == pytest.approx(info["seen"] - first)
    assert info["seen"] == world.valid_count


def test_masked_actions_cost_an_edge_and_end_what_cannot_pay():
    world = graphdrl.World.from_edges([[0, 1], [1, 2]], [2.0, 4.0], labels=["a", "b", "c"])  # a mean edge costs 3
    for name in (GRAPH, FIRST_VISIT):
        env = gymnasium.make(name, map=world, budget=7, start="a", reward="visit_penalty")
        _, info = env.reset()
        assert info["action_mask"].sum() == 1
        _, reward, terminated, *_, info = env.step(1)
        assert (reward, terminated, info["position"]) == (-0.5, False, 0)
        _, reward, terminated, *_ = env.step(1)
        assert (reward, terminated) == (-0.5, True)  # 1 is left, and an edge costs 2
        env = gymnasium.make(name, map=world, budget=2, start="a", reward="visit_penalty")
        env.reset()
        assert env.step(1)[1:3] == (0.0, True)  # nothing can be paid for


def test_prizes_are_what_coverage_gains():
    world = graphdrl.World.from_edges([[0, 1], [1, 2]], prizes=[1, 5, 2])
    for name in (GRAPH, FIRST_VISIT):
        env = gymnasium.make(name, map=world, budget=9, start=0, reward="coverage_gain")
        env.reset()
        assert env.step(0)[1] == 5 / 8


@pytest.mark.parametrize(("name", "family"), [(GRID, "maze"), (GRAPH, "tree"), (FIRST_VISIT, "rooms")])
def test_random_worlds_are_new_with_every_reset_and_the_same_with_a_seed(name, family):
    env = gymnasium.make(name, family=family, size=9, budget="1.1x").unwrapped

    def edges():
        return env.world.edges()[0].tolist(), env.world.blocked.tolist()

    env.reset(seed=5)
    first = edges()
    env.reset()
    second = edges()
    assert first != second
    env.reset(seed=5)
    assert edges() == first
    env.reset()
    assert edges() == second


def test_graph_observations_hang_together():
    world = graphdrl.World.random("geometric", 12, 3, weighted=True)
    env = gymnasium.make(GRAPH, map=world, observation="graph", start=0)
    observation, info = env.reset()
    assert observation.nodes.shape == (world.node_count, 6) and observation.edges.shape == (2 * world.edge_count, 1)
    legal = np.flatnonzero(observation.nodes[:, 4])
    assert legal.tolist() == info["targets"][info["action_mask"]].tolist()
    assert np.flatnonzero(observation.nodes[:, 2]).tolist() == [0]
    ends, costs = world.edges()
    linked = dict(zip(map(tuple, observation.edge_links.tolist()), observation.edges[:, 0].tolist()))
    for (a, b), cost in zip(ends.tolist(), costs.tolist()):
        assert linked[a, b] == linked[b, a] == pytest.approx(cost / costs.mean(), rel=1e-5)
    env = gymnasium.make(FIRST_VISIT, map=world, observation="graph", start=0)
    observation, info = env.reset()
    rows = info["target_rows"][info["action_mask"]]
    assert observation.nodes[rows, 2].all() and observation.nodes[:, 2].sum() == len(rows)  # "candidate"


def test_a_first_visit_that_is_too_far_to_be_seen_can_be_made():
    length = 2400  # the explorer looks at 1024 nodes around
    world = graphdrl.World.from_edges([(i, i + 1) for i in range(length - 1)])
    env = gymnasium.make(FIRST_VISIT, map=world, budget=10 * length, start=length // 2)
    env.reset()
    terminated, steps = False, 0
    while not terminated:
        *_, terminated, _, info = env.step(0)
        steps += 1
    assert info["visited"] == length and steps == length - 1


@pytest.mark.parametrize("name", [GRID, GRAPH, FIRST_VISIT])
def test_all_ways_to_render(name):
    for world in ("paper:a", graphdrl.World.random("tree", 9)):
        if name == GRID and world != "paper:a":
            continue
        env = gymnasium.make(name, map=world, render_mode="human")
        env.reset(seed=1)
        env.step(0)
        assert env.render() is None
        env.close()
        env = gymnasium.make(name, map=world, render_mode="rgb_array", max_episode_steps=50)
        env.reset(seed=1)
        before = env.render()
        env.step(int(np.flatnonzero(env.unwrapped.action_masks())[0]) if name != GRID else 0)
        assert before.dtype == np.uint8 and before.ndim == 3 and len(np.unique(before)) > 3
        assert before.shape == env.render().shape
        env = gymnasium.make(name, map=world, render_mode="ansi")
        env.reset(seed=1)
        assert env.render().count("@" if world == "paper:a" else "visited 1 of 9") == 1


def begun_one():
    env = graphdrl.environments.GridEnv()
    env.reset(seed=1)
    return env


def begun_pair():
    envs = graphdrl.environments.GridVectorEnv(2)
    envs.reset(seed=1)
    return envs


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: gymnasium.make(GRID, map="paper:z"), "no such map"),
        (lambda: gymnasium.make(GRID, family="tree"), "bad family"),
        (lambda: gymnasium.make(GRID, family="maze", size=4), "odd"),
        (lambda: gymnasium.make(GRID, family="maze", map="paper:a"), "got both"),
        (lambda: gymnasium.make(GRAPH, family="forest"), "forest"),
        (lambda: gymnasium.make(GRAPH, family="tree", start=0), "bad start"),
        (lambda: gymnasium.make(GRAPH, family="tree", size=0), "size"),
        (lambda: gymnasium.make(GRAPH, max_neighbours=2).reset(seed=1), "max_neighbours = 2"),
        (lambda: gymnasium.make(GRAPH, max_neighbours=0), "max_neighbours"),
        (lambda: gymnasium.make(GRAPH, observation="sound"), "bad observation"),
        (lambda: gymnasium.make(FIRST_VISIT, max_visits=1000), "max_visits"),
        (lambda: gymnasium.make(FIRST_VISIT, budget="much"), "budget"),
        (lambda: gymnasium.make(UNKNOWN, max_visits=0), "max_visits"),
        (lambda: gymnasium.make(UNKNOWN, reveal="all"), "bad reveal: expected edges"),
        (lambda: gymnasium.make(UNKNOWN, reveal="radius:x"), "bad reveal"),
        (lambda: gymnasium.make(UNKNOWN, reveal=3), "bad reveal: expected text"),
        (lambda: gymnasium.make(UNKNOWN, score="money"), "bad score: expected visited or seen"),
        (lambda: gymnasium.make(UNKNOWN, family="tree", reveal="sight:3"), "sight needs a map of cells"),
        (lambda: graphdrl.environments.GraphEnv(family="tree").reset(options={"start": 0}), "random worlds"),
        (lambda: graphdrl.environments.GraphEnv().step(0), "over"),
        (lambda: gymnasium.make(GRID, map=7), "bad map"),
        (lambda: gymnasium.make(GRID, budget=0), "bad budget"),
        (lambda: gymnasium.make(GRID, budget=float("nan")), "bad budget"),
        (lambda: gymnasium.make(GRID, reward="money"), "bad reward"),
        (lambda: gymnasium.make(GRID, start=(9, 9)), "no such node"),
        (lambda: gymnasium.make(GRID, map=graphdrl.World.from_edges([[0, 1]])), "grid"),
        (lambda: gymnasium.make(GRID, start=(1, 1), map=graphdrl.World.from_grid("..\n.#")), "obstacle"),
        (lambda: begun_pair().step(np.array([0, 4])), "bad action"),
        (lambda: begun_pair().step(np.array([0])), r"number of actions: expected the shape \(2,\), got \(1,\)"),
        (lambda: begun_pair().step(np.array([[0], [1]])), "number of actions"),
        (lambda: begun_pair().step(np.array([0, 1.5])), "bad actions: expected an array of int64, got float64"),
        (lambda: begun_pair().step(None), "bad actions"),
        (lambda: begun_pair().reset(options={"strat": 3}), "expected 'start' or 'reset_mask', got 'strat'"),
        (lambda: begun_pair().reset(options=3), "bad options: expected a dictionary, got 3"),
        (lambda: begun_pair().reset(options={"reset_mask": [True]}), "bad shape of reset_mask"),
        (lambda: begun_pair().reset(seed=1.5), "bad seed"),
        (lambda: begun_pair().world(2), "bad index: expected a whole number from 0 to 1, got 2"),
        (lambda: gymnasium.make_vec(GRID, num_envs=2).step(np.array([0, 1])), "no episode has begun: reset"),
        (lambda: gymnasium.make_vec(GRID, num_envs="x"), "bad num_envs: expected a whole number from 1 up, got 'x'"),
        (lambda: gymnasium.make_vec(GRID, num_envs=0), "bad num_envs"),
        (lambda: gymnasium.make_vec(GRID, num_envs=2, copy="no"), "bad copy"),
        (lambda: gymnasium.make_vec(GRAPH, num_envs=2, observation="graph"), "flat boxes .*vectorization_mode='sync'"),
        (lambda: gymnasium.make_vec(FIRST_VISIT, num_envs=2, observation="graph"), "bad observation: make_vec gives"),
        (lambda: gymnasium.make_vec(GRID, num_envs=2, render_mode="ansi"), "bad render_mode: make_vec gives"),
        (lambda: gymnasium.make(GRID, size=7), "bad size: a map has its own"),
        (lambda: gymnasium.make(GRAPH, map="paper:a", size=7), "bad size"),
        (lambda: gymnasium.make(GRAPH, weighted=True), "bad weighted"),
        (lambda: gymnasium.make(FIRST_VISIT, map="paper:a", directed=True), "bad directed"),
        (lambda: gymnasium.make(GRAPH, family="tree", size="x"), "bad size: expected a whole number from 1 up"),
        (lambda: gymnasium.make(GRAPH, family="tree", weighted="no"), "bad weighted: expected True or False"),
        (lambda: gymnasium.make(GRAPH, return_to_start="no"), "bad return_to_start"),
        (lambda: begun_one().reset(options={"strat": 3}), "bad options: expected 'start', got 'strat'"),
        (lambda: begun_one().reset(options=3), "bad options: expected a dictionary, got 3"),
        (lambda: begun_one().step(1.5), "bad action: expected a whole number from 0 up, got 1.5"),
        (lambda: begun_one().step(-1), "bad action"),
        (lambda: begun_one().step(np.array([1])), r"bad action: .* got array\(\[1\]\)"),
        (lambda: begun_one().step(None), "bad action: .* got None"),
        (lambda: graphdrl.environments.GridEnv().step(0), "over"),
        (lambda: graphdrl.environments.GridEnv(render_mode="hologram"), "render mode"),
        (lambda: graphdrl.environments.GridEnv().reset(options={"start": "door"}), "no such node"),
    ],
)
def test_errors_say_what_to_change(call, message):
    with pytest.raises(graphdrl.Error, match=message) as error:
        call()
    assert "\n" not in str(error.value)
