"""Plans, bounds and comparisons of policies."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _core
from ._core import Error
from .checks import flag, function, listed, number, path_text, shown, text, whole_number, wrong
from .policies import Policy
from .world import Budget, Node, OnProgress, World, budget_text

OwnPolicy = Callable[[_core.State], int | None]


class Plan:
    """One walk, and how far from the best it may be. `plan` and `explore` make it; it does not change."""

    __slots__ = ("_core", "world")

    def __init__(self, world: World, core: _core.Answer) -> None:
        self.world = world
        self._core = core

    @property
    def walk(self) -> list[Node]:
        """Every position, the start first, as the world calls the nodes."""
        return self.world.names(self.nodes)

    @property
    def nodes(self) -> NDArray[np.int32]:
        """The walk as numbers of nodes. Shape [steps + 1]."""
        return self._core.walk

    @property
    def costs(self) -> NDArray[np.float64]:
        """What is spent at each position, in units of cost. Shape [steps + 1]."""
        return self._core.costs

    @property
    def visited(self) -> int:
        """How many different nodes the walk visits, the start included."""
        return self._core.visited

    @property
    def coverage(self) -> float:
        """The share of the free nodes that is visited, 0 to 1 [paper, eq. 1]."""
        return self.visited / self.world.valid_count

    @property
    def prize(self) -> float:
        """The sum of the prizes of the nodes visited, or seen where those count; their number without prizes."""
        return self._core.prize

    @property
    def cost(self) -> float:
        """What the walk costs, in units of cost."""
        return self._core.cost

    @property
    def budget(self) -> float:
        """What it could have cost, in units of cost."""
        return self._core.budget

    @property
    def bound(self) -> float:
        """No walk within the budget has a higher prize, knowing the map (docs/search.md, "Bounds").

        Infinite where nodes seen count.
        """
        return self._core.bound

    @property
    def optimal(self) -> bool:
        """Whether it is proved that no walk has a higher prize than this one."""
        return self._core.optimal

    @property
    def walk_edges(self) -> list[int | None] | None:
        """The edges walked, where edges count; None for a reset, and where nodes count.

        Numbers are those of `World.all_edges`. `walk`, `nodes` and `costs` leave out loops then.
        """
        edges = self._core.walk_edges
        return None if edges is None else [None if edge < 0 else edge for edge in edges]

    @property
    def edges_walked(self) -> int | None:
        """How many different edges were walked, where edges count; else None."""
        return self._core.edges_walked

    @property
    def edge_count(self) -> int | None:
        """How many edges there are, where edges count; else None."""
        return self._core.edge_count

    @property
    def edge_prize(self) -> float | None:
        """What the edges walked are worth, where edges count, by their prizes or 1 each; else None."""
        return self._core.edge_prize

    @property
    def edge_bound(self) -> float | None:
        """No walk within the budget has a higher `edge_prize`, where edges count; else None."""
        return self._core.edge_bound

    @property
    def seen(self) -> list[Node] | None:
        """The nodes seen, as the world calls them, in the order in which they were seen; None where the map was known.

        A policy knew `seen[n]` by the number n.
        """
        return None if self._core.seen is None else self.world.names(self._core.seen)

    @property
    def seen_after_step(self) -> NDArray[np.int32] | None:
        """How many nodes were seen at each position of the walk; None where the map was known. Shape [steps + 1]."""
        return self._core.seen_after_step

    @property
    def policy(self) -> str:
        """The name of the policy that made it."""
        return self._core.policy

    @property
    def elapsed_s(self) -> float:
        """Seconds that the plan and its bound took."""
        return self._core.elapsed_s

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the plan in the format of the ending, as `graphdrl plan --out`.

        Args:
            path: ends with .json, .csv, .graphml, .dot, .geojson, .yaml, .anim.svg, .svg, .png or .html.

        Raises:
            Error: an ending that is not known, or needs coordinates that the world lacks; a file that cannot be
                written.
        """
        self._core.save(path_text(path))

    def to_json(self) -> str:
        """The document that `graphdrl plan --json` or `graphdrl explore --json` prints."""
        return self._core.json()

    def to_dict(self) -> dict[str, Any]:
        """The same document as a dictionary."""
        return json.loads(self.to_json())

    def _repr_svg_(self) -> str:
        return self._core.svg()

    def __repr__(self) -> str:
        return "\n".join([f"<Plan {self.world.name}, {self.policy}>", *self._core.summary])

    def __reduce__(self) -> tuple[Any, ...]:
        return _restore, (self.world, self.nodes, self._core.claims)

    def __copy__(self) -> Plan:
        return self

    def __deepcopy__(self, memo: dict[int, Any]) -> Plan:
        return self


