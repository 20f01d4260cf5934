"""Environments for Gymnasium: the paper's decision process on grids. Importing this module registers them."""

from __future__ import annotations

from typing import Any

import gymnasium
import numpy as np
from gymnasium.vector import AutoresetMode
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from . import _core
from ._core import Error
from .world import Node, World, shown

GRID_ID = "GraphDRL/Grid-v0"
_REWARDS = ("visit_penalty", "coverage_gain")
_RENDER_MODES = ("ansi", "rgb_array")
_CELL_PIXELS = 24
_COLOURS = {"free": (255, 255, 255), "blocked": (60, 60, 70), "visited": (150, 200, 230), "current": (220, 90, 40)}


def _world_of(map: str | World) -> World:
    if isinstance(map, World):
        return map
    if isinstance(map, str):
        return World.from_file(map)
    raise Error(f"bad map: expected a World or the name of a map, got {shown(map)}")


class _Grid:
    """What one environment and many share: the episodes, their spaces."""

    def __init__(
        self,
        map: str | World,
        budget: float,
        reward: str,
        end_at_full_coverage: bool,
        punish_blocked_by_visits: bool,
        start: Node | None,
        count: int,
        restarts: bool,
    ) -> None:
        if reward not in _REWARDS:
            raise Error(f"bad reward: expected {' or '.join(_REWARDS)}, got {shown(reward)}")
        self.world = _world_of(map)
        if self.world.shape is None:
            raise Error(f"{self.world.name}: directions need a grid map")
        self.episodes = _core.GridEpisodes(
            self.world._core, float(budget), reward == "coverage_gain", end_at_full_coverage, punish_blocked_by_visits,
            -1 if start is None else self.world.number(start), count, restarts,
        )  # fmt: skip
        rows, columns = self.world.shape
        most = [max(rows - 1, 1), max(columns - 1, 1), 1, float(budget) + 1, 1, 4, 1]
        self.observation_space = gymnasium.spaces.Box(
            np.float32(0), np.tile(np.array(most, np.float32), self.world.node_count), dtype=np.float32
        )
        self.action_space = gymnasium.spaces.Discrete(4)

    def seed(self, index: int, random: np.random.Generator) -> None:
        self.episodes.seed(index, int(random.integers(2**63)))

    def start_of(self, options: dict[str, Any] | None) -> int:
        if options is None or "start" not in options:
            return -1
        return self.world.number(options["start"])


class GridEnv(gymnasium.Env[NDArray[np.float32], np.int64]):
    """One explorer on a grid map, as in the paper: visit as many cells as the budget allows.

    Actions: 0 left, 1 up, 2 right, 3 down. A move into an obstacle or off the map costs a step and stays put.

    Observation: Box [7 N] of float32, the paper's features of each cell, one cell after the other by rows: row, column,
    obstacle, visits, wall, unvisited neighbours, current. `observation.reshape(-1, 7)` is the matrix of the paper.

    Reward: `visit_penalty` (eq. 3): 0.1 for a new cell, -0.1 times the visits before of another, -0.5 for a blocked
    move; or `coverage_gain` (eq. 2). An episode is truncated where the budget is spent. It terminates at full coverage,
    with a bonus of 1, where `end_at_full_coverage`, which the paper's author's code does and the paper does not.

    It begins at `start`, else at a random free cell; `reset(options={"start": cell})` says otherwise for one episode.
    Infos: `visited`, how many cells, and `position`, the number of the current one.
    """

    metadata = {"render_modes": list(_RENDER_MODES), "render_fps": 8}

    def __init__(
        self,
        map: str | World = "paper:a",
        budget: float = 25,
        reward: str = "visit_penalty",
        end_at_full_coverage: bool = False,
        punish_blocked_by_visits: bool = False,
        start: Node | None = None,
        render_mode: str | None = None,
    ) -> None:
        if render_mode is not None and render_mode not in _RENDER_MODES:
            raise Error(f"bad render mode: expected {' or '.join(_RENDER_MODES)}, got {shown(render_mode)}")
        self._grid = _Grid(
            map, budget, reward, end_at_full_coverage, punish_blocked_by_visits, start, count=1, restarts=False
        )
        self.world = self._grid.world
        self.observation_space = self._grid.observation_space
        self.action_space = self._grid.action_space
        self.render_mode = render_mode
        self._seeded = False

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[np.float32], dict[str, Any]]:
        super().reset(seed=seed)
        if seed is not None or not self._seeded:
            self._grid.seed(0, self.np_random)
            self._seeded = True
        self._grid.episodes.reset(np.ones(1, bool), self._grid.start_of(options))
        return self._observation(), self._info()

    def step(self, action: int | np.int64) -> tuple[NDArray[np.float32], float, bool, bool, dict[str, Any]]:
        episodes = self._grid.episodes
        episodes.step(np.array([action], np.int64))
        over = bool(episodes.terminated[0]), bool(episodes.truncated[0])
        return self._observation(), float(episodes.rewards[0]), *over, self._info()

    def render(self) -> Any:
        if self.render_mode is None:
            return None
        if not self._seeded:
            raise Error("nothing to render: reset() first")
        walk = self._grid.episodes.walk(0)
        visited = np.zeros(self.world.node_count, bool)
        visited[walk] = True
        return (_text if self.render_mode == "ansi" else _picture)(self.world, visited, int(walk[-1]))

    def _observation(self) -> NDArray[np.float32]:
        return self._grid.episodes.features[0].copy()

    def _info(self) -> dict[str, Any]:
        episodes = self._grid.episodes
        return {"visited": int(episodes.visited[0]), "position": int(episodes.positions[0])}


