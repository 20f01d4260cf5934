"""The environments for Gymnasium, beside Gymnasium's own tools and a plain environment in NumPy."""

import warnings

import graphdrl
import graphdrl.environments
import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

GRID = "GraphDRL/Grid-v0"
MAPS = ["paper:a", "paper:f", "paper:j"]


class PlainGrid:
    """The paper's process as its text says it: features from scratch, one environment."""

    MOVES = ((0, -1), (-1, 0), (0, 1), (1, 0))

    def __init__(self, blocked, budget, full_coverage):
        self.blocked, self.budget, self.full_coverage = blocked, budget, full_coverage

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
        terminated = self.full_coverage and bool(np.all(self.blocked | (self.visits > 0)))
        reward += 1.0 if terminated and before == 0 else 0.0
        return self.features(), reward, terminated, not terminated and self.left < 1

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


@pytest.mark.parametrize("options", [{}, {"reward": "coverage_gain", "map": "paper:j"}, {"end_at_full_coverage": True}])
def test_gymnasiums_checker_has_nothing_to_say(options):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(gymnasium.make(GRID, **options).unwrapped)
        check_env(gymnasium.make(GRID, render_mode="rgb_array", **options).unwrapped)


@pytest.mark.parametrize("full_coverage", [False, True])
@pytest.mark.parametrize("name", MAPS)
def test_steps_are_the_papers(name, full_coverage):
    env = gymnasium.make(GRID, map=name, budget=40, end_at_full_coverage=full_coverage)
    plain = PlainGrid(np.array(env.unwrapped.world.blocked), 40, full_coverage)
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


def test_full_coverage_terminates_with_a_bonus():
    env = gymnasium.make(GRID, map=graphdrl.World.from_grid(".."), budget=9, end_at_full_coverage=True, start=(0, 0))
    env.reset()
    _, reward, terminated, truncated, info = env.step(2)
    assert (reward, terminated, truncated, info["visited"]) == (1.1, True, False, 2)


@pytest.mark.parametrize("options", [{}, {"map": "paper:j", "budget": 7, "end_at_full_coverage": True}])
def test_many_environments_equal_gymnasiums_one_by_one(options):
    ours = gymnasium.make_vec(GRID, num_envs=9, vectorization_mode="vector_entry_point", **options)
    theirs = gymnasium.make_vec(GRID, num_envs=9, vectorization_mode="sync", **options)
    assert isinstance(ours.unwrapped, graphdrl.environments.GridVectorEnv)
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
        actions = random.integers(4, size=9)
        assert_equal(ours.step(actions), theirs.step(actions))
        if step == 150:
            assert_equal(ours.reset(), theirs.reset())
        if step == 200:
            start = {"options": {"start": (0, 0)}}
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


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: gymnasium.make(GRID, map="paper:z"), "no such map"),
        (lambda: gymnasium.make(GRID, map=7), "bad map"),
        (lambda: gymnasium.make(GRID, budget=0), "bad budget"),
        (lambda: gymnasium.make(GRID, budget=float("nan")), "bad budget"),
        (lambda: gymnasium.make(GRID, reward="money"), "bad reward"),
        (lambda: gymnasium.make(GRID, start=(9, 9)), "no such node"),
        (lambda: gymnasium.make(GRID, map=graphdrl.World.from_edges([[0, 1]])), "grid"),
        (lambda: gymnasium.make(GRID, start=(1, 1), map=graphdrl.World.from_grid("..\n.#")), "obstacle"),
        (lambda: gymnasium.make_vec(GRID, num_envs=2).step(np.array([0, 4])), "bad action"),
        (lambda: gymnasium.make_vec(GRID, num_envs=2).step(np.array([0])), "number of actions"),
        (lambda: graphdrl.environments.GridEnv().step(0), "over"),
        (lambda: graphdrl.environments.GridEnv(render_mode="hologram"), "render mode"),
        (lambda: graphdrl.environments.GridEnv().reset(options={"start": "door"}), "no such node"),
    ],
)
def test_errors_say_what_to_change(call, message):
    with pytest.raises(graphdrl.Error, match=message):
        call()
