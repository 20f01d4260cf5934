"""Visit as many nodes of a graph as a budget allows: plans with bounds, on any graph or map."""

from ._core import FAMILIES, Error, State, __version__, set_threads, threads
from .planning import Plan, evaluate, plan, upper_bound
from .world import World

__all__ = [
    "FAMILIES",
    "Error",
    "Plan",
    "State",
    "World",
    "__version__",
    "evaluate",
    "plan",
    "set_threads",
    "threads",
    "upper_bound",
]
