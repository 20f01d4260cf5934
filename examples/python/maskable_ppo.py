"""MaskablePPO of sb3-contrib on random graphs, a new one for every episode: learns which first visit to make.

Needs sb3-contrib. Compares what it learned with the nearest first visit and with GraphDRL's explorer, on graphs that it
never saw:

    python maskable_ppo.py --steps 200000
"""

import argparse

import graphdrl
import graphdrl.environments
import gymnasium
import numpy as np
from sb3_contrib import MaskablePPO
from stable_baselines3.common.env_util import make_vec_env

OPTIONS = {"family": "geometric", "size": 40, "budget": "1.0x"}


def coverage(choose, episodes=200):
    """The mean share of the nodes visited, in percent, on unseen graphs: the same for all."""
    env = gymnasium.make("GraphDRL/FirstVisit-v0", **OPTIONS)
    shares = []
    for seed in range(episodes):
        observation, info = env.reset(seed=1_000_000 + seed)
        over = False
        while not over:
            action = choose(env.unwrapped, observation, info)
            observation, _, terminated, truncated, info = env.step(action)
            over = terminated or truncated
        shares.append(100 * info["visited"] / env.unwrapped.world.valid_count)
    return np.mean(shares), 1.96 * np.std(shares, ddof=1) / np.sqrt(episodes)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--steps", type=int, default=200_000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--episodes", type=int, default=200, help="to compare over")
    arguments = parser.parse_args()

    envs = make_vec_env("GraphDRL/FirstVisit-v0", n_envs=8, seed=arguments.seed, env_kwargs=OPTIONS)
    model = MaskablePPO("MlpPolicy", envs, n_steps=256, batch_size=256, gamma=1.0, seed=arguments.seed)
    model.learn(arguments.steps)

    def learned(env, observation, info):
        action, _ = model.predict(observation, action_masks=info["action_mask"], deterministic=True)
        return int(action)

    explorer = graphdrl.Policy.load()

    def explored(env, observation, info):
        world, walk = env.world, env.walk
        target = explorer.first_visits(world.state(walk, OPTIONS["budget"]))
        return int(np.flatnonzero(info["targets"] == target.nodes[target.choice])[0])

    for name, choose in (
        ("nearest first visit", lambda env, observation, info: 0),
        (f"MaskablePPO, {arguments.steps} steps", learned),
        ("GraphDRL's explorer", explored),
    ):
        mean, half = coverage(choose, arguments.episodes)
        print(f"{name:30} {mean:.1f} ± {half:.1f} % of the nodes")


if __name__ == "__main__":
    main()