class GridVectorEnv(gymnasium.vector.VectorEnv[NDArray[np.float32], NDArray[np.int64], NDArray[Any]]):
    """Many environments as GridEnv, all stepped by one call; `gymnasium.make_vec(id, num_envs)` makes it.

    Equal to SyncVectorEnv's, with the same seeds, step by step: an episode that is over begins anew with the next step.
    With `copy=False` observations are one array that every step writes anew. All else is always a copy.
    """

    metadata = {"autoreset_mode": AutoresetMode.NEXT_STEP, "render_modes": []}

    def __init__(
        self,
        num_envs: int = 1,
        map: str | World = "paper:a",
        budget: float = 25,
        reward: str = "visit_penalty",
        end_at_full_coverage: bool = False,
        punish_blocked_by_visits: bool = False,
        start: Node | None = None,
        copy: bool = True,
    ) -> None:
        self._grid = _Grid(
            map, budget, reward, end_at_full_coverage, punish_blocked_by_visits, start, count=num_envs, restarts=True
        )
        self.world = self._grid.world
        self.num_envs = num_envs
        self.single_observation_space = self._grid.observation_space
        self.single_action_space = self._grid.action_space
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self._copy = copy
        self._all = np.ones(num_envs, bool)
        self._random: list[np.random.Generator | None] = [None] * num_envs
        self._features = self._grid.episodes.features
        self._outcome = (self._grid.episodes.rewards, self._grid.episodes.terminated, self._grid.episodes.truncated)
        self._told = {"visited": self._grid.episodes.visited, "position": self._grid.episodes.positions}

    def reset(
        self, *, seed: int | list[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[np.float32], dict[str, Any]]:
        if isinstance(seed, (int, np.integer)):
            seeds: list[int | None] = [int(seed) + i for i in range(self.num_envs)]
        else:
            seeds = [None] * self.num_envs if seed is None else list(seed)
        if len(seeds) != self.num_envs:
            raise Error(f"bad number of seeds: expected {self.num_envs}, got {len(seeds)}")
        for i, one in enumerate(seeds):
            if one is not None or self._random[i] is None:
                random, _ = gymnasium.utils.seeding.np_random(one)
                self._random[i] = random
                self._grid.seed(i, random)
        mask = (options or {}).get("reset_mask", self._all)
        self._grid.episodes.reset(np.ascontiguousarray(mask, bool), self._grid.start_of(options))
        return self._observations(), self._infos()

    def step(
        self, actions: NDArray[np.int64]
    ) -> tuple[NDArray[np.float32], NDArray[np.float64], NDArray[np.bool_], NDArray[np.bool_], dict[str, Any]]:
        self._grid.episodes.step(np.ascontiguousarray(actions, np.int64))
        rewards, terminated, truncated = self._outcome
        return self._observations(), rewards.copy(), terminated.copy(), truncated.copy(), self._infos()

    def _observations(self) -> NDArray[np.float32]:
        return self._features.copy() if self._copy else self._features

    def _infos(self) -> dict[str, Any]:
        infos: dict[str, Any] = {}
        for name, values in self._told.items():
            infos[name] = values.copy()
            infos[f"_{name}"] = self._all
        return infos


def _text(world: World, visited: NDArray[np.bool_], current: int) -> str:
    chars = np.where(world.blocked.ravel(), "#", np.where(visited, "o", "."))
    chars[current] = "@"
    return "\n".join("".join(row) for row in chars.reshape(world.shape)) + "\n"


def _picture(world: World, visited: NDArray[np.bool_], current: int) -> NDArray[np.uint8]:
    """RGB, [rows 24, columns 24, 3]."""
    cells = np.empty((world.node_count, 3), np.uint8)
    cells[:] = _COLOURS["free"]
    cells[visited] = _COLOURS["visited"]
    cells[world.blocked.ravel()] = _COLOURS["blocked"]
    cells[current] = _COLOURS["current"]
    rows, columns = world.shape or (0, 0)
    picture = cells.reshape(rows, columns, 3).repeat(_CELL_PIXELS, axis=0).repeat(_CELL_PIXELS, axis=1)
    picture[::_CELL_PIXELS] = picture[:, ::_CELL_PIXELS] = 225
    return picture


if GRID_ID not in gymnasium.registry:
    gymnasium.register(
        GRID_ID,
        entry_point="graphdrl.environments:GridEnv",
        vector_entry_point="graphdrl.environments:GridVectorEnv",
    )
