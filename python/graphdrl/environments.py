"""Environments for Gymnasium; importing this module registers them.

- `GraphDRL/Grid-v0`: the paper's decision process, directions on a grid.
- `GraphDRL/Graph-v0`: any graph, an action is a neighbour.
- `GraphDRL/FirstVisit-v0`: any graph, an action is a walk to an unvisited node.
"""

from __future__ import annotations

from typing import Any, ClassVar

import gymnasium
import numpy as np
from gymnasium import spaces
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from . import _core
from ._core import Error
from .checks import LARGEST_INT, flag, listed, shown, whole_number, wrong
from .world import Budget, Node, World, array_of, budget_text, flat_of

__all__ = [
    "FIRST_VISIT_ID",
    "GRAPH_ID",
    "GRID_ID",
    "FirstVisitEnv",
    "FirstVisitVectorEnv",
    "GraphEnv",
    "GraphVectorEnv",
    "GridEnv",
    "GridVectorEnv",
]

GRID_ID = "GraphDRL/Grid-v0"
"""What `gymnasium.make` and `make_vec` know GridEnv and GridVectorEnv by."""
GRAPH_ID = "GraphDRL/Graph-v0"
"""The same of GraphEnv and GraphVectorEnv."""
FIRST_VISIT_ID = "GraphDRL/FirstVisit-v0"
"""The same of FirstVisitEnv and FirstVisitVectorEnv."""

_REWARDS = ("visit_penalty", "coverage_gain")
_OBSERVATIONS = ("flat", "graph")
_RENDER_MODES = ("ansi", "rgb_array", "human")
_FRAMES_PER_SECOND = 8
_CELL_PIXELS = 24
_GRID_SIZE = 5
_GRAPH_SIZE = 20
_COLOURS = {"free": (255, 255, 255), "blocked": (60, 60, 70), "visited": (150, 200, 230), "current": (220, 90, 40)}


def _require(value: str, choices: tuple[str, ...], what: str) -> None:
    if value not in choices:
        raise wrong(what, " or ".join(choices), value)


class _Setting:
    """Where episodes take place, as all environments take it."""

    def __init__(
        self,
        map: str | World | None,
        family: str | None,
        size: int | None,
        usual_size: int,
        weighted: bool,
        directed: bool,
        budget: Budget,
        reward: str,
        start: Node | None,
        return_to_start: bool,
    ) -> None:
        _require(reward, _REWARDS, "reward")
        if family is not None and map is not None:
            raise Error("bad map: expected a map or a family of random worlds, got both")
        weighted, directed = flag(weighted, "weighted"), flag(directed, "directed")
        if family is None:
            for name, given in (("size", size is not None), ("weighted", weighted), ("directed", directed)):
                if given:
                    raise Error(f"bad {name}: a map has its own: expected a family of random worlds with it")
        size = whole_number(usual_size if size is None else size, "size", 1, LARGEST_INT)
        self.world: World | None = None
        if family is None:
            self.world = _world_of("paper:a" if map is None else map)
        elif start is not None:
            raise Error("bad start: random worlds have none to choose")
        self.budget = budget_text(budget)
        self.state = (
            None if self.world is None else self.world._core, (family or "", size, weighted, directed), self.budget,
            -1 if start is None or self.world is None else self.world.number(start), reward == "coverage_gain",
            flag(return_to_start, "return_to_start"),
        )  # fmt: skip
        if self.world is not None:
            self.nodes = self.world.node_count
        else:
            self.nodes = size * size if family in _core.GRID_FAMILIES else size
        self.size = size

    def start_of(self, options: dict[str, Any] | None, known: tuple[str, ...]) -> int:
        """The number of the node that the options of a `reset` name, -1 without one; `known`: all options there are."""
        if options is None:
            return -1
        if not isinstance(options, dict):
            raise wrong("options", "a dictionary", options)
        for name in options:
            if name not in known:
                raise wrong("options", " or ".join(map(repr, known)), name)
        if options.get("start") is None:
            return -1
        if self.world is None:
            raise Error("bad start: random worlds have none to choose")
        return self.world.number(options["start"])


