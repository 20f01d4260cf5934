"""Trained policies: their tensors, what they think of a state, their files."""

from __future__ import annotations

import os
import pathlib
from collections.abc import Iterable, Mapping
from typing import Any, ClassVar, NamedTuple, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from ._core import Error, State
from .world import shown


class FirstVisits(NamedTuple):
    """The moves of a state: walks to unvisited nodes next to visited ones, nearest first."""

    nodes: NDArray[np.int32]
    """Where they lead, numbers of nodes. Shape [C]."""
    costs: NDArray[np.float64]
    """Of the cheapest way there through visited nodes. Shape [C]."""
    shortfalls: NDArray[np.float32]
    """How many nodes the best walk after each falls short of `ceiling`: the lower, the better. Shape [C]."""
    ceiling: float
    """About how many nodes can still be visited."""
    choice: int | None
    """The place of the one that the explorer makes; None where there is none."""


class Policy:
    """A trained network. `Policy.load` reads one; `plan` and `evaluate` take it wherever they take a name."""

    __slots__ = ("_core", "name")
    _kind: ClassVar[Any]

    def __init__(self, tensors: Mapping[str, ArrayLike], name: str | None = None) -> None:
        """A network of these tensors, by PyTorch's names: all those of `tensors`, float32, in the same shapes.

        So what was trained elsewhere comes in: a `state_dict()` of PyTorch, say. Raises Error on anything else.
        """
        if type(self) is Policy:
            raise TypeError("a Policy is an Explorer or a PaperNetwork: Policy.load() finds out which")
        self._core = self._kind(self._arrays(tensors))
        self.name = name or type(self).__name__

    @classmethod
    def _arrays(cls, tensors: Mapping[str, ArrayLike]) -> list[NDArray[np.float32]]:
        """In the order of the network's tensors."""
        names = [spec[0] for spec in cls._kind.specs]
        strange = sorted(set(map(str, tensors)) ^ set(names))
        if strange:
            raise Error(f"bad tensors: expected those of {cls.__name__}, got or missed {strange[0]!r}")
        arrays = []
        for key in names:
            try:
                arrays.append(np.ascontiguousarray(tensors[key], dtype=np.float32))
            except (TypeError, ValueError) as error:
                raise Error(f"bad tensor {key!r}: expected numbers, got {shown(tensors[key])}") from error
        # ascontiguousarray turns a scalar into an array, which no shape here is.
        return arrays

    @classmethod
    def _of(cls, core: Any, name: str) -> Self:
        policy = object.__new__(cls)
        policy._core = core
        policy.name = name
        return policy

    @staticmethod
    def load(path: str | os.PathLike[str] = "explorer") -> Explorer | PaperNetwork:
        """The policy of a file, or `explorer`, the one in the package. Raises Error."""
        file = os.fspath(path)
        if file == "explorer":
            return Explorer._of(_core.Explorer.builtin(), file)
        name = pathlib.Path(file).stem
        if _core.is_explorer_file(file):
            return Explorer._of(_core.Explorer.read(file), name)
        return PaperNetwork._of(_core.PaperNetwork.read(file), name)

    @property
    def tensors(self) -> dict[str, NDArray[np.float32]]:
        """By PyTorch's names: copies."""
        return self._core.tensors

    @property
    def parameter_count(self) -> int:
        """How many numbers are learned."""
        return sum(int(np.prod(shape)) for _, shape, trainable in self._core.specs if trainable)

    def inputs(self, states: State | Iterable[State]) -> dict[str, NDArray[Any]]:
        """States as the ONNX model takes them, joined into one batch: what the network sees, edges, graph of each node.

        Shapes and names: docs/python.md, "ONNX".
        """
        return self._core.inputs([states] if isinstance(states, State) else list(states))

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes a policy file. Raises Error."""
        self._core.save(os.fspath(path))

    def export_onnx(self, path: str | os.PathLike[str]) -> None:
        """Writes an ONNX model: as `graphdrl export`. Raises Error."""
        self._core.export_onnx(os.fspath(path))

    def __repr__(self) -> str:
        return f"<{type(self).__name__} {self.name}: {self.parameter_count} parameters>"

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.tensors, self.name)

    def __copy__(self) -> Self:
        return self

    def __deepcopy__(self, memo: dict[int, Any]) -> Self:
        return self


class Explorer(Policy):
    """Scores first visits; works on any graph."""

    __slots__ = ()
    _kind = _core.Explorer

    def first_visits(self, state: State) -> FirstVisits:
        """The first visits of a state, scored: all of them, or those that the network looks at."""
        nodes, costs, shortfalls, ceiling, choice = self._core.first_visits(state)
        return FirstVisits(nodes, costs, shortfalls, ceiling, None if choice < 0 else choice)


class PaperNetwork(Policy):
    """The paper's Q-network; works on grids, in four directions."""

    __slots__ = ()
    _kind = _core.PaperNetwork

    def __init__(self, tensors: Mapping[str, ArrayLike], name: str | None = None, wall: str = "border") -> None:
        """As of any Policy. `wall` says which cells the network sees as wall, and must be as in its training.

        `border`: the first and last rows and columns. `zero_or_nine`: rows and columns 0 and 9, whatever the map's
        size, as in the code of the paper's author. Raises Error on another.
        """
        self._core = self._kind(self._arrays(tensors), str(wall))
        self.name = name or type(self).__name__

    @property
    def wall(self) -> str:
        """Which cells the network sees as wall: `border` or `zero_or_nine`."""
        return self._core.wall

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.tensors, self.name, self.wall)

    @classmethod
    def random(cls, seed: int = 0) -> PaperNetwork:
        """An untrained one, initialised as for a training."""
        return cls._of(_core.PaperNetwork.random(seed), f"random-{seed}")

    def q_values(self, states: State | Iterable[State]) -> NDArray[np.float32]:
        """Of left, up, right and down. Shape [4] of one state, [B, 4] of many. Raises Error on other than grids."""
        if isinstance(states, State):
            return self._core.q_values([states])[0]
        return self._core.q_values(list(states))
