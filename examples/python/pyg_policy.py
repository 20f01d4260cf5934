"""A policy of PyTorch Geometric, trained by REINFORCE on random graphs. Needs torch and torch_geometric."""

import sys

import graphdrl.environments
import gymnasium
import torch
from torch_geometric.nn import SAGEConv


class Policy(torch.nn.Module):
    def __init__(self, features, width=32):
        super().__init__()
        self.convs = torch.nn.ModuleList([SAGEConv(features, width), SAGEConv(width, width)])
        self.score = torch.nn.Linear(width, 1)

    def forward(self, observation, target_rows):
        x, edges = torch.from_numpy(observation.nodes), torch.from_numpy(observation.edge_links).T
        for conv in self.convs:
            x = conv(x, edges).relu()
        return torch.distributions.Categorical(logits=self.score(x[target_rows]).squeeze(1))


env = gymnasium.make("GraphDRL/FirstVisit-v0", family="tree", size=25, budget="1.1x", observation="graph")
policy = Policy(env.observation_space.node_space.shape[0])
optimizer = torch.optim.Adam(policy.parameters(), lr=3e-3)
torch.manual_seed(0)
mean, episodes = 0.6, int(sys.argv[1]) if len(sys.argv) > 1 else 1500
for episode in range(episodes):
    observation, info = env.reset(seed=episode)
    gain, logs, over = 0.0, [], False
    while not over:
        moves = policy(observation, info["target_rows"][info["action_mask"]])
        action = moves.sample()
        observation, reward, over, _, info = env.step(action.item())
        gain, logs = gain + reward, [*logs, moves.log_prob(action)]
    optimizer.zero_grad()
    ((mean - gain) * torch.stack(logs).sum()).backward()
    optimizer.step()
    mean += 0.02 * (gain - mean)
    if (episode + 1) % max(episodes // 5, 1) == 0:
        print(f"after {episode + 1:5} episodes: {100 * mean:.1f} % of the nodes")