def _world_of(map: str | World) -> World:
    if isinstance(map, World):
        return map
    if isinstance(map, str):
        return World.from_file(map)
    raise wrong("map", "a World or the name of a map", map)


class _Kind:
    """The episodes of one kind of environment, and their spaces."""

    def __init__(self, setting: _Setting, episodes: Any, observations: Any, action_count: int, masks: bool) -> None:
        self.setting = setting
        self.episodes = episodes
        self.observation_space = observations
        self.action_space = spaces.Discrete(action_count)
        self.masks = masks
        self.graph_space: spaces.Graph | None = None

    def seed(self, index: int, random: np.random.Generator) -> None:
        self.episodes.seed(index, int(random.integers(2**63)))

    def world(self, index: int) -> World:
        if self.setting.world is not None:
            return self.setting.world
        return World(self.episodes.world(index))

    def told(self) -> dict[str, NDArray[Any]]:
        """What infos say, of all environments."""
        told = {"visited": self.episodes.visited, "position": self.episodes.positions}
        if self.masks:
            told |= {"action_mask": self.episodes.action_masks, "targets": self.episodes.targets}
        return told


def _grid_kind(
    count: int, restarts: bool, end_at_full_coverage: bool, punish_blocked_by_visits: bool, **options: Any
) -> _Kind:
    setting = _Setting(usual_size=_GRID_SIZE, weighted=False, directed=False, return_to_start=False, **options)
    family, size = options["family"], setting.size
    if setting.world is not None:
        if setting.world.shape is None:
            raise Error(f"{setting.world.name}: directions need a grid map")
        rows, columns = setting.world.shape
        budget = _core.budget_in(setting.world._core, setting.budget)
    else:
        if family not in _core.GRID_FAMILIES:
            raise Error(f"bad family: expected {', '.join(_core.GRID_FAMILIES)}, got {shown(family)}")
        rows = columns = size
        budget = _core.budget_in(World.from_grid(np.zeros((size, size), bool))._core, setting.budget)
    episodes = _core.GridEpisodes(
        setting.state, flag(end_at_full_coverage, "end_at_full_coverage"),
        flag(punish_blocked_by_visits, "punish_blocked_by_visits"), count, restarts, setting.nodes,
    )  # fmt: skip
    most = [max(rows - 1, 1), max(columns - 1, 1), 1, budget + 1, 1, 4, 1]
    box = spaces.Box(np.float32(0), np.tile(np.array(most, np.float32), setting.nodes), dtype=np.float32)
    return _Kind(setting, episodes, box, 4, masks=False)


def _graph_kind(count: int, restarts: bool, max_neighbours: int | None, **options: Any) -> _Kind:
    setting = _Setting(usual_size=_GRAPH_SIZE, **options)
    if max_neighbours is None:
        if setting.world is not None:
            max_neighbours = max(_degree_of(setting.world), 1)
        else:
            max_neighbours = 4 if options["family"] in _core.GRID_FAMILIES else max(setting.nodes - 1, 1)
    max_neighbours = whole_number(max_neighbours, "max_neighbours", 1, 1_000_000)
    episodes = _core.GraphEpisodes(setting.state, count, restarts, setting.nodes, max_neighbours)
    box = spaces.Box(0, 1, episodes.observations.shape[1:], np.float32)
    kind = _Kind(setting, episodes, box, max_neighbours, masks=True)
    kind.graph_space = spaces.Graph(
        spaces.Box(0, 1, (_core.GRAPH_NODE_FEATURES,), np.float32), spaces.Box(0, np.inf, (1,), np.float32)
    )
    return kind


