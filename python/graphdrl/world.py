"""Worlds: graphs with costs, prizes and blocked nodes, made from what Python has."""

from __future__ import annotations

import os
import sys
import warnings
from collections.abc import Callable, Hashable, Iterable, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from ._core import Error
from .checks import (
    LARGEST_INT,
    flag,
    listed,
    number,
    path_text,
    shown,
    text,
    whole_number,
    wrong,
)

_NO_NODE = -1

Node = Hashable
Budget = float | int | str


def budget_text(budget: Budget) -> str:
    """As the command line takes it."""
    if isinstance(budget, str):
        return text(budget, "budget")
    try:
        return repr(float(budget))
    except (TypeError, ValueError, OverflowError) as error:
        raise wrong("budget", "a number from 0 up, or text like '1.1x'", budget) from error


def array_of(values: ArrayLike, dtype: type | None, name: str, kinds: str) -> NDArray[Any]:
    """The values as a contiguous array; `dtype`: None for their own; `kinds`: those that it may have had."""
    try:
        array = np.asarray(values)
    except ValueError as error:
        raise Error(f"bad {name}: expected an array of numbers") from error
    if array.size and array.dtype.kind not in kinds:
        expected = "numbers" if dtype is None else np.dtype(dtype).name
        raise Error(f"bad {name}: expected an array of {expected}, got {array.dtype}")
    return np.ascontiguousarray(array, dtype=dtype) if array.size else np.empty(array.shape, dtype)


def _cells(values: ArrayLike) -> NDArray[np.bool_]:
    """What is blocked on a grid."""
    array = array_of(values, None, "grid", "biuf")
    if array.dtype.kind != "b":
        strange = array[(array != 0) & (array != 1)]
        if strange.size:
            expected = f"expected 0 (free) or 1 (blocked), got {strange.flat[0]}"
            raise Error(f"bad cell of a grid: {expected}; for ROS maps see World.from_file")
    return np.ascontiguousarray(array, bool)


def flat_of(values: ArrayLike | None, dtype: type, name: str, kinds: str, count: int) -> NDArray[Any]:
    """The same, with one value of each of so many; none without values."""
    if values is None:
        return np.empty(0, dtype)
    array = array_of(values, dtype, name, kinds)
    if array.shape != (count,):
        raise Error(f"bad shape of {name}: expected ({count},), got {array.shape}")
    return array


class Edges(NamedTuple):
    """All edges of a world, E of them."""

    ends: NDArray[np.int64]
    """Numbers of nodes, shape [E, 2]."""
    costs: NDArray[np.float64]
    """Shape [E]."""
    labels: list[str]
    """What they are called; empty where no edge has a label."""
    prizes: NDArray[np.float64]
    """What walking one for the first time is worth, shape [E]; empty where that is 1."""
    both_ways: list[bool]
    """Of a directed world, which ones lead back, too, and count as one all the same; empty where none does."""


