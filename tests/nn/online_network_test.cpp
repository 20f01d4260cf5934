#include "graphdrl/nn/online_network.h"

#include <gmock/gmock.h>

#include <cmath>
#include <numeric>

#include "graphdrl/env/discovery.h"
#include "graphdrl/env/episode.h"
#include "support.h"

namespace graphdrl {
namespace {

World ring(int nodes, const std::vector<NodeId>& names) {
  std::vector<Edge> edges;
  for (NodeId node = 0; node < nodes; ++node) {
    edges.push_back({names[node], names[(node + 1) % nodes], 1.0 + node % 3});
    edges.push_back({names[node], names[(node + 5) % nodes], 2});
  }
  return World("ring", Graph::from_edges(nodes, edges), std::vector<bool>(nodes));
}

// The rows of the first decision after a walk along the ring, sorted.
std::vector<std::vector<float>> rows_after(const std::vector<NodeId>& names, std::uint64_t seed) {
  const int nodes = static_cast<int>(names.size());
  const World world = ring(nodes, names);
  Episode episode(world, Task(world, names[0], 40),
                  {.action_space = ActionSpace::kNeighbours, .reveal = Reveal::parse("edges"), .numbers_seed = seed});
  for (const NodeId node : {1, 2, 7, 8}) {
    const Observation now = episode.observation();
    for (int action = 0; action < now.action_count(); ++action) {
      if (episode.in_world(now.target(action)) != names[node]) continue;
      episode.step(action);
      break;
    }
  }
  const Observation now = episode.observation();
  OnlineScratch scratch;
  NearestFirst search;
  std::vector<float> rows;
  const auto visits =
      encode_online(Exploration(now, now.ground()), now.task->budget(), now.spent, scratch, search, rows);
  EXPECT_EQ(rows.size(), visits.size() * kOnlineFeatureCount);
  EXPECT_GT(visits.size(), 2u);
  std::vector<std::vector<float>> sorted;
  for (std::size_t i = 0; i < visits.size(); ++i) {
    sorted.emplace_back(rows.begin() + i * kOnlineFeatureCount, rows.begin() + (i + 1) * kOnlineFeatureCount);
  }
  std::ranges::sort(sorted);
  return sorted;
}

TEST(OnlineFeatures, DependOnNoNumbers) {
  std::vector<NodeId> names(20);
  std::iota(names.begin(), names.end(), 0);
  const auto rows = rows_after(names, 1);
  for (const auto& row : rows) {
    for (const float value : row) EXPECT_TRUE(std::isfinite(value) && std::abs(value) < 8);
  }
  EXPECT_EQ(rows_after(names, 2), rows);
  std::ranges::reverse(names);
  EXPECT_EQ(rows_after(names, 1), rows);
}

TEST(OnlineNetwork, DerivesByItsParameters) {
  Rng rng(3);
  OnlineParameters parameters(rng);
  OnlineNetwork network;
  constexpr int kRows = 5;
  std::vector<float> rows(kRows * kOnlineFeatureCount);
  for (float& value : rows) value = static_cast<float>(rng.uniform()) - 0.5f;
  const std::vector<float> weights = {1, -2, 0.5, 3, -1};
  std::vector<float> score(kRows);
  const auto loss = [&] {
    network.forward(parameters, rows, score);
    return std::inner_product(score.begin(), score.end(), weights.begin(), 0.0);
  };
  loss();
  OnlineParameters grad;
  network.backward(parameters, rows, weights, grad);
  for (std::size_t i = 0; i < parameters.values().size(); i += 37) {
    float& value = parameters.values()[i];
    const float before = value;
    constexpr float kStep = 1e-2f;
    value = before + kStep;
    const double above = loss();
    value = before - kStep;
    const double below = loss();
    value = before;
    EXPECT_NEAR((above - below) / (2 * kStep), grad.values()[i], 2e-2) << i;
  }
}

TEST(OnlinePolicyFile, IsReadBack) {
  const TemporaryFolder folder;
  Rng rng(4);
  const OnlineParameters parameters(rng);
  write_policy_file(folder / "online.safetensors", parameters);
  const Safetensors file = Safetensors::read((folder / "online.safetensors").string());
  EXPECT_TRUE(std::ranges::equal(read_online_explorer(file).values(), parameters.values()));
}

}  // namespace
}  // namespace graphdrl