def _restore(world: World, walk: NDArray[np.int32], claims: tuple[Any, ...]) -> Plan:
    return Plan(world, _core.Answer.restore(world._core, walk, claims))


def _end(world: World, end: Node | None) -> int | str | None:
    """An end as a number or a word. "start" and "anywhere" are words, whatever nodes are called; "#N" is node N."""
    if end is None or (isinstance(end, str) and (end in ("start", "anywhere") or end.startswith("#"))):
        return end
    return world.number(end)


def _end_text(worlds: list[World], end: Node | None) -> str:
    """The end of walks in all worlds, as the command line takes it."""
    if end is None:
        return ""
    if isinstance(end, str) and any(world._numbers is None or end not in world._numbers for world in worlds):
        return text(end, "end")
    ends = {_end(world, end) for world in worlds}
    if len(ends) == 1:
        only = ends.pop()
        return only if isinstance(only, str) else f"#{only}"
    if isinstance(end, str):
        return text(end, "end")
    if isinstance(end, (tuple, list)) and all(world.is_grid for world in worlds):
        return ",".join(str(int(x)) for x in end)
    raise wrong("end", "a text, or a node of the same number in all worlds", end)


def _require_world(world: World) -> World:
    if not isinstance(world, World):
        raise Error(f"expected a World, got {shown(world)}: World.from_file(), from_networkx() … make one")
    return world


def _asked(world: World, budget: Budget | None, start: Node | None, end: Node | None) -> tuple[Any, ...]:
    """What _core makes a task of. None is what the world's file says, else the default."""
    return (
        _require_world(world)._core,
        None if budget is None else budget_text(budget),
        None if start is None else world.number(start),
        _end(world, end),
    )


def _seconds(time_limit: float | None) -> float | None:
    return None if time_limit is None else number(time_limit, "time limit")


def _think_time(seconds: float | None) -> float | None:
    if seconds is None:
        return None
    value = number(seconds, "think time")
    if not value > 0:
        raise wrong("think time", "seconds above 0", seconds)
    return value


def _covered(cover: str, reset_cost: float | None) -> tuple[str, float | None]:
    cost = None if reset_cost is None else number(reset_cost, "reset_cost")
    if cost is not None and not cost >= 0:
        raise wrong("reset_cost", "a cost of at least 0", reset_cost)
    return text(cover, "cover"), cost


def policy_of(policy: str | Policy | OwnPolicy) -> tuple[str, Any]:
    """What a policy is called, and what it is unless it is known by that name."""
    if isinstance(policy, str):
        return text(policy, "policy"), None
    if isinstance(policy, Policy):
        return policy.name, policy._core
    if callable(policy):
        return getattr(policy, "__name__", type(policy).__name__), policy
    raise wrong("policy", "a name, a Policy or a callable", policy)