class World:
    """A graph that can be walked. Immutable, so any number of plans and threads may share one.

    Nodes are what the caller calls them: any hashable label of a graph, `(row, column)` on a grid, else numbers from 0
    up. The arrays here go by number, in the order of `nodes`.
    """

    __slots__ = ("_core", "_labels", "_numbers")

    def __init__(self, core: _core.World, labels: Sequence[Node] | None = None) -> None:
        """Use `World.from_…()` instead."""
        if not isinstance(core, _core.World):
            raise TypeError("a World is made by World.from_grid(), from_networkx(), from_edges(), from_file() …")
        self._core = core
        self._labels = list(labels) if labels is not None else None
        self._numbers: dict[Node, int] | None = None
        if self._labels is not None:
            try:
                self._numbers = {label: number for number, label in enumerate(self._labels)}
            except TypeError as error:
                raise Error(f"bad label: {error}") from error
            if len(self._numbers) != core.node_count:
                raise Error("bad labels: expected as many different ones as nodes")

    @classmethod
    def from_grid(
        cls,
        cells: ArrayLike | str | Iterable[str],
        *,
        diagonals: bool = False,
        cut_corners: bool = False,
        cell_size: float | None = None,
        origin: tuple[float, float] = (0.0, 0.0),
        unit: str = "m",
        name: str = "grid",
    ) -> World:
        """A grid of cells. Steps lead left, up, right and down, at a cost of 1.

        Args:
            cells: an array [rows, columns], true or 1 where blocked, false or 0 where free; or text, `#` blocked and
                `.` free. Row 0 is the upper one.
            diagonals: steps lead to eight cells; a diagonal one costs √2.
            cut_corners: diagonal steps may pass blocked cells.
            cell_size: the side of a cell in `unit`: places the grid in the plane.
            origin: x and y of the grid's lower left corner, in `unit`.
            unit: of `cell_size` and `origin`.
            name: of the world.

        Raises:
            Error: rows of different lengths, characters other than `#` and `.`, numbers other than 0 and 1, no free
                cell.
        """
        if isinstance(cells, str):
            cells = cells.split("\n")
        if isinstance(cells, (list, tuple)) and cells and all(isinstance(row, str) for row in cells):
            rows = [row.strip() for row in cells if row.strip()]
            if {len(row) for row in rows} != {len(rows[0]) if rows else 0}:
                raise Error("bad grid: expected rows of one length")
            strange = {char for row in rows for char in row} - set("#.")
            if strange:
                raise Error(f"bad grid: expected '#' and '.', got {min(strange)!r}")
            cells = [[char == "#" for char in row] for row in rows]
        array = _cells(cells)
        if array.ndim != 2:
            raise Error(f"bad shape of a grid: expected two dimensions, got {array.ndim}")
        frame = None
        if cell_size is not None:
            corner = [number(x, "origin") for x in listed(origin, "origin", "x and y")]
            if len(corner) != 2:
                raise wrong("origin", "x and y", origin)
            frame = (number(cell_size, "cell_size"), *corner, 0.0, text(unit, "unit"))
        core = _core.World.grid(
            text(name, "name"), array, flag(diagonals, "diagonals"), flag(cut_corners, "cut_corners"), frame
        )
        return cls(core)

    @classmethod
    def from_edges(
        cls,
        edges: ArrayLike,
        costs: ArrayLike | None = None,
        *,
        node_count: int | None = None,
        directed: bool = False,
        blocked: ArrayLike | None = None,
        prizes: ArrayLike | None = None,
        places: ArrayLike | None = None,
        unit: str = "",
        labels: Sequence[Node] | None = None,
        edge_prizes: ArrayLike | None = None,
        name: str = "graph",
    ) -> World:
        """A graph from arrays.

        Args:
            edges: [E, 2], numbers of nodes. Loops and parallel edges are there where edges count; walks over nodes do
                without.
            costs: [E], from 0 up; 1 each by default.
            node_count: N; by default the number of labels, or one more than the largest node of an edge.
            directed: edges lead one way, from the first node to the second.
            blocked: [N], true where no walk may go.
            prizes: [N], from 0 up, what the first visit of each node is worth; 1 each by default.
            places: [N, 2], x to the right and y upward, in `unit`; for pictures and files.
            unit: of `places`: `degrees` for longitude and latitude.
            labels: N different hashable values; by default the nodes are called by their numbers.
            edge_prizes: [E], from 0 up, what walking each edge for the first time is worth, where edges count; 1 each
                by default.
            name: of the world.

        Raises:
            Error: an array of another shape or type, a node out of range, a cost or prize below 0.
        """
        ends = array_of(edges, np.int64, "edges", "iu")
        if ends.size == 0:
            ends = np.empty((0, 2), np.int64)
        if ends.ndim != 2 or ends.shape[1] != 2:
            raise Error(f"bad shape of edges: expected (E, 2), got {ends.shape}")
        if labels is not None:
            labels = listed(labels.tolist() if isinstance(labels, np.ndarray) else labels, "labels", "one of each node")
        if node_count is not None:
            node_count = whole_number(node_count, "node_count", 0, LARGEST_INT)
        else:
            node_count = len(labels) if labels is not None else int(ends.max(initial=-1)) + 1
        points = np.empty((0, 2))
        if places is not None:
            points = array_of(places, np.float64, "places", "fiu")
            if points.shape != (node_count, 2):
                raise Error(f"bad shape of places: expected ({node_count}, 2), got {points.shape}")
        core = _core.World.graph(
            text(name, "name"),
            node_count,
            ends,
            flat_of(costs, np.float64, "costs", "fiu", len(ends)),
            flag(directed, "directed"),
            flat_of(blocked, bool, "blocked", "biu", node_count),
            _texts(labels),
            flat_of(prizes, np.float64, "prizes", "fiu", node_count),
            points,
            text(unit, "unit"),
            (None, _NO_NODE, _NO_NODE),
            [],
            flat_of(edge_prizes, np.float64, "edge_prizes", "fiu", len(ends)),
            [],
        )
        return cls(core, labels)

    @classmethod
    def from_networkx(
        cls,
        graph: Any,
        *,
        cost: str | None = None,
        prize: str | None = None,
        blocked: str = "blocked",
        name: str | None = None,
    ) -> World:
        """A graph of networkx, of any of its four classes. The world does not change with it afterwards.

        Coordinates are the nodes' `pos`, or `x` and `y`, or `lon` and `lat`, or `longitude` and `latitude`, where all
        nodes have them; else they are left out, with a warning. Loops and parallel edges are those of `from_edges`.

        Args:
            graph: its nodes become the world's labels.
            cost: the edges' attribute; by default, as of files, the first of `weight`, `cost`, `length` and `distance`
                that an edge has. An edge without it costs 1; with `"none"` every edge does.
            prize: the nodes' attribute; by default `prize` or `score`. A node without it is worth 1; with `"none"`
                every node is. Edges are worth their `prize`, where they count.
            blocked: the nodes' attribute for obstacles.
            name: of the world; by default the graph's.

        Raises:
            Error: a cost, prize or coordinate that is no number, a cost or prize below 0; a `cost` that no edge has, a
                `prize` that no node has.
        """
        if not all(hasattr(graph, part) for part in ("nodes", "edges", "is_directed")):
            raise wrong("graph", "a graph of networkx", graph)
        labels = list(graph.nodes)
        numbers = {label: number for number, label in enumerate(labels)}
        links = list(graph.edges(data=True))
        data = [graph.nodes[label] for label in labels]
        of_edges = [of_edge for _, _, of_edge in links]
        costs = _amounts(cost, _core.COST_NAMES, of_edges, "cost", "edge")
        prizes = _amounts(prize, _core.PRIZE_NAMES, data, "prize", "node")
        edge_prizes = _amounts(None, _core.EDGE_PRIZE_NAMES, of_edges, "prize", "edge")
        text(blocked, "blocked")
        places, unit = _places_of(data)
        return cls.from_edges(
            [(numbers[a], numbers[b]) for a, b, _ in links],
            costs,
            node_count=len(labels),
            directed=graph.is_directed(),
            blocked=[_is_blocked(of_node.get(blocked, False), blocked) for of_node in data],
            prizes=prizes,
            places=places,
            unit=unit,
            labels=None if labels == list(range(len(labels))) and all(type(x) is int for x in labels) else labels,
            edge_prizes=edge_prizes,
            name=str(graph.name or "graph") if name is None else name,
        )

    @classmethod
    def from_scipy(cls, matrix: Any, *, directed: bool = True, name: str = "graph") -> World:
        """A graph from a sparse matrix of SciPy: an edge for every entry, which is its cost.

        Args:
            matrix: [N, N], row to column.
            directed: edges lead one way. If not, an entry above or below the diagonal is enough.
            name: of the world.

        Raises:
            Error: a matrix that is not square, an entry below 0.
        """
        if not hasattr(matrix, "tocoo"):
            raise wrong("matrix", "a sparse matrix of SciPy", matrix)
        entries = matrix.tocoo()
        if entries.ndim != 2 or entries.shape[0] != entries.shape[1]:
            raise Error(f"bad shape of a matrix: expected a square one, got {entries.shape}")
        ends = np.stack([entries.row, entries.col], axis=1)
        return cls.from_edges(ends, entries.data, node_count=entries.shape[0], directed=directed, name=name)

    @classmethod
    def from_file(
        cls,
        path: str | os.PathLike[str],
        *,
        cost_attribute: str = "",
        prize_attribute: str = "",
        cell_pixels: int = 1,
        unknown_is_free: bool = False,
        robot_radius: float = 0.0,
        cell_size: float | None = None,
        connectivity: int = 4,
        cut_corners: bool = False,
    ) -> World:
        """A map from a file in any format of `graphdrl maps convert --help`. What was left out comes as a warning.

        Args:
            path: the file, or `paper:a` to `paper:j`, the paper's maps.
            cost_attribute: of graphs: the edges' attribute that is their cost; `"none"`: each costs 1.
            prize_attribute: of graphs: the nodes' attribute that is their prize; `"none"`: each is worth 1.
            cell_pixels: of pictures: pixels a side of a cell.
            unknown_is_free: of ROS maps: walks may pass unknown cells.
            robot_radius: of grids: obstacles grow by this, in the map's unit, or in cells where it has none.
            cell_size: of grids that say how large their cells are: larger cells, free where all they cover is; in the
                map's unit.
            connectivity: of grids: 4 or 8 neighbours of a cell.
            cut_corners: with 8 neighbours: diagonal steps may pass blocked cells.

        Raises:
            Error: no such file, a format that is not known, a mistake in it, with file and place.
        """
        core = _core.World.from_file(
            path_text(path),
            text(cost_attribute, "cost_attribute"),
            text(prize_attribute, "prize_attribute"),
            whole_number(cell_pixels, "cell_pixels", 1, LARGEST_INT),
            flag(unknown_is_free, "unknown_is_free"),
            number(robot_radius, "robot_radius"),
            None if cell_size is None else number(cell_size, "cell_size"),
            whole_number(connectivity, "connectivity", 4, 8),
            flag(cut_corners, "cut_corners"),
            _warn,
        )
        return cls(core, core.labels or None)

    @classmethod
    def random(
        cls,
        family: str,
        size: int,
        seed: int = 0,
        *,
        weighted: bool = False,
        directed: bool = False,
        blocked: float | None = None,
    ) -> World:
        """A connected random world, as `graphdrl maps generate`. The same arguments give the same world.

        Args:
            family: one of `graphdrl.FAMILIES`.
            size: cells a side of a grid, else nodes.
            seed: from 0 up.
            weighted: of graphs: edges cost differently.
            directed: of graphs: three edges in ten lead one way only.
            blocked: of `obstacles`: the probability of a blocked cell, 0 to 0.9, instead of a drawn one.

        Raises:
            Error: no such family; a size, costs or directions that the family does not have.
        """
        core = _core.World.random(
            text(family, "family"),
            whole_number(size, "size", 1, LARGEST_INT),
            whole_number(seed, "seed"),
            flag(weighted, "weighted"),
            flag(directed, "directed"),
            None if blocked is None else number(blocked, "blocked"),
        )
        return cls(core)

    @property
    def name(self) -> str:
        """What it is called in errors, tables and pictures."""
        return self._core.name

    @property
    def is_grid(self) -> bool:
        """Whether it has cells."""
        return self._core.grid_state is not None

    @property
    def shape(self) -> tuple[int, int] | None:
        """Rows and columns of a grid; None of a graph."""
        grid = self._core.grid_state
        return None if grid is None else (grid[0], grid[1])

    @property
    def node_count(self) -> int:
        """How many nodes there are, blocked ones included."""
        return self._core.node_count

    @property
    def edge_count(self) -> int:
        """How many edges there are, those of blocked nodes included."""
        return self._core.edge_count

    @property
    def valid_count(self) -> int:
        """How many nodes are not blocked."""
        return self._core.valid_count

    @property
    def directed(self) -> bool:
        """Whether edges lead one way."""
        return self._core.directed

    @property
    def weighted(self) -> bool:
        """Whether some edge costs other than 1."""
        return self._core.weighted

    @property
    def total_prize(self) -> float:
        """The prizes of all nodes that are not blocked; their number where there are no prizes."""
        return self._core.total_prize

    @property
    def nodes(self) -> list[Node]:
        """What the nodes are called, in the order of their numbers."""
        return self.names(range(self.node_count))

    @property
    def blocked(self) -> NDArray[np.bool_]:
        """Where no walk may go. Shape [N]; [rows, columns] on a grid."""
        flags = self._core.blocked.view(np.bool_)
        return flags if self.shape is None else flags.reshape(self.shape)

    @property
    def prizes(self) -> NDArray[np.float64]:
        """What the first visit of each node is worth. Shape [N]."""
        prizes = self._core.prizes
        return prizes if len(prizes) else np.ones(self.node_count)

    @property
    def places(self) -> NDArray[np.float64] | None:
        """Coordinates, x to the right and y upward; None where they are not known. Shape [N, 2]."""
        places = self._core.places
        return places.reshape(-1, 2) if len(places) else None

    def edges(self) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
        """The edges and their costs.

        Returns:
            Numbers of nodes, an undirected edge once, from its lower node, shape [E, 2]; and costs, shape [E].
        """
        ends, costs = self._core.edges
        return ends.reshape(-1, 2), costs

    def all_edges(self) -> Edges:
        """All edges, loops and parallel ones too, by the numbers that `Plan.walk_edges` has."""
        ends, costs = self._core.all_edges
        core = self._core
        return Edges(ends.reshape(-1, 2), costs, core.edge_labels, core.edge_prizes, core.both_ways)

    def names(self, numbers: Iterable[int]) -> list[Node]:
        """What nodes are called, by their numbers: labels, `(row, column)` on a grid, else the numbers.

        Args:
            numbers: of nodes, from 0 up.

        Raises:
            Error: no such node.
        """
        last = self.node_count - 1
        given = listed(numbers, "numbers", "numbers of nodes")
        checked = [whole_number(node, "number of a node", 0, last) for node in given]
        if self._labels is not None:
            return [self._labels[node] for node in checked]
        if self.shape is not None:
            columns = self.shape[1]
            return [divmod(node, columns) for node in checked]
        return checked

    def number(self, node: Node) -> int:
        """The number of a node.

        Args:
            node: as the world calls it. A grid knows its cells by number, too.

        Raises:
            Error: no such node.
        """
        if self._numbers is not None:
            try:
                found = self._numbers.get(node)
            except TypeError:
                found = None
            if found is not None:
                return found
        elif isinstance(node, (int, np.integer)) and not isinstance(node, bool):
            if 0 <= node < self.node_count:
                return int(node)
        elif self.shape is not None and isinstance(node, (tuple, list, np.ndarray)) and len(node) == 2:
            row, column = node
            if all(isinstance(x, (int, np.integer)) for x in node):
                if 0 <= row < self.shape[0] and 0 <= column < self.shape[1]:
                    return int(row) * self.shape[1] + int(column)
        raise Error(f"{self.name}: no such node: {shown(node)}")

    def state(self, walk: Iterable[Node], budget: Budget, end: Node | None = None) -> _core.State:
        """What a policy sees after a walk: a State that lasts.

        Args:
            walk: nodes, the start first. On a grid a repeated cell is a blocked move.
            budget: of the whole walk.
            end: where the walk must end; None for anywhere.

        Raises:
            Error: a walk that cannot be walked, or costs more than the budget.
        """
        nodes = np.array([self.number(node) for node in listed(walk, "walk", "nodes")], np.int64)
        return _core.State(self._core, nodes, budget_text(budget), None if end is None else self.number(end))

    def to_networkx(self) -> Any:
        """A Graph or DiGraph of networkx. Edges have `cost`; nodes have `prize`, `blocked` and, if known, `pos`."""
        import networkx

        graph = networkx.DiGraph() if self.directed else networkx.Graph()
        names = self.nodes
        prizes, blocked, places = self.prizes, self.blocked.ravel(), self.places
        for number, label in enumerate(names):
            data: dict[str, Any] = {"prize": float(prizes[number]), "blocked": bool(blocked[number])}
            if places is not None:
                data["pos"] = (float(places[number][0]), float(places[number][1]))
            graph.add_node(label, **data)
        ends, costs = self.edges()
        for (a, b), cost in zip(ends.tolist(), costs.tolist(), strict=True):
            graph.add_edge(names[a], names[b], cost=cost)
        return graph

    def to_scipy(self) -> Any:
        """The costs as a sparse matrix (CSR), both ways where edges lead both ways. Shape [N, N]."""
        import scipy.sparse

        ends, costs = self.edges()
        rows, columns = ends[:, 0], ends[:, 1]
        if not self.directed:
            rows, columns = np.concatenate([rows, columns]), np.concatenate([columns, rows])
            costs = np.concatenate([costs, costs])
        return scipy.sparse.csr_array((costs, (rows, columns)), shape=(self.node_count, self.node_count))

    def __repr__(self) -> str:
        size = f"{self.shape[0]}x{self.shape[1]} cells" if self.shape else f"{self.node_count} nodes"
        return f"<World {self.name}: {size}, {self.valid_count} free, {self.edge_count} edges>"

    def _repr_svg_(self) -> str:
        return self._core.svg()

    def __reduce__(self) -> tuple[Any, ...]:
        core = self._core
        if core.complete:
            raise Error(f"{self.name}: a complete graph of a file is not pickled: read the file again")
        grid = core.grid_state
        if grid is not None:
            _, _, diagonals, cut_corners, frame = grid
            return _restore_grid, (core.name, np.array(self.blocked), diagonals, cut_corners, frame)
        ends, costs, edge_labels, edge_prizes, both_ways = self.all_edges()
        state = (
            core.name, core.node_count, ends, costs, core.directed, self.blocked, core.labels, core.prizes,
            core.places.reshape(-1, 2), core.unit, core.given, edge_labels,
            edge_prizes, both_ways,
        )  # fmt: skip
        return _restore_graph, (state, self._labels)

    def __copy__(self) -> World:
        return self

    def __deepcopy__(self, memo: dict[int, Any]) -> World:
        return self


