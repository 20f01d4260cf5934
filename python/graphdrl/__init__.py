"""Visit as many nodes of a graph as a budget allows: plans with bounds, on any graph or map."""

from ._core import FAMILIES, Error, MachineError, State, __version__, threads
from .live import Cells, LiveExploration, Move, Step
from .planning import Plan, evaluate, explore, plan, set_threads, upper_bound
from .policies import Explorer, FirstVisits, PaperNetwork, Policy
from .registration import register_environments
from .training import Run, resume, train
from .world import Edges, World

__all__ = [
    "FAMILIES",
    "Cells",
    "Edges",
    "Error",
    "Explorer",
    "FirstVisits",
    "LiveExploration",
    "MachineError",
    "Move",
    "PaperNetwork",
    "Plan",
    "Policy",
    "Run",
    "State",
    "Step",
    "World",
    "__version__",
    "evaluate",
    "explore",
    "plan",
    "resume",
    "set_threads",
    "threads",
    "train",
    "upper_bound",
]

register_environments()
