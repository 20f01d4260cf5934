"""Environments for Gymnasium; `import graphdrl` registers their names where Gymnasium is installed.

- `GraphDRL/Grid-v0`: the paper's decision process, directions on a grid.
- `GraphDRL/Graph-v0`: any graph, an action is a neighbour.
- `GraphDRL/FirstVisit-v0`: any graph, an action is a walk to an unvisited node.
- `GraphDRL/Unknown-v0`: any graph, not known beforehand, an action is a walk to a node that was seen.
"""

from __future__ import annotations

import inspect
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar

import gymnasium
import numpy as np
from gymnasium import spaces
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from . import _core
from ._core import Error
from .checks import LARGEST_INT, flag, listed, one_of, text, whole_number, wrong
from .world import Budget, Node, World, array_of, budget_text, flat_of

__all__ = [
    "FIRST_VISIT_ID",
    "GRAPH_ID",
    "GRID_ID",
    "UNKNOWN_ID",
    "FirstVisitEnv",
    "FirstVisitVectorEnv",
    "GraphEnv",
    "GraphVectorEnv",
    "GridEnv",
    "GridVectorEnv",
    "UnknownEnv",
    "UnknownVectorEnv",
]

GRID_ID = "GraphDRL/Grid-v0"
"""What `gymnasium.make` and `make_vec` know GridEnv and GridVectorEnv by."""
GRAPH_ID = "GraphDRL/Graph-v0"
"""What they know GraphEnv and GraphVectorEnv by."""
FIRST_VISIT_ID = "GraphDRL/FirstVisit-v0"
"""What they know FirstVisitEnv and FirstVisitVectorEnv by."""
UNKNOWN_ID = "GraphDRL/Unknown-v0"
"""What they know UnknownEnv and UnknownVectorEnv by."""

_REWARDS = ("visit_penalty", "coverage_gain")
_OBSERVATIONS = ("flat", "graph")
_RENDER_MODES = ("ansi", "rgb_array", "human")
_FRAMES_PER_SECOND = 8
_CELL_PIXELS = 24
_COLOURS = {"free": (255, 255, 255), "blocked": (60, 60, 70), "visited": (150, 200, 230), "current": (220, 90, 40)}


@dataclass(frozen=True)
class _Options:
    """What every environment takes. The classes of environments say what each option means."""

    map: str | World | None = None
    budget: Budget = "1.1x"
    reward: str = "visit_penalty"
    start: Node | None = None
    family: str | None = None
    size: int | None = None
    render_mode: str | None = None
    usual_size: ClassVar[int] = 20
    # Options of those on graphs.
    return_to_start = weighted = directed = False
    observation = "flat"
    # Of those on maps that are not known.
    reveal, score = "all", "visited"

    @cached_property
    def world(self) -> World | None:
        """The world of all episodes; None of random ones."""
        if self.family is not None:
            return None
        if isinstance(self.map, World):
            return self.map
        name = "paper:a" if self.map is None else self.map
        if not isinstance(name, str):
            raise wrong("map", "a World or the name of a map", name)
        return World.from_file(name)

    def for_core(self, count: int, restarts: bool) -> _core.EpisodesOptions:
        """The same, checked, for `count` episodes."""
        one_of(_REWARDS, self.reward, "reward")
        if self.render_mode is not None:
            one_of(_RENDER_MODES, self.render_mode, "render mode")
        one_of(_OBSERVATIONS, self.observation, "observation")
        if self.family is not None and self.map is not None:
            raise Error("bad map: expected a map or a family of random worlds, got both")
        weighted, directed = flag(self.weighted, "weighted"), flag(self.directed, "directed")
        if self.family is None:
            for name, given in (("size", self.size is not None), ("weighted", weighted), ("directed", directed)):
                if given:
                    raise Error(f"bad {name}: a map has its own: expected a family of random worlds with it")
        elif self.start is not None:
            raise Error("bad start: random worlds have none to choose")
        return _core.EpisodesOptions(
            world=None if self.world is None else self.world._core,
            family=self.family or "",
            size=whole_number(self.usual_size if self.size is None else self.size, "size", 1, LARGEST_INT),
            weighted=weighted,
            directed=directed,
            budget=budget_text(self.budget),
            start=-1 if self.start is None or self.world is None else self.world.number(self.start),
            coverage_gain=self.reward == "coverage_gain",
            return_to_start=flag(self.return_to_start, "return_to_start"),
            reveal=text(self.reveal, "reveal"),
            score=text(self.score, "score"),
            count=count,
            restarts=restarts,
        )

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

    def make(self, count: int, restarts: bool) -> _Kind:
        """The episodes, and their spaces."""
        raise NotImplementedError