def _first_visit_kind(count: int, restarts: bool, max_visits: int, **options: Any) -> _Kind:
    setting = _Setting(usual_size=_GRAPH_SIZE, **options)
    max_visits = whole_number(max_visits, "max_visits", 1, 96)
    episodes = _core.FirstVisitEpisodes(setting.state, count, restarts, max_visits)
    box = spaces.Box(-16, 16, episodes.observations.shape[1:], np.float32)
    kind = _Kind(setting, episodes, box, max_visits, masks=True)
    kind.graph_space = spaces.Graph(
        spaces.Box(-16, 16, (_core.EXPLORER_NODE_FEATURES,), np.float32), spaces.Box(0, np.inf, (1,), np.float32)
    )
    return kind


def _degree_of(world: World) -> int:
    """The most neighbours that a node has, obstacles aside."""
    ends, _ = world.edges()
    free = ~world.blocked.ravel()
    ends = ends[free[ends].all(axis=1)]
    degrees = np.bincount(ends[:, 0], minlength=1)
    if not world.directed:
        size = world.node_count
        degrees = np.bincount(ends[:, 0], minlength=size) + np.bincount(ends[:, 1], minlength=size)
    return int(degrees.max(initial=0))


class _Env(gymnasium.Env[Any, np.int64]):
    """What the single environments share."""

    metadata: ClassVar[dict[str, Any]] = {"render_modes": list(_RENDER_MODES), "render_fps": _FRAMES_PER_SECOND}

    def __init__(self, kind: _Kind, observation: str, render_mode: str | None) -> None:
        if render_mode is not None:
            _require(render_mode, _RENDER_MODES, "render mode")
        _require(observation, _OBSERVATIONS, "observation")
        self._kind = kind
        self._as_graph = observation == "graph"
        self.observation_space = kind.graph_space if self._as_graph else kind.observation_space
        self.action_space = kind.action_space
        self.render_mode = render_mode
        self._begun = False
        self._window: _Window | None = None

    @property
    def world(self) -> World:
        """The world of the episode. Of random worlds, raises Error before the first `reset`."""
        return self._kind.world(0)

    @property
    def walk(self) -> list[Node]:
        """Every position of the episode so far, the start first, as the world calls the nodes."""
        return self.world.names(self._kind.episodes.walk(0))

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Any, dict[str, Any]]:
        """Begins an episode.

        Args:
            seed: of starts and random worlds, of this episode and those after it.
            options: `{"start": node}` says where this episode begins.

        Returns:
            The observation, and the infos of `step`.

        Raises:
            Error: a blocked or missing start, a start for random worlds, options other than these.
        """
        start = self._kind.setting.start_of(options, ("start",))
        super().reset(seed=seed)
        if seed is not None or not self._begun:
            self._kind.seed(0, self.np_random)
            self._begun = True
        self._kind.episodes.reset(np.ones(1, bool), start)
        if self.render_mode == "human":
            self.render()
        return self._observation(), self._info()

    def step(self, action: int | np.int64) -> tuple[Any, float, bool, bool, dict[str, Any]]:
        """Takes an action.

        Args:
            action: from 0 up.

        Returns:
            Observation, reward, whether the episode is terminated, whether it is truncated, and infos. Infos are
            `visited`, how many nodes; `position`, the number of the current one; and those that the class adds.

        Raises:
            Error: no such action, an episode that is over or has not begun.
        """
        episodes = self._kind.episodes
        episodes.step(np.array([whole_number(action, "action", 0, LARGEST_INT)], np.int64))
        if self.render_mode == "human":
            self.render()
        over = bool(episodes.terminated[0]), bool(episodes.truncated[0])
        return self._observation(), float(episodes.rewards[0]), *over, self._info()

    def action_masks(self) -> NDArray[np.bool_]:
        """Which actions may be taken, where sb3-contrib's MaskablePPO looks for them. Shape [A], bool.

        Of a GridEnv all may, so all are true.
        """
        return self._kind.episodes.action_masks[0].copy()

    def render(self) -> Any:
        """Shows the episode as `render_mode` says.

        Returns:
            A text of `ansi`, a picture [height, width, 3], uint8, of `rgb_array`; None of `human`, which opens a
            window.

        Raises:
            Error: no episode has begun.
            gymnasium.error.DependencyNotInstalled: `human` without pygame.
        """
        if self.render_mode is None:
            return None
        if not self._begun:
            raise Error("nothing to render: reset() first")
        walk = self._kind.episodes.walk(0)
        if self.render_mode == "ansi":
            return self._text(walk)
        picture = _picture(self.world, walk)
        if self.render_mode == "rgb_array":
            return picture
        if self._window is None:
            self._window = _Window(self.world.name)
        self._window.show(picture)
        return None

    def close(self) -> None:
        """Closes the window of `render_mode="human"`."""
        if self._window is not None:
            self._window.close()
            self._window = None

    def _text(self, walk: NDArray[np.int32]) -> str:
        world = self.world
        if world.shape is not None:
            return _grid_text(world, walk)
        here = world.names([walk[-1]])[0]
        visited = int(self._kind.episodes.visited[0])
        return f"at {here}: visited {visited} of {world.valid_count}, spent {self._kind.episodes.spent(0):g}\n"

    def _observation(self) -> Any:
        if not self._as_graph:
            return self._kind.episodes.observations[0].copy()
        return spaces.GraphInstance(*self._kind.episodes.graph(0))

    def _info(self) -> dict[str, Any]:
        told = {name: values[0] for name, values in self._kind.told().items()}
        info = {name: value.copy() if isinstance(value, np.ndarray) else int(value) for name, value in told.items()}
        if self._as_graph and hasattr(self._kind.episodes, "target_rows"):
            info["target_rows"] = self._kind.episodes.target_rows(0)
        return info


