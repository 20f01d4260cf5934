"""Explorations that are driven from outside: a program, a protocol, a page, a device."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable
from typing import Any, NamedTuple

import numpy as np

from . import _core
from ._core import Error
from .checks import flag, listed, number, path_text, text, whole_number, wrong
from .planning import Plan
from .world import World


class Move(NamedTuple):
    """A move of a state, as `LiveExploration.observe` takes it."""

    name: str
    to: str | None = None
    """The state that it leads to, if that can be seen."""
    cost: float | None = None
    """What it costs; None for what it cost last, or 1."""
    tried: bool = False
    """Whether it was done before, as in an earlier run, and does not count any more."""


class Cells(NamedTuple):
    """Cells that a sensor saw, as ROS's OccupancyGrid and OccupancyGridUpdate have them."""

    data: Any
    """Rows from the bottom, as lists or an array: -1, or how likely a cell is blocked, in percent."""
    origin: tuple[float, float]
    """x and y of the lower left corner."""
    resolution: float
    """A side of a cell, in the unit of x and y."""


class Step(NamedTuple):
    """What to do next: one of `move`, `reset`, `goto` and `done` is set."""

    move: str | None = None
    """The move to do."""
    reset: bool = False
    """Whether to go back to the first state."""
    done: str | None = None
    """Why there is nothing to do: `covered`, `budget` or `unreachable`."""
    expects: str | None = None
    """The state that the step should lead to, where that is known."""
    goto: tuple[tuple[float, float], ...] | None = None
    """The way to go: centres of cells, the goal last."""