@dataclass(frozen=True)
class GridOptions(_Options):
    """What GridEnv takes."""

    budget: Budget = 25
    usual_size: ClassVar[int] = 5

    def make(self, count: int, restarts: bool) -> _Kind:
        if self.family is not None and self.family not in _core.GRID_FAMILIES:
            raise wrong("family", ", ".join(_core.GRID_FAMILIES), self.family)
        episodes = _core.GridEpisodes(self.for_core(count, restarts))
        highest = np.resize(episodes.highest_features, episodes.observations.shape[1])
        return _Kind(self, episodes, spaces.Box(np.float32(0), highest, dtype=np.float32))


@dataclass(frozen=True)
class _OnGraphs(_Options):
    """What the environments on graphs take."""

    return_to_start: bool = False
    weighted: bool = False
    directed: bool = False
    observation: str = "flat"

    def kind(self, episodes: Any, low: float, high: float, node_features: int) -> _Kind:
        flat = spaces.Box(low, high, episodes.observations.shape[1:], np.float32)
        nodes = spaces.Box(low, high, (node_features,), np.float32)
        return _Kind(self, episodes, flat, spaces.Graph(nodes, spaces.Box(0, np.inf, (1,), np.float32)))


@dataclass(frozen=True)
class GraphOptions(_OnGraphs):
    """What GraphEnv takes."""

    max_neighbours: int | None = None

    def make(self, count: int, restarts: bool) -> _Kind:
        most = 0  # as many as the worlds need
        if self.max_neighbours is not None:
            most = whole_number(self.max_neighbours, "max_neighbours", 1, 1_000_000)
        episodes = _core.GraphEpisodes(self.for_core(count, restarts), most)
        return self.kind(episodes, 0, 1, _core.GRAPH_NODE_FEATURES)


@dataclass(frozen=True)
class FirstVisitOptions(_OnGraphs):
    """What FirstVisitEnv takes."""

    reward: str = "coverage_gain"
    max_visits: int = 16

    def make(self, count: int, restarts: bool) -> _Kind:
        most = whole_number(self.max_visits, "max_visits", 1, 96)
        episodes = _core.FirstVisitEpisodes(self.for_core(count, restarts), most)
        return self.kind(episodes, -16, 16, _core.EXPLORER_NODE_FEATURES)


@dataclass(frozen=True)
class UnknownOptions(_OnGraphs):
    """What UnknownEnv takes."""

    reward: str = "coverage_gain"
    reveal: str = "edges"
    score: str = "visited"
    max_visits: int = 16

    def make(self, count: int, restarts: bool) -> _Kind:
        most = whole_number(self.max_visits, "max_visits", 1, 1000)
        episodes = _core.UnknownEpisodes(self.for_core(count, restarts), most)
        return self.kind(episodes, 0, 1, _core.UNKNOWN_NODE_FEATURES)


class _Kind:
    """The episodes of an environment, and their spaces."""

    def __init__(self, options: _Options, episodes: Any, flat: spaces.Box, graph: spaces.Graph | None = None) -> None:
        self.options = options
        self.episodes = episodes
        self.observation_space = flat
        self.graph_space = graph
        self.action_space = spaces.Discrete(episodes.action_masks.shape[1])

    def seed(self, index: int, random: np.random.Generator) -> None:
        self.episodes.seed(index, int(random.integers(2**63)))

    def world(self, index: int) -> World:
        return World(self.episodes.world(index)) if self.options.world is None else self.options.world

    def told(self) -> dict[str, NDArray[Any]]:
        """What infos say, of all environments. Directions have neither masks nor targets."""
        told = {"visited": self.episodes.visited, "position": self.episodes.positions}
        if self.graph_space is not None:
            told |= {"action_mask": self.episodes.action_masks, "targets": self.episodes.targets}
        if isinstance(self.episodes, _core.UnknownEpisodes):
            told["seen"] = self.episodes.seen
        return told