class _VectorEnv(gymnasium.vector.VectorEnv[NDArray[np.float32], NDArray[np.int64], NDArray[Any]]):
    """What the vector environments share: all episodes are stepped by one call.

    Equal to SyncVectorEnv's, with the same seeds, step by step: an episode that is over begins anew with the next step.
    With `copy=False` observations are one array that every step writes anew. All else is always a copy.
    """

    metadata: ClassVar[dict[str, Any]] = {"render_modes": []}
    if hasattr(gymnasium.vector, "AutoresetMode"):  # from Gymnasium 1.1 on; before, there was no other
        metadata["autoreset_mode"] = gymnasium.vector.AutoresetMode.NEXT_STEP

    def __init__(self, kind: _Kind, num_envs: int, copy: bool) -> None:
        copy = flag(copy, "copy")
        self._kind = kind
        self._begun = False
        self.num_envs = num_envs
        self.single_observation_space = kind.observation_space
        self.single_action_space = kind.action_space
        self.observation_space = batch_space(kind.observation_space, num_envs)
        self.action_space = batch_space(kind.action_space, num_envs)
        self._copy = copy
        self._all = np.ones(num_envs, bool)
        self._random: list[np.random.Generator | None] = [None] * num_envs
        episodes = kind.episodes
        self._observed = episodes.observations
        self._outcome = (episodes.rewards, episodes.terminated, episodes.truncated)
        self._told = kind.told()

    def reset(
        self, *, seed: int | list[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """Begins an episode in every environment. V: how many environments, F: numbers of an observation.

        Args:
            seed: one for each; or one, and the others follow it.
            options: `{"start": node}`; `{"reset_mask": array}`, [V], bool: which environments, by default all.

        Returns:
            Observations [V, F], float32, and the infos of `step`.

        Raises:
            Error: a number of seeds other than V, a blocked or missing start, a start for random worlds, options other
                than these.
        """
        start = self._kind.setting.start_of(options, ("start", "reset_mask"))
        mask = (options or {}).get("reset_mask", self._all)
        mask = flat_of(mask, bool, "reset_mask", "b", self.num_envs)
        if isinstance(seed, (int, np.integer)):
            seeds: list[int | None] = [int(seed) + i for i in range(self.num_envs)]
        else:
            seeds = [None] * self.num_envs if seed is None else listed(seed, "seed", "one, or one for each")
        if len(seeds) != self.num_envs:
            raise Error(f"bad number of seeds: expected {self.num_envs}, got {len(seeds)}")
        for i, one in enumerate(seeds):
            if one is not None or self._random[i] is None:
                random, _ = gymnasium.utils.seeding.np_random(one)
                self._random[i] = random
                self._kind.seed(i, random)
        self._kind.episodes.reset(mask, start)
        self._begun = True
        return self._observations(), self._infos()

    def step(
        self, actions: NDArray[np.int64]
    ) -> tuple[NDArray[np.float32], NDArray[np.float64], NDArray[np.bool_], NDArray[np.bool_], dict[str, Any]]:
        """Takes an action in every environment. Where an episode is over, begins the next instead, for no reward.

        Args:
            actions: [V], from 0 up.

        Returns:
            Observations [V, F], rewards [V], terminated [V], truncated [V], and infos, arrays of V rows by the names
            of the single environment's.

        Raises:
            Error: a number of actions other than V, no such action, no `reset` before.
        """
        chosen = array_of(actions, np.int64, "actions", "iu")
        if chosen.shape != (self.num_envs,):
            raise Error(f"bad number of actions: expected the shape ({self.num_envs},), got {chosen.shape}")
        if not self._begun:
            raise Error("no episode has begun: reset() first")
        self._kind.episodes.step(chosen)
        rewards, terminated, truncated = self._outcome
        return self._observations(), rewards.copy(), terminated.copy(), truncated.copy(), self._infos()

    def world(self, index: int = 0) -> World:
        """The world of an episode.

        Args:
            index: of the environment, from 0 up.
        """
        return self._kind.world(whole_number(index, "index", 0, self.num_envs - 1))

    def action_masks(self) -> NDArray[np.bool_]:
        """Which actions may be taken. Shape [V, A], bool."""
        return self._kind.episodes.action_masks.copy()

    def _observations(self) -> NDArray[np.float32]:
        return self._observed.copy() if self._copy else self._observed

    def _infos(self) -> dict[str, Any]:
        infos: dict[str, Any] = {}
        for name, values in self._told.items():
            infos[name] = values.copy()
            infos[f"_{name}"] = self._all
        return infos


def _vector_count(num_envs: int, observation: str, render_mode: str | None) -> int:
    """How many environments. Refuses what single ones alone can do."""
    for name, given in (("observation", observation != "flat"), ("render_mode", render_mode is not None)):
        if given:
            raise Error(
                f"bad {name}: make_vec gives flat boxes and no pictures, single environments have them: "
                "vectorization_mode='sync' takes them"
            )
    return whole_number(num_envs, "num_envs", 1, LARGEST_INT)


class GridEnv(_Env):
    """One explorer on a grid map, as in the paper: visit as many cells as the budget allows. N: how many cells.

    Actions: 0 left, 1 up, 2 right, 3 down. A move into an obstacle or off the map costs a step and stays put.

    Observation: Box [7 N] of float32, the features of each cell [paper, section 2.1], one cell after the other by rows:
    row, column, obstacle, visits, wall, unvisited neighbours, current. `observation.reshape(-1, 7)` has a row per cell.

    Reward `visit_penalty` [paper, eq. 3]: 0.1 for a new cell, -0.1 times the visits before of another, -0.5 for a
    blocked move. Reward `coverage_gain` [paper, eq. 2]: the share of the free cells that a first visit adds.

    An episode is truncated where the budget is spent.

    Args:
        map: a World or the name of a map; by default `paper:a`.
        budget: steps, or a text as `"1.1x"`.
        reward: `visit_penalty` or `coverage_gain`.
        end_at_full_coverage: an episode terminates at full coverage, with a bonus of 1. Differs from the paper: its
            author's code does so.
        punish_blocked_by_visits: a blocked move costs a further 0.1 per visit of the cell before it, with
            `visit_penalty`. Differs from the paper: its author's code does so.
        start: a cell; by default a random free one.
        family: of random worlds instead of `map`, a new one with every `reset`: a family of grids.
        size: of random worlds: cells a side, by default 5.
        render_mode: `ansi`, `rgb_array` or `human`.

    Raises:
        Error: a map that is no grid, a family of graphs, both a map and a family, a bad value of another option.
    """

    def __init__(
        self,
        map: str | World | None = None,
        budget: Budget = 25,
        reward: str = "visit_penalty",
        end_at_full_coverage: bool = False,
        punish_blocked_by_visits: bool = False,
        start: Node | None = None,
        family: str | None = None,
        size: int | None = None,
        render_mode: str | None = None,
    ) -> None:
        kind = _grid_kind(
            1, False, end_at_full_coverage, punish_blocked_by_visits, map=map, family=family, size=size, budget=budget,
            reward=reward, start=start,
        )  # fmt: skip
        super().__init__(kind, "flat", render_mode)


class GridVectorEnv(_VectorEnv):
    """Many environments as GridEnv, with its options; `gymnasium.make_vec(id, num_envs)` makes it.

    All episodes are stepped by one call. Steps equal those of Gymnasium's SyncVectorEnv with the same seeds.

    Args:
        num_envs: V, how many.
        copy: if false, observations are one array that every step writes anew. All else is always a copy.
        render_mode: None; pictures are of single environments.

    Raises:
        Error: as GridEnv does.
    """

    def __init__(
        self,
        num_envs: int = 1,
        map: str | World | None = None,
        budget: Budget = 25,
        reward: str = "visit_penalty",
        end_at_full_coverage: bool = False,
        punish_blocked_by_visits: bool = False,
        start: Node | None = None,
        family: str | None = None,
        size: int | None = None,
        copy: bool = True,
        render_mode: str | None = None,
    ) -> None:
        num_envs = _vector_count(num_envs, "flat", render_mode)
        kind = _grid_kind(
            num_envs, True, end_at_full_coverage, punish_blocked_by_visits, map=map, family=family, size=size,
            budget=budget, reward=reward, start=start,
        )  # fmt: skip
        super().__init__(kind, num_envs, copy)


class GraphEnv(_Env):
    """One explorer on any graph: visit as much as the budget allows, edge by edge. N: nodes, A: actions.

    Actions: the neighbours of the current node, in ascending order of their numbers. A masked action leads nowhere or
    cannot be paid for. It costs an edge of mean cost and stays put; where that cannot be paid for, it ends the episode.

    Infos: `action_mask`, bool [A]; `targets`, int [A], the number of the node that each action leads to, -1 for
    nowhere.

    Observation `flat`: Box [4 N + 5 A + 2] of float32 from 0 to 1: of each node open, visited, current, prize (in eight
    mean prizes); of each action legal, visited, cost (in eight mean edges), prize, unvisited neighbours there (in
    eight); the budget left and the nodes visited, as shares.

    Observation `graph`: spaces.Graph of a row [6] for each node: open, visited, current, prize, one legal step away,
    budget left; and edges both ways, with their cost in mean edges, [1].

    Reward: `visit_penalty` [paper, eq. 3], where a masked action is a blocked move; or `coverage_gain` [paper, eq. 2]:
    the share of all nodes, or of all prizes, that a first visit brings.

    An episode terminates where nothing can be paid for, or everything is visited. It is never truncated, for what is
    left of the budget is part of the observation.

    Args:
        map: as of GridEnv; any World.
        budget: in units of cost, or a text as `"1.1x"`.
        reward: `visit_penalty` or `coverage_gain`.
        start: a node; by default a random free one.
        return_to_start: the walk must end where it began. Moves that make that too dear are masked.
        family: of random worlds instead of `map`, a new one with every `reset`.
        size: of random worlds: nodes of a graph, cells a side of a grid; by default 20.
        weighted: of random graphs: edges cost differently.
        directed: of random graphs: three edges in ten lead one way only.
        max_neighbours: A; by default what the map needs, of random grids 4, of random graphs `size` - 1.
        observation: `flat` or `graph`.
        render_mode: `ansi`, `rgb_array` or `human`.

    Raises:
        Error: both a map and a family, a node of more neighbours than A, a bad value of another option.
    """

    def __init__(
        self,
        map: str | World | None = None,
        budget: Budget = "1.1x",
        reward: str = "visit_penalty",
        start: Node | None = None,
        return_to_start: bool = False,
        family: str | None = None,
        size: int | None = None,
        weighted: bool = False,
        directed: bool = False,
        max_neighbours: int | None = None,
        observation: str = "flat",
        render_mode: str | None = None,
    ) -> None:
        kind = _graph_kind(
            1, False, max_neighbours, map=map, family=family, size=size, weighted=weighted, directed=directed,
            budget=budget, reward=reward, start=start, return_to_start=return_to_start,
        )  # fmt: skip
        super().__init__(kind, observation, render_mode)


class GraphVectorEnv(_VectorEnv):
    """Many environments as GraphEnv, with its options and flat observations; see GridVectorEnv.

    Args:
        num_envs: V, how many.
        copy: as of GridVectorEnv.
        observation: `flat`; graphs are of single environments.
        render_mode: None; pictures are of single environments.

    Raises:
        Error: as GraphEnv does.
    """

    def __init__(
        self,
        num_envs: int = 1,
        map: str | World | None = None,
        budget: Budget = "1.1x",
        reward: str = "visit_penalty",
        start: Node | None = None,
        return_to_start: bool = False,
        family: str | None = None,
        size: int | None = None,
        weighted: bool = False,
        directed: bool = False,
        max_neighbours: int | None = None,
        copy: bool = True,
        observation: str = "flat",
        render_mode: str | None = None,
    ) -> None:
        num_envs = _vector_count(num_envs, observation, render_mode)
        kind = _graph_kind(
            num_envs, True, max_neighbours, map=map, family=family, size=size, weighted=weighted, directed=directed,
            budget=budget, reward=reward, start=start, return_to_start=return_to_start,
        )  # fmt: skip
        super().__init__(kind, num_envs, copy)


class FirstVisitEnv(_Env):
    """One explorer on any graph, from first visit to first visit. A: actions.

    An action walks to an unvisited node next to visited ones, by the cheapest way through visited ground.

    Actions: the A nearest first visits, nearest first. Infos as of GraphEnv; masked actions cost what they cost there.

    Observation `flat`: Box [12 A] of float32 from -16 to 16: of each action 1 where there is one, and what the explorer
    sees of it, 11 features (docs/explorer.md).

    Observation `graph`: spaces.Graph of the nodes around the current one, with what the explorer sees of each, [20];
    and edges both ways, with their cost in mean edges, [1]. `info["target_rows"]`, int [A]: the row of each action's
    target, -1 where there is none.

    Reward: the sum over the walk of GraphEnv's. An episode terminates where no first visit can be paid for.

    Args:
        map: as of GraphEnv.
        budget: as of GraphEnv.
        reward: as of GraphEnv.
        start: as of GraphEnv.
        return_to_start: as of GraphEnv.
        family: as of GraphEnv.
        size: as of GraphEnv.
        weighted: as of GraphEnv.
        directed: as of GraphEnv.
        max_visits: A, 1 to 96.
        observation: `flat` or `graph`.
        render_mode: `ansi`, `rgb_array` or `human`.

    Raises:
        Error: as GraphEnv does, and `max_visits` out of range.
    """

    def __init__(
        self,
        map: str | World | None = None,
        budget: Budget = "1.1x",
        reward: str = "coverage_gain",
        start: Node | None = None,
        return_to_start: bool = False,
        family: str | None = None,
        size: int | None = None,
        weighted: bool = False,
        directed: bool = False,
        max_visits: int = 16,
        observation: str = "flat",
        render_mode: str | None = None,
    ) -> None:
        kind = _first_visit_kind(
            1, False, max_visits, map=map, family=family, size=size, weighted=weighted, directed=directed,
            budget=budget, reward=reward, start=start, return_to_start=return_to_start,
        )  # fmt: skip
        super().__init__(kind, observation, render_mode)


class FirstVisitVectorEnv(_VectorEnv):
    """Many environments as FirstVisitEnv, with its options and flat observations; see GridVectorEnv.

    Args:
        num_envs: V, how many.
        copy: as of GridVectorEnv.
        observation: `flat`; graphs are of single environments.
        render_mode: None; pictures are of single environments.

    Raises:
        Error: as FirstVisitEnv does.
    """

    def __init__(
        self,
        num_envs: int = 1,
        map: str | World | None = None,
        budget: Budget = "1.1x",
        reward: str = "coverage_gain",
        start: Node | None = None,
        return_to_start: bool = False,
        family: str | None = None,
        size: int | None = None,
        weighted: bool = False,
        directed: bool = False,
        max_visits: int = 16,
        copy: bool = True,
        observation: str = "flat",
        render_mode: str | None = None,
    ) -> None:
        num_envs = _vector_count(num_envs, observation, render_mode)
        kind = _first_visit_kind(
            num_envs, True, max_visits, map=map, family=family, size=size, weighted=weighted, directed=directed,
            budget=budget, reward=reward, start=start, return_to_start=return_to_start,
        )  # fmt: skip
        super().__init__(kind, num_envs, copy)


class _Window:
    """Pictures one after the other, in a window of pygame."""

    def __init__(self, title: str) -> None:
        try:
            import pygame
        except ImportError as error:
            raise gymnasium.error.DependencyNotInstalled("render_mode='human' needs pygame: install it") from error
        self._pygame = pygame
        pygame.display.init()
        pygame.display.set_caption(title)
        self._clock = pygame.time.Clock()
        self._screen: Any = None

    def show(self, picture: NDArray[np.uint8]) -> None:
        size = picture.shape[1], picture.shape[0]
        if self._screen is None or self._screen.get_size() != size:
            self._screen = self._pygame.display.set_mode(size)
        self._pygame.event.pump()
        self._pygame.surfarray.blit_array(self._screen, picture.swapaxes(0, 1))
        self._pygame.display.flip()
        self._clock.tick(_FRAMES_PER_SECOND)

    def close(self) -> None:
        self._pygame.display.quit()


def _grid_text(world: World, walk: NDArray[np.int32]) -> str:
    chars = np.where(world.blocked.ravel(), "#", ".")
    chars[walk] = "o"
    chars[walk[-1]] = "@"
    return "\n".join("".join(row) for row in chars.reshape(world.shape)) + "\n"


def _picture(world: World, walk: NDArray[np.int32]) -> NDArray[np.uint8]:
    """RGB, [rows, columns, 3]: of a grid its cells, of a graph its nodes and the walk."""
    if world.shape is None:
        return _core.picture_of(world._core, walk)
    cells = np.empty((world.node_count, 3), np.uint8)
    cells[:] = _COLOURS["free"]
    cells[walk] = _COLOURS["visited"]
    cells[world.blocked.ravel()] = _COLOURS["blocked"]
    cells[walk[-1]] = _COLOURS["current"]
    rows, columns = world.shape
    picture = cells.reshape(rows, columns, 3).repeat(_CELL_PIXELS, axis=0).repeat(_CELL_PIXELS, axis=1)
    picture[::_CELL_PIXELS] = picture[:, ::_CELL_PIXELS] = 225
    return picture


for _id, _name in ((GRID_ID, "Grid"), (GRAPH_ID, "Graph"), (FIRST_VISIT_ID, "FirstVisit")):
    if _id not in gymnasium.registry:
        gymnasium.register(
            _id,
            entry_point=f"graphdrl.environments:{_name}Env",
            vector_entry_point=f"graphdrl.environments:{_name}VectorEnv",
        )
