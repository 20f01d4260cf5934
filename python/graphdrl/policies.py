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
from .checks import listed, path_text, shown, text, whole_number, wrong


class FirstVisits(NamedTuple):
    """The moves of a state: walks to unvisited nodes next to visited ones, nearest first. C: how many there are."""

    nodes: NDArray[np.int32]
    """Where they lead, numbers of nodes. Shape [C]."""
    costs: NDArray[np.float64]
    """Of the cheapest way there through visited nodes, in units of cost. Shape [C]."""
    shortfalls: NDArray[np.float32]
    """How many nodes the best walk after each falls short of `ceiling`. The lowest is the best. Shape [C]."""
    ceiling: float
    """About how many nodes can still be visited."""
    choice: int | None
    """The place of the one that the explorer makes; None where there is none."""


class Policy:
    """A trained network. `Policy.load` reads one; `plan` and `evaluate` take it wherever they take a name."""

    __slots__ = ("_core", "name")
    _kind: ClassVar[Any]

    def __init__(self, tensors: Mapping[str, ArrayLike], name: str | None = None) -> None:
        """A network of these tensors, so that what was trained elsewhere comes in.

        Args:
            tensors: by PyTorch's names, as a `state_dict()`: all those of the property `tensors`, in the same shapes.
            name: of the policy; by default that of its class.

        Raises:
            Error: a tensor missing, unknown, of another shape, or with a value that no network can have.
            TypeError: made of Policy itself.
        """
        if type(self) is Policy:
            raise TypeError("a Policy is an Explorer or a PaperNetwork: Policy.load() finds out which")
        self._core = self._kind(self._arrays(tensors))
        self.name = text(name or type(self).__name__, "name")

    @classmethod
    def _arrays(cls, tensors: Mapping[str, ArrayLike]) -> list[NDArray[np.float32]]:
        """In the order of the network's tensors."""
        if not isinstance(tensors, Mapping):
            raise wrong("tensors", "a dictionary by PyTorch's names", tensors)
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
        """The policy of a file.

        Args:
            path: a policy file, or `explorer`, the one for known maps in the package.

        Raises:
            Error: a file that cannot be read, or is no policy.
        """
        file = path_text(path)
        if file == "explorer":
            return Explorer._of(_core.Explorer.builtin(), file)
        name = pathlib.Path(file).stem
        core = _core.read_policy(file)
        return (Explorer if isinstance(core, _core.Explorer) else PaperNetwork)._of(core, name)

    @property
    def tensors(self) -> dict[str, NDArray[np.float32]]:
        """Copies of the tensors, by PyTorch's names, float32."""
        return self._core.tensors

    @property
    def parameter_count(self) -> int:
        """How many values are learned."""
        return sum(int(np.prod(shape)) for _, shape, trainable in self._core.specs if trainable)

    def inputs(self, states: State | Iterable[State]) -> dict[str, NDArray[Any]]:
        """States as the ONNX model takes them, joined into one batch.

        Integers are int64, features float32. B states, N nodes of all their graphs, E edges, C first visits.

        Args:
            states: one or more.

        Returns:
            For both networks `edge_index` [2, E], row 0 the sources and row 1 the targets, an undirected edge both
            ways; and `batch` [N], the state of each node. For a PaperNetwork also `x` [N, 7]. For an Explorer also
            `node_x` [N, 20]; `current` [B], a row of `node_x`; `visit_x` [C, 11]; `target` [C], a row of `node_x`; and
            `state` [C].
        """
        return self._core.inputs(_states(states))

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes a policy file (safetensors), which `load` and `graphdrl` read.

        Args:
            path: the file.

        Raises:
            Error: a file that cannot be written.
        """
        self._core.save(path_text(path))

    def export_onnx(self, path: str | os.PathLike[str]) -> None:
        """Writes an ONNX model (opset 16), as `graphdrl export`. Its inputs are those that `inputs` gives.

        Its output is `q` [B, 4] of a PaperNetwork, `shortfall` [C] of an Explorer.

        Args:
            path: the file.

        Raises:
            Error: a file that cannot be written.
        """
        self._core.export_onnx(path_text(path))

    def __repr__(self) -> str:
        return f"<{type(self).__name__} {self.name}: {self.parameter_count} parameters>"

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.tensors, self.name)

    def __copy__(self) -> Self:
        return self

    def __deepcopy__(self, memo: dict[int, Any]) -> Self:
        return self


class Explorer(Policy):
    """A network that scores first visits, on any graph. Source: docs/explorer.md."""

    __slots__ = ()
    _kind = _core.Explorer

    def first_visits(self, state: State) -> FirstVisits:
        """The first visits of a state, scored: all of them, or those in the network's scope.

        Args:
            state: of any world.

        Raises:
            Error: a state that is over.
        """
        nodes, costs, shortfalls, ceiling, choice = self._core.first_visits(*_states([state]))
        return FirstVisits(nodes, costs, shortfalls, ceiling, None if choice < 0 else choice)


class PaperNetwork(Policy):
    """The paper's Q-network: gated graph convolutions [paper, eq. 7]. Works on grids, in four directions."""

    __slots__ = ()
    _kind = _core.PaperNetwork

    def __init__(self, tensors: Mapping[str, ArrayLike], name: str | None = None, wall: str = "border") -> None:
        """A network of these tensors, so that what was trained elsewhere comes in.

        Args:
            tensors: as of any Policy.
            name: of the policy; by default that of its class.
            wall: which cells the network sees as wall, as in its training. `border`: the first and last rows and
                columns. `zero_or_nine`: rows and columns 0 and 9, whatever the map's size, as in the code of the
                paper's author.

        Raises:
            Error: bad tensors, as of any Policy; another `wall`.
        """
        self._core = self._kind(self._arrays(tensors), str(wall))
        self.name = text(name or type(self).__name__, "name")

    @property
    def wall(self) -> str:
        """Which cells the network sees as wall, `border` or `zero_or_nine`."""
        return self._core.wall

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.tensors, self.name, self.wall)

    @classmethod
    def random(cls, seed: int = 0) -> PaperNetwork:
        """An untrained network, initialised as PyTorch and PyTorch Geometric do.

        Args:
            seed: from 0 up.
        """
        return cls._of(_core.PaperNetwork.random(whole_number(seed, "seed")), f"random-{seed}")

    def q_values(self, states: State | Iterable[State]) -> NDArray[np.float32]:
        """What the network expects of each direction: the discounted sum of rewards [paper, eq. 5].

        Args:
            states: one or more.

        Returns:
            Of left, up, right and down, float32. Shape [4] of one state, [B, 4] of many.

        Raises:
            Error: a world that is no grid, a state that is over.
        """
        if isinstance(states, State):
            return self._core.q_values([states])[0]
        return self._core.q_values(_states(states))


def _states(states: State | Iterable[State]) -> list[State]:
    given = [states] if isinstance(states, State) else listed(states, "states", "a State or several")
    for state in given:
        if not isinstance(state, State):
            raise wrong("state", "a State, as World.state() makes", state)
    return given