def plan(
    world: World,
    budget: Budget | None = None,
    start: Node | None = None,
    end: Node | None = None,
    policy: str | Policy | OwnPolicy = "search",
    *,
    cover: str = "nodes",
    reset_cost: float | None = None,
    time_limit: float | None = None,
    seed: int = 1,
    on_progress: OnProgress | None = None,
) -> Plan:
    """Plans one walk that visits as much as it can within the budget. Source: docs/search.md.

    Other threads go on meanwhile, with plans of their own. Ctrl-C ends it.

    Args:
        world: where to walk.
        budget: in units of cost, or a text as `"1.1x"`; None for that of the world's file.
        start: a node; by default the file's, else the first free one.
        end: a node, or one of the words `"start"` and `"anywhere"`, also where a node is called so: `"#N"` is then the
            node of number N. By default the file's, else anywhere.
        policy: a name as of `graphdrl plan --policy`, a Policy, or a callable as `evaluate` takes.
        cover: what counts, `nodes` or `edges`, loops and parallel ones too; edges without a budget: all of them.
        reset_cost: of `edges` that lead one way: what a jump back to the start costs; None where there is none.
        time_limit: seconds for all of it. Without one, the same arguments give the same walk.
        seed: of the search, and of random policies.
        on_progress: called now and then with the nodes visited, by the walk under way or by the best so far, and the
            bound. Its answer is ignored.

    Raises:
        Error: a blocked or missing node, a bad budget or policy, an end out of reach. What `on_progress` and a policy
            of your own raise comes out as it is.
    """
    name, own = policy_of(policy)
    report = _core.plan(
        *_asked(world, budget, start, end), name, own, _seconds(time_limit), whole_number(seed, "seed"),
        function(on_progress, "on_progress"), *_covered(cover, reset_cost),
    )  # fmt: skip
    return Plan(world, report)


def explore(
    world: World,
    budget: Budget | None = None,
    start: Node | None = None,
    end: Node | None = None,
    policy: str | Policy | OwnPolicy | None = None,
    *,
    cover: str = "nodes",
    reset_cost: float | None = None,
    reveal: str = "edges",
    score: str = "visited",
    believed: World | None = None,
    until_covered: bool = False,
    think_time: float | None = None,
    time_limit: float | None = None,
    seed: int = 1,
    on_progress: OnProgress | None = None,
) -> Plan:
    """Explores a world that is not known beforehand: the policy chooses by what was seen so far.

    The walk is that of `graphdrl explore` with the same options. A policy of your own gets a State of what is known:
    nodes have numbers 0, 1, 2 … in the order in which they were seen, the start first, and arrays of N values have one
    for each node seen. `state.edges`, `edge_costs`, `frontier`, `seen_at`, `prizes` and `places` say the rest of what
    is known. Numbers of nodes say nothing of the world's own.

    Args:
        world: where to walk.
        budget: as of `plan`. A multiple is of all free nodes, seen or not.
        start: as of `plan`.
        end: as of `plan`. A walk that must end at a node keeps the way back to its start, until it has seen that node
            and can pay for the way there.
        policy: as of `plan`; by default `search:10000` with `believed`, `tour` with the score `seen` on cells within a
            radius or in sight, else `explorer`, the one for unknown maps. Policies that plan, and an Explorer of known
            maps, do so on what is known, anew with each discovery.
        cover: as of `plan`. Where edges count, visits show edges; policies are those of `LiveExploration`, which are
            none of your own, and the walk ends anywhere or at its start.
        reset_cost: as of `plan`.
        reveal: what a visit shows. `edges`: those of the node, and where they lead; `radius:R`: all within the cost R;
            `sight:R`, on grids: what straight lines of the length R meet; `all`: the whole map.
        score: what counts, nodes `visited` or nodes `seen`.
        believed: an old map, of which some may have changed: cells are the same by place, other nodes by name. Only
            policies that plan take one; they plan on it, corrected by what was seen.
        until_covered: instead of a budget: until nothing is left that is known and not visited, or seen.
        think_time: seconds for each choice, of policies that plan.
        time_limit: seconds in all; then the walk goes straight to where it must end. Without the two limits, the same
            arguments give the same walk.
        seed: of the numbers by which nodes are known, the search, and random policies.
        on_progress: as of `plan`; the bound is infinite.

    Returns:
        The walk, with `seen` and `seen_after_step`. Its bound is that of walks that know the map.

    Raises:
        Error: as of `plan`; a bad `reveal` or `score`, or a time that is no time; sight without cells; a budget with
            `until_covered`; an old map of another kind, or a policy that does not plan on it.
    """
    name, own = ("", None) if policy is None else policy_of(policy)
    if flag(until_covered, "until_covered"):
        if budget is not None:
            raise Error(f"bad budget: until_covered takes none, got {shown(budget)}")
        budget = "inf"
    report = _core.plan(
        *_asked(world, budget, start, end), name, own, _seconds(time_limit), whole_number(seed, "seed"),
        function(on_progress, "on_progress"), *_covered(cover, reset_cost), text(reveal, "reveal"),
        text(score, "score"), _think_time(think_time), None if believed is None else _require_world(believed)._core,
    )  # fmt: skip
    return Plan(world, report)


