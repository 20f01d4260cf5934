"""Steps per second of the vector environment, beside a plain one in NumPy whose steps are the same.

    benchmarks/environments.py [ENVIRONMENTS]    needs the package with Gymnasium: pip install '.[gymnasium]'

Alternates the two, checks that every observation and reward is equal, and prints the medians and their ratio.
"""

import pathlib
import statistics
import sys
import time

import graphdrl.environments
import gymnasium
import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "tests" / "python"))
from test_environments import PlainGrid

BUDGET = 25
ROUNDS = 7


def main():
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 1024
    for copy in (True, False):
        envs = gymnasium.make_vec("GraphDRL/Grid-v0", num_envs=count, map="paper:a", budget=BUDGET, copy=copy)
        plain = PlainGrid(np.array(envs.unwrapped.world().blocked), BUDGET)
        random = np.random.default_rng(1)
        actions = random.integers(4, size=(40 * (BUDGET + 1), count))
        _, infos = envs.reset(seed=1)
        ours, theirs = [], []
        for _ in range(ROUNDS):
            begin = time.perf_counter()
            for row in actions:
                *_, infos = envs.step(row)
            ours.append(actions.size * BUDGET / (BUDGET + 1) / (time.perf_counter() - begin))
            # The last step of the round was the first of new episodes: one of them again, in NumPy.
            expected = plain.reset(divmod(int(infos["position"][0]), plain.blocked.shape[1]))
            begin = time.perf_counter()
            results = [plain.step(action) for action in actions[:BUDGET, 0]]
            theirs.append(BUDGET / (time.perf_counter() - begin))
            for row, (features, reward, _, truncated) in zip(actions, results):
                observations, rewards, _, truncations, _ = envs.step(row)
                assert np.array_equal(observations[0], features) and abs(rewards[0] - reward) < 1e-12
                assert bool(truncations[0]) == truncated
            envs.step(actions[-1])  # new episodes
        fast, slow = statistics.median(ours), statistics.median(theirs)
        speeds = f"ours {fast / 1e6:.2f}, NumPy {slow / 1e6:.4f} million steps/s"
        print(f"copy={copy!s:5}  {speeds}, ratio {fast / slow:.0f}")


if __name__ == "__main__":
    main()