def _restore_grid(name: str, blocked: NDArray[np.bool_], diagonals: bool, cut_corners: bool, frame: Any) -> World:
    return World(_core.World.grid(name, blocked, diagonals, cut_corners, frame))


def _restore_graph(state: tuple[Any, ...], labels: Sequence[Node] | None) -> World:
    return World(_core.World.graph(*state), labels)


def _warn(text: str) -> None:
    caller, level = sys._getframe(), 1
    while caller.f_back is not None and caller.f_globals.get("__name__", "").startswith("graphdrl"):
        caller, level = caller.f_back, level + 1
    warnings.warn(text, stacklevel=level)


def _texts(labels: Sequence[Node] | None) -> list[str]:
    """The labels as texts, for pictures and files; none where they would not tell nodes apart."""
    texts = [str(label) for label in labels or ()]
    return [text(label, "label") for label in texts] if all(texts) and len(set(texts)) == len(texts) else []


def _spellings(usual: Sequence[str], data: Sequence[dict[str, Any]]) -> list[str]:
    """The attributes with the usual names, the best first; case does not count."""
    met = sorted({key for of_one in data for key in of_one if isinstance(key, str)})
    return [key for name in usual for key in met if key.lower() == name]


def _amounts(
    name: str | None, usual: Sequence[str], data: Sequence[dict[str, Any]], role: str, owner: str
) -> list[float] | None:
    """What each edge costs or each node is worth: by the attribute named, or its best usual one; None for 1 each."""
    if name is None:
        names = _spellings(usual, data)
    elif text(name, role) == "none" or not data:
        names = []
    elif any(name in of_one for of_one in data):
        names = [name]
    else:
        raise Error(f"bad {role}: no {owner} has this attribute: {shown(name)}")
    chosen = [next((key for key in names if key in of_one), None) for of_one in data]
    used = [key for key in names if key in chosen]
    if len(used) > 1:
        _warn(f"{role}s come from {' and '.join(used)}")
    if not used:
        return None
    return [1.0 if key is None else number(of_one[key], key) for of_one, key in zip(data, chosen, strict=True)]