def upper_bound(
    world: World,
    budget: Budget | None = None,
    start: Node | None = None,
    end: Node | None = None,
    *,
    cover: str = "nodes",
    reset_cost: float | None = None,
    time_limit: float | None = None,
) -> float:
    """What no walk's prize exceeds: a number of nodes, where there are no prizes. Source: docs/search.md, "Bounds".

    Of edges it is what those in reach are worth that the budget pays for, the best for their cost first; a plan may
    have a tighter one.

    Args:
        world: where to walk.
        budget: as of `plan`.
        start: as of `plan`.
        end: as of `plan`.
        cover: as of `plan`.
        reset_cost: as of `plan`.
        time_limit: seconds, 0 to 1,000,000. Without one, the same arguments give the same bound.

    Raises:
        Error: a blocked or missing node, a bad budget or time limit.
    """
    covered = _covered(cover, reset_cost)
    return _core.upper_bound(*_asked(world, budget, start, end), _seconds(time_limit), *covered)


def evaluate(
    worlds: World | Iterable[World],
    policies: str | Policy | OwnPolicy | Iterable[str | Policy | OwnPolicy] = ("nearest", "explorer", "search"),
    budget: Budget | None = None,
    *,
    end: Node | None = None,
    episodes: int = 30,
    all_starts: bool = False,
    cover: str = "nodes",
    reset_cost: float | None = None,
    seed: int = 1,
) -> list[dict[str, Any]]:
    """Compares policies on worlds, as `graphdrl evaluate`. Every policy has the same starts.

    Args:
        worlds: one or more.
        policies: one or more: a name as of `graphdrl plan --policy`, a Policy, or a callable. A callable gets a State
            and gives the number of the node to go to, one of `state.moves`, or None to stop.
        budget: in units of cost, or a text as `"1.1x"`; None for that of each world's file.
        end: a node, `"start"` or `"anywhere"`, or a text as of `graphdrl evaluate --end`; by default the file's, else
            anywhere. A node must be one of every world.
        episodes: walks of each policy on each world, where `all_starts` is false.
        all_starts: walk from each free node once.
        cover: what counts, `nodes` or `edges`; edges are covered by policies that have a name.
        reset_cost: as of `plan`.
        seed: of the starts, the search and random policies.

    Returns:
        Rows for `pandas.DataFrame`, with `map`, `policy`, `valid_nodes`, `budget`, `episodes`; and in percent of the
        free nodes, of all prizes, or of the edges, `mean`, `std`, `best`, `ci95_low`, `ci95_high`, `optimum`, `paper`,
        None where unknown.

    Raises:
        Error: a bad budget, end or policy. What a policy of your own raises comes out as it is.
    """
    several = not isinstance(worlds, (World, str)) and isinstance(worlds, Iterable)
    worlds = [_require_world(world) for world in (worlds if several else [worlds])]
    one = isinstance(policies, (str, Policy)) or callable(policies)
    chosen = [policies] if one else listed(policies, "policies", "names, Policies or callables")
    episodes = whole_number(episodes, "number of episodes", 1, 1_000_000)
    names: list[str] = []
    own: dict[str, Any] = {}
    for policy in chosen:
        name, its_own = policy_of(policy)
        if its_own is not None:
            while name in names:
                name += "'"
            own[name] = its_own
        names.append(name)
    return _core.evaluate(
        [world._core for world in worlds], names, own, None if budget is None else budget_text(budget),
        _end_text(worlds, end), episodes, flag(all_starts, "all_starts"), whole_number(seed, "seed"),
        *_covered(cover, reset_cost),
    )  # fmt: skip


def set_threads(count: int) -> None:
    """Sets how many threads one call may use. Results do not depend on it.

    Args:
        count: 1 to 1024, 1 at first.

    Raises:
        Error: any other.
    """
    _core.set_threads(whole_number(count, "number of threads", 1, 1024))
