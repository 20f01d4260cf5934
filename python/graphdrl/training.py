"""Training, as `graphdrl train`."""

from __future__ import annotations

import json
import os
import pathlib
from collections.abc import Callable, Iterable
from typing import Any

from . import _core
from ._core import Error
from .checks import function, listed, path_text, shown
from .policies import Explorer, PaperNetwork, Policy
from .world import World

OnMetrics = Callable[[dict[str, Any]], Any]


class Run:
    """What a training left in its folder: a policy, metrics, a checkpoint to go on from.

    Args:
        path: the folder. Nothing is read until it is asked for.
        finished: as the attribute.
    """

    def __init__(self, path: str | os.PathLike[str], finished: bool | None = None) -> None:
        self.path = pathlib.Path(path_text(path))
        """The folder."""
        self.finished = finished
        """Whether all is trained; None where this object did not train it."""

    @property
    def policy(self) -> Explorer | PaperNetwork:
        """The policy of the last checkpoint. Raises Error where there is none."""
        return Policy.load(self.path / "policy.safetensors")

    @property
    def options(self) -> dict[str, Any]:
        """All options of the training, defaults included. Raises Error where the folder holds none."""
        return json.loads(self._read("config.json"))

    @property
    def metrics(self) -> list[dict[str, Any]]:
        """A row for every ten episodes of `paper`, for every round of `explorer`; for `pandas.DataFrame`.

        Of `paper`: `episode`, `steps`, `epsilon`, `loss`, `visited_nodes`, `coverage` (percent), `reward`.
        Raises Error where the folder holds none.
        """
        return [json.loads(line) for line in self._read("metrics.jsonl").splitlines()]

    def _read(self, name: str) -> str:
        try:
            return (self.path / name).read_text()
        except OSError as error:
            raise Error(f"{self.path / name}: cannot be read") from error

    def __repr__(self) -> str:
        return f"<Run {self.path}>"


def train(
    out: str | os.PathLike[str],
    preset: str = "explorer",
    *,
    maps: str | World | Iterable[str | World] | None = None,
    on_metrics: OnMetrics | None = None,
    **options: Any,
) -> Run:
    """Trains a policy, as `graphdrl train`: the same options and seed give the same bytes.

    Everything is saved whenever it ends, with Ctrl-C too; `resume` goes on. `set_threads` says how many threads it
    takes. Source of `paper`: DQN with gated graph networks [paper, algorithm 1]; of `explorer`: docs/explorer.md.

    Args:
        out: the folder to write, new.
        preset: `explorer` or `paper`.
        maps: of `paper`: names, files or worlds; by default the paper's map a.
        on_metrics: called with each row of the metrics; an answer that is true ends the training.
        options: those of `graphdrl train --help`, with underscores: `episodes=2000, learning_rate=1e-3, seed=7`.

    Raises:
        Error: an option that the preset does not have or of a wrong value, a folder that is not new. What `on_metrics`
            raises comes out as it is.
    """
    worlds: list[World] = []
    if maps is not None:
        sources = [maps] if isinstance(maps, (str, World)) else listed(maps, "maps", "names, files or worlds")
        if any(isinstance(source, World) for source in sources):
            worlds = [source if isinstance(source, World) else World.from_file(source) for source in sources]
        options["maps"] = [source.name if isinstance(source, World) else source for source in sources]
    options = {"preset": preset, **options}
    try:
        text = json.dumps(options, allow_nan=False)
    except (TypeError, ValueError) as error:
        raise Error(f"bad options of a training: {shown(options)}") from error
    finished = _core.train(path_text(out), text, [world._core for world in worlds], function(on_metrics, "on_metrics"))
    return Run(out, finished)


def resume(run: str | os.PathLike[str] | Run, *, on_metrics: OnMetrics | None = None) -> Run:
    """Goes on with a training where it was stopped, to the bytes that it would have ended with.

    Args:
        run: the folder, or what `train` gave.
        on_metrics: as of `train`.

    Raises:
        Error: a folder that holds no checkpoint.
    """
    path = run.path if isinstance(run, Run) else run
    return Run(path, _core.resume(path_text(path), function(on_metrics, "on_metrics")))