def _is_blocked(value: Any, name: str) -> bool:
    if isinstance(value, str):
        raise wrong(name, "True or False", value)
    return bool(value)


def _places_of(data: Sequence[dict[str, Any]]) -> tuple[NDArray[np.float64] | None, str]:
    """Coordinates where every node has some, and their unit. Warns of those that are left out."""
    why = None
    having = [of_node["pos"] for of_node in data if "pos" in of_node]
    if len(having) == len(data):
        strange = [pair for pair in having if not _is_pair(pair)]
        if having and not strange:
            return np.array([[number(x, "pos") for x in pair] for pair in having]), ""
        why = f"a node's pos is not x and y: {shown(strange[0])}" if strange else None
    elif having:
        why = f"pos is on {len(having)} of {len(data)} nodes"
    for *pair, unit in _core.PLACE_NAMES:
        x, y = ((_spellings([name], data) or [name])[0] for name in pair)
        count = sum(x in of_node and y in of_node for of_node in data)
        if data and count == len(data):
            return np.array([[number(of_node[x], x), number(of_node[y], y)] for of_node in data]), unit
        if count:
            why = why or f"{x} and {y} are on {count} of {len(data)} nodes"
    if why is not None:
        _warn(f"the coordinates are left out: {why}")
    return None, ""


def _is_pair(value: Any) -> bool:
    try:
        return not isinstance(value, str) and len(value) == 2
    except TypeError:
        return False


OnProgress = Callable[[int, float], None]