class _WithOptions:
    """A class whose constructor takes options; `help` and the reference show them one by one."""

    _options: ClassVar[type[_Options]]
    _others: ClassVar[tuple[inspect.Parameter, ...]] = ()

    def __init_subclass__(cls, options: type[_Options] | None = None) -> None:
        super().__init_subclass__()
        if options is not None:
            cls._options = options
            parameters = [*cls._others, *inspect.signature(options, eval_str=True).parameters.values()]
            cls.__signature__ = inspect.Signature(sorted(parameters, key=lambda parameter: parameter.kind))


class _Env(_WithOptions, gymnasium.Env[Any, np.int64]):
    """What the single environments share."""

    metadata: ClassVar[dict[str, Any]] = {"render_modes": list(_RENDER_MODES), "render_fps": _FRAMES_PER_SECOND}

    def __init__(self, *args: Any, **named: Any) -> None:
        options = self._options(*args, **named)
        self._kind = options.make(count=1, restarts=False)
        self._as_graph = options.observation == "graph"
        self.observation_space = self._kind.graph_space if self._as_graph else self._kind.observation_space
        self.action_space = self._kind.action_space
        self.render_mode = options.render_mode
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
        start = self._kind.options.start_of(options, ("start",))
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


class _VectorEnv(_WithOptions, gymnasium.vector.VectorEnv[NDArray[np.float32], NDArray[np.int64], NDArray[Any]]):
    """What the vector environments share: all episodes are stepped by one call.

    Equal to SyncVectorEnv's, with the same seeds, step by step: an episode that is over begins anew with the next step.
    """

    metadata: ClassVar[dict[str, Any]] = {"render_modes": []}
    if hasattr(gymnasium.vector, "AutoresetMode"):  # from Gymnasium 1.1 on; before, there was no other
        metadata["autoreset_mode"] = gymnasium.vector.AutoresetMode.NEXT_STEP

    _others = (
        inspect.Parameter("num_envs", inspect.Parameter.POSITIONAL_OR_KEYWORD, default=1, annotation=int),
        inspect.Parameter("copy", inspect.Parameter.KEYWORD_ONLY, default=True, annotation=bool),
    )

    def __init__(self, num_envs: int = 1, *args: Any, copy: bool = True, **named: Any) -> None:
        options = self._options(*args, **named)
        for name, usual in (("observation", "flat"), ("render_mode", None)):
            if getattr(options, name) != usual:
                raise Error(
                    f"bad {name}: make_vec gives flat boxes and no pictures, single environments have them: "
                    "vectorization_mode='sync' takes them"
                )
        self.num_envs = whole_number(num_envs, "num_envs", 1, LARGEST_INT)
        self._copy = flag(copy, "copy")
        self._kind = kind = options.make(self.num_envs, restarts=True)
        self._begun = False
        self.single_observation_space = kind.observation_space
        self.single_action_space = kind.action_space
        self.observation_space = batch_space(kind.observation_space, self.num_envs)
        self.action_space = batch_space(kind.action_space, self.num_envs)
        self._all = np.ones(self.num_envs, bool)
        self._random: list[np.random.Generator | None] = [None] * self.num_envs
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
        start = self._kind.options.start_of(options, ("start", "reset_mask"))
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