class LiveExploration:
    """An exploration of what can say in which state it is and which moves it has, or which cells it sees.

    Tell where it is by `observe`, of cells by `observe_cells`; do what `next` says, and so on. The steps are those of
    `graphdrl explore --live` for the same observations; docs/live.md says what is promised. Any number may be under
    way, each in one thread at a time.
    """

    __slots__ = ("_core", "_step")

    def __init__(
        self,
        *,
        cover: str = "nodes",
        directed: bool = True,
        budget: float | None = None,
        end: str = "anywhere",
        reset_cost: float | None = None,
        score: str | None = None,
        connectivity: int = 8,
        policy: str = "",
        think_time: float | None = None,
        seed: int = 1,
        transcript: str | os.PathLike[str] | None = None,
        sync: bool = False,
        resume: bool = False,
    ) -> None:
        """Begins an exploration, or goes on with one.

        Args:
            cover: what counts, states (`nodes`) or each move of each state (`edges`).
            directed: whether moves lead one way; else each leads back, too, by a move of the same name.
            budget: what may be spent, of the costs that are observed; None for no limit.
            end: where to end, `anywhere` or at the `start`, the first state or cell.
            reset_cost: what it costs to go back to the first state at once; None where that cannot be done.
            score: of cells what counts, those `seen` (None) or those `visited`.
            connectivity: of cells, whether steps lead to 4 or to 8 others.
            policy: `novelty`, or a policy of unknown maps by name; empty for the default.
            think_time: seconds for each choice, of policies that plan.
            seed: of the search and of random policies.
            transcript: a file in which each observation and its step are written down.
            sync: whether each line of it is on the disk before `observe` returns.
            resume: whether to go on where a transcript ends; the other arguments are then those of the transcript.

        Raises:
            Error: a bad argument, a transcript that is there already, or to go on with, that is none.
        """
        options = {
            "cover": text(cover, "cover"),
            "directed": flag(directed, "directed"),
            "budget": None if budget is None else number(budget, "budget"),
            "end": text(end, "end"),
            "reset_cost": None if reset_cost is None else number(reset_cost, "reset_cost"),
            "score": None if score is None else text(score, "score"),
            "connectivity": whole_number(connectivity, "connectivity"),
            "policy": text(policy, "policy"),
            "think_time": None if think_time is None else number(think_time, "think_time"),
            "seed": whole_number(seed, "seed"),
        }
        file = "" if transcript is None else path_text(transcript, "transcript")
        if flag(resume, "resume") and not file:
            raise Error("resume goes with a transcript")
        self._core = _core.LiveRun(json.dumps(options), file, flag(sync, "sync"), resume)
        self._step = _step(self._core.last_answer)

    def observe(
        self,
        state: str,
        moves: Iterable[str | Move | tuple[Any, ...]] | None = None,
        *,
        cost: float | None = None,
        prize: float | None = None,
        failed: bool = False,
    ) -> None:
        """Says where it is now, and so what became of the last step.

        Args:
            state: the state's name.
            moves: its moves, instead of those before: names, or tuples as `Move`; None for those it had.
            cost: what the last step cost; None for what was expected.
            prize: what the first visit of the state is worth; None for 1.
            failed: whether the last step could not be done.

        Raises:
            Error: a bad argument; nothing has changed then.
        """
        message: dict[str, Any] = {"state": text(state, "state")}
        if moves is not None:
            message["moves"] = [_move(move) for move in listed(moves, "moves", "a list of moves")]
        if prize is not None:
            message["prize"] = number(prize, "prize")
        self._tell(message, cost, failed)

    def observe_cells(
        self,
        at: tuple[float, float],
        cells: Cells | None = None,
        *,
        cost: float | None = None,
        failed: bool = False,
    ) -> None:
        """Says where a robot is now, and what it has seen since.

        Args:
            at: x and y.
            cells: what it has seen since; the first time there must be some.
            cost: what the way cost that it went since; None for its length.
            failed: whether the goal cannot be reached.

        Raises:
            Error: a bad argument; nothing has changed then.
        """
        message: dict[str, Any] = {"at": _point(at, "at")}
        if cells is not None:
            if not isinstance(cells, tuple) or len(cells) != 3:
                raise wrong("cells", "Cells", cells)
            data, origin, resolution = cells
            message["cells"] = {
                "origin": _point(origin, "origin"),
                "resolution": number(resolution, "resolution"),
                **_grid(data),
            }
        self._tell(message, cost, failed)

    def _tell(self, message: dict[str, Any], cost: float | None, failed: bool) -> None:
        """Sends an observation."""
        if cost is not None:
            message["cost"] = number(cost, "cost")
        if flag(failed, "failed"):
            message["failed"] = True
        answer = self._core.answer(json.dumps(message))
        if answer.startswith('{"error":'):
            raise Error(json.loads(answer)["error"])
        self._step = _step(answer)

    def next(self) -> Step:
        """What to do next; the same until something is observed. After `resume`, what was said last.

        Raises:
            Error: nothing was observed yet.
        """
        if self._step is None:
            raise Error("nothing was observed yet")
        return self._step

    def report(self) -> dict[str, Any]:
        """What came of it so far, as docs/live.md describes it.

        Raises:
            Error: nothing was observed yet.
        """
        return json.loads(self._core.report())

    def world(self) -> World:
        """The map discovered: a directed graph whose nodes are states, by name; or cells.

        Raises:
            Error: nothing was observed yet.
        """
        world = self._core.world()
        return World(world, world.labels or None)

    def plan(self) -> Plan:
        """The walk so far, with what was seen when, for `save`.

        Raises:
            Error: nothing was observed yet.
        """
        return Plan(self.world(), self._core.plan())

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the map discovered, or the walk through it.

        Args:
            path: ends with .graphml, .gml, .dot or .json for the map, of cells with .txt, .map or .pgm, too; or as
                those of `Plan.save` for the walk.

        Raises:
            Error: an ending that is not known, a file that cannot be written; nothing was observed yet.
        """
        self._core.save(path_text(path))


def _step(answer: str) -> Step | None:
    """What an answer of the protocol says; None where there is none."""
    said = json.loads(answer) if answer else {}
    if not said.keys() & {"move", "reset", "goto", "done"}:
        return None
    goto = tuple(tuple(point) for point in said["goto"]) if "goto" in said else None
    return Step(said.get("move"), said.get("reset", False), said.get("done"), said.get("expects"), goto)


def _grid(data: Any) -> dict[str, Any]:
    """Rows of cells as a message has them."""
    try:
        grid = np.asarray(data)
    except ValueError as error:  # rows of different lengths
        raise wrong("data", "rows of whole numbers", data) from error
    if grid.ndim != 2 or grid.dtype.kind not in "iu":
        raise wrong("data", "rows of whole numbers", data)
    return {"width": grid.shape[1], "height": grid.shape[0], "data": grid.ravel().tolist()}


def _point(point: Any, name: str) -> list[float]:
    """As a message has it."""
    values = listed(point, name, "x and y")
    if len(values) != 2:
        raise wrong(name, "x and y", point)
    return [number(value, name) for value in values]


def _move(move: Any) -> str | dict[str, Any]:
    """As a message has it."""
    if isinstance(move, str):
        return text(move, "moves")
    if not isinstance(move, tuple) or not 1 <= len(move) <= 4:
        raise wrong("moves", "names or Moves", move)
    one = Move(*move)
    made: dict[str, Any] = {"move": text(one.name, "moves")}
    if one.to is not None:
        made["to"] = text(one.to, "moves")
    if one.cost is not None:
        made["cost"] = number(one.cost, "moves")
    if flag(one.tried, "tried"):
        made["tried"] = True
    return made
