"""Tells Gymnasium the names of the environments, without making or importing them."""

from __future__ import annotations


def register_environments() -> None:
    """Makes the names known to `gymnasium.make` and `gymnasium.make_vec`. Does nothing without Gymnasium."""
    try:
        from gymnasium.envs.registration import register, registry
    except ImportError:
        return
    for kind in ("Grid", "Graph", "FirstVisit", "Unknown"):
        name = f"GraphDRL/{kind}-v0"
        if name not in registry:
            entries = [f"graphdrl.environments:{kind}{single_or_many}" for single_or_many in ("Env", "VectorEnv")]
            register(name, entry_point=entries[0], vector_entry_point=entries[1])