class GridEnv(_Env, options=GridOptions):
    """One explorer on a grid map, as in the paper: visit as many cells as the budget allows. N: how many cells.

    Actions: 0 left, 1 up, 2 right, 3 down. A move into an obstacle or off the map costs a step and stays put.

    Observation: Box [7 N] of float32, the features of each cell [paper, section 2.1], one cell after the other by rows:
    row, column, obstacle, visits, wall, unvisited neighbours, current. `observation.reshape(-1, 7)` has a row per cell.

    Reward `visit_penalty` [paper, eq. 3]: 0.1 for a new cell, -0.1 times the visits before of another, -0.5 for a
    blocked move. Reward `coverage_gain` [paper, eq. 2]: the share of the free cells that a first visit adds.

    An episode is truncated where the budget is spent.

    Args:
        map: a World or the name of a map; by default `paper:a`.
        budget: steps, or a text as `"1.1x"`: times the number of free cells.
        reward: `visit_penalty` or `coverage_gain`.
        start: a cell; by default a random free one.
        family: of random worlds instead of `map`, a new one with every `reset`: a family of grids.
        size: of random worlds: cells a side, by default 5.
        render_mode: `ansi`, `rgb_array` or `human`.

    Raises:
        Error: a map that is no grid, a family of graphs, both a map and a family, a bad value of another option.
    """


class GridVectorEnv(_VectorEnv, options=GridOptions):
    """Many environments as GridEnv, with its options; `gymnasium.make_vec` makes it.

    All episodes are stepped by one call. Steps equal those of Gymnasium's SyncVectorEnv with the same seeds. Graphs and
    pictures are of single environments alone.

    Args:
        num_envs: V, how many.
        copy: if false, observations are one array that every step writes anew. All else is always a copy.
    """


class GraphEnv(_Env, options=GraphOptions):
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

    An episode terminates where nothing can be paid for, or everything is visited. The budget truncates none, for what
    is left of it is part of the observation. Where edges cost nothing, an episode is truncated after 10 N moves in a
    row that cost nothing and visit nothing new.

    Args:
        map: a World or the name of a map, grid or graph; by default `paper:a`.
        budget: in units of cost, or a text as `"1.1x"`: times the number of free nodes, in edges of mean cost.
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


class GraphVectorEnv(_VectorEnv, options=GraphOptions):
    """Many environments as GraphEnv, with its options and flat observations; `gymnasium.make_vec` makes it.

    All episodes are stepped by one call. Steps equal those of Gymnasium's SyncVectorEnv with the same seeds. Graphs and
    pictures are of single environments alone.

    Args:
        num_envs: V, how many.
        copy: if false, observations are one array that every step writes anew. All else is always a copy.
    """


class FirstVisitEnv(_Env, options=FirstVisitOptions):
    """One explorer on any graph, from first visit to first visit. A: actions.

    An action walks to an unvisited node next to visited ones, by the cheapest way through visited ground.

    Actions: the A nearest first visits, nearest first. A masked action leads nowhere. It costs an edge of mean cost and
    stays put; where that cannot be paid for, it ends the episode.

    Infos: `action_mask`, bool [A]; `targets`, int [A], the number of the node that each action leads to, -1 for
    nowhere.

    Observation `flat`: Box [12 A] of float32 from -16 to 16: of each action 1 where there is one, and what the explorer
    sees of it, 11 features (docs/explorer.md).

    Observation `graph`: spaces.Graph of the nodes around the current one, with what the explorer sees of each, [20];
    and edges both ways, with their cost in mean edges, [1]. `info["target_rows"]`, int [A]: the row of each action's
    target, -1 where there is none.

    Reward: the sum over the walk of GraphEnv's. An episode terminates where no first visit can be paid for.

    Args:
        map: a World or the name of a map, grid or graph; by default `paper:a`.
        budget: in units of cost, or a text as `"1.1x"`: times the number of free nodes, in edges of mean cost.
        reward: `visit_penalty` or `coverage_gain`.
        start: a node; by default a random free one.
        return_to_start: the walk must end where it began. First visits that make that too dear are left out.
        family: of random worlds instead of `map`, a new one with every `reset`.
        size: of random worlds: nodes of a graph, cells a side of a grid; by default 20.
        weighted: of random graphs: edges cost differently.
        directed: of random graphs: three edges in ten lead one way only.
        max_visits: A, 1 to 96.
        observation: `flat` or `graph`.
        render_mode: `ansi`, `rgb_array` or `human`.

    Raises:
        Error: both a map and a family, `max_visits` out of range, a bad value of another option.
    """


