"""Steps per second of GraphDRL/Unknown-v0, many at once, beside Gymnasium's SyncVectorEnv of single ones.

    benchmarks/unknown_environments.py [ENVIRONMENTS]    needs the package with Gymnasium: pip install '.[gymnasium]'

Alternates the two, checks that every observation, reward and flag is equal, and prints the medians and their ratio.
"""

import statistics
import sys
import time

import graphdrl
import gymnasium
import numpy as np

STEPS = 200
ROUNDS = 7
SETTINGS = (
    {"map": graphdrl.World.random("obstacles", 20, 1), "reveal": "edges"},
    {"map": graphdrl.World.random("obstacles", 20, 1), "reveal": "sight:5", "score": "seen"},
    {"map": graphdrl.World.random("geometric", 200, 1, weighted=True), "reveal": "edges"},
)


def run(envs, infos, random):
    """Takes a legal action each. Gives steps per second, what was observed, and the last infos."""
    seen, seconds = [], 0.0
    for _ in range(STEPS):
        actions = (random.random(infos["action_mask"].shape) * infos["action_mask"]).argmax(axis=1)
        begin = time.perf_counter()
        *results, infos = envs.step(actions)
        seconds += time.perf_counter() - begin
        seen.append(results)
    return STEPS * len(actions) / seconds, seen, infos


def main():
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 64
    for options in SETTINGS:
        kinds = ("vector_entry_point", "sync")
        envs = [gymnasium.make_vec("GraphDRL/Unknown-v0", count, vectorization_mode=kind, **options) for kind in kinds]
        infos = [one.reset(seed=1)[1] for one in envs]
        speeds = ([], [])
        for number in range(ROUNDS):
            rounds = [run(one, info, np.random.default_rng(number)) for one, info in zip(envs, infos, strict=True)]
            for speed, one in zip(speeds, rounds, strict=True):
                speed.append(one[0])
            for ours, theirs in zip(rounds[0][1], rounds[1][1], strict=True):
                assert all(np.array_equal(a, b) for a, b in zip(ours, theirs, strict=True))
            infos = [one[2] for one in rounds]
        ours, theirs = map(statistics.median, speeds)
        name = f"{options['map'].name}, {options['reveal']}, {options.get('score', 'visited')}"
        rates = f"ours {ours / 1e3:.0f}, SyncVectorEnv {theirs / 1e3:.1f} thousand steps/s"
        print(f"{name}: {rates}, ratio {ours / theirs:.0f}")


if __name__ == "__main__":
    main()