class FirstVisitVectorEnv(_VectorEnv, options=FirstVisitOptions):
    """Many environments as FirstVisitEnv, with its options and flat observations; `gymnasium.make_vec` makes it.

    All episodes are stepped by one call. Steps equal those of Gymnasium's SyncVectorEnv with the same seeds. Graphs and
    pictures are of single environments alone.

    Args:
        num_envs: V, how many.
        copy: if false, observations are one array that every step writes anew. All else is always a copy.
    """


class UnknownEnv(_Env, options=UnknownOptions):
    """One explorer on a map that it does not know, from first visit to first visit. A: actions, N: nodes seen.

    A visit shows what `reveal` says. An action walks to a node that was seen and not visited, by the cheapest way
    through visited ones. Where nodes seen count, ground is also every node whose edges are all known, and actions lead
    to the others.

    Nodes have numbers 0, 1, 2 … in the order in which they were seen, the start first. They say nothing of the world:
    where there are no cells, nodes seen at once are numbered by chance, anew in each episode. `world` and `walk` are
    those of the world itself, for whoever looks on.

    Actions: the A nearest first visits, nearest first. A masked action leads nowhere. It costs an edge of mean cost and
    stays put; where that cannot be paid for, it ends the episode.

    Infos: `seen`, how many nodes; `action_mask`, bool [A]; `targets`, int [A], the number of the node that each action
    leads to, which is its row in the graph, -1 for nowhere.

    Observation `flat`: Box [7 A + 2] of float32 from 0 to 1: of the node that each action leads to whether there is
    one, frontier (more edges may lead on), prize (in eight mean prizes), edges known and neighbours visited (both in
    eight), distance, first visits since it was seen last; the share of the budget that is left; what is left beyond the
    way to the end. Distances, in mean edges, and first visits are shown as x / (x + 8). Means are of what is known.

    Observation `graph`: spaces.Graph of a row [10] for each node seen: whether an action leads there, the six others
    after it, visited, current, budget left; and the edges known both ways, with their cost in mean edges, [1].

    Reward `coverage_gain`: the share of all nodes, or of all prizes, that the walk gains; where nodes seen count, of
    those it shows. Reward `visit_penalty`: the sum over the walk of GraphEnv's.

    An episode terminates where no first visit can be paid for.

    Args:
        map: a World or the name of a map, grid or graph; by default `paper:a`.
        budget: in units of cost, or a text as `"1.1x"`: times the number of free nodes, in edges of mean cost.
        reward: `visit_penalty` or `coverage_gain`.
        start: a node; by default a random free one.
        return_to_start: the walk must end where it began. First visits that make that too dear are left out.
        family: of random worlds instead of `map`, a new one with every `reset`.
        size: of random worlds: nodes of a graph, cells a side of a grid; by default 20.
        weighted: of random graphs: edges cost differently.
        directed: of random graphs: three edges in ten lead one way only.
        reveal: what a visit shows: `edges`, those of the node; `radius:R`, all within the cost R; `sight:R`, on grids,
            what straight lines of the length R meet.
        score: what counts, nodes `visited` or nodes `seen`.
        max_visits: A, 1 to 1000.
        observation: `flat` or `graph`.
        render_mode: `ansi`, `rgb_array` or `human`, of the whole map.

    Raises:
        Error: both a map and a family, sight without cells, `max_visits` out of range, a bad value of another option.
    """


class UnknownVectorEnv(_VectorEnv, options=UnknownOptions):
    """Many environments as UnknownEnv, with its options and flat observations; `gymnasium.make_vec` makes it.

    All episodes are stepped by one call. Steps equal those of Gymnasium's SyncVectorEnv with the same seeds. Graphs and
    pictures are of single environments alone.

    Args:
        num_envs: V, how many.
        copy: if false, observations are one array that every step writes anew. All else is always a copy.
    """


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
