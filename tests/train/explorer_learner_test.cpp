#include "graphdrl/train/explorer_learner.h"

#include <gtest/gtest.h>

#include <cmath>

namespace graphdrl {
namespace {

// Two states, of three and of two first visits.
ExplorerBatch two_states(const Graph& graph) {
  ExplorerBatch batch;
  batch.graphs.add(graph);
  batch.graphs.add(graph);
  batch.state = {0, 0, 0, 1, 1};
  batch.target = {0, 1, 2, 3, 4};
  return batch;
}

TEST(ExplorerLoss, HasTheGradientItSays) {
  const Graph graph = Graph::grid(1, 3);
  const ExplorerBatch batch = two_states(graph);
  const std::vector<float> label = {1, 2.5, kUnlabelled, -3, 4};
  std::vector<float> shortfall = {0.5, 3, 9, 2, 1};
  std::vector<float> grad(5);
  explorer_loss(batch, label, shortfall, 0.7, grad);
  std::vector<float> unused(5);
  for (std::size_t i = 0; i < shortfall.size(); ++i) {
    const float kept = shortfall[i];
    shortfall[i] = kept + 1e-3f;
    const double above = explorer_loss(batch, label, shortfall, 0.7, unused);
    shortfall[i] = kept - 1e-3f;
    const double slope = (above - explorer_loss(batch, label, shortfall, 0.7, unused)) / 2e-3;
    shortfall[i] = kept;
    EXPECT_NEAR(grad[i], slope, 1e-3) << i;
  }
  EXPECT_EQ(grad[2], 0);
}

TEST(ExplorerLoss, RanksByCrossEntropy) {
  const Graph graph = Graph::grid(1, 3);
  const ExplorerBatch batch = two_states(graph);
  std::vector<float> grad(5);
  const std::vector<float> label = {0, 0.5, kUnlabelled, kUnlabelled, kUnlabelled};
  const std::vector<float> shortfall = {0.5, 0, 0, 0, 0};
  // Odds of 1 and 1/e at a temperature of half a node, the wrong way round; a mean over two states.
  const double best = 1 / (1 + std::exp(-1));
  const double expected = -(best * std::log(1 - best) + (1 - best) * std::log(best)) / 2;
  const double without = explorer_loss(batch, label, shortfall, 0, grad);
  EXPECT_NEAR(explorer_loss(batch, label, shortfall, 1, grad) - without, expected, 1e-6);
}

TEST(ExplorerLoss, IsWorkedOutByHand) {
  const Graph graph = Graph::grid(1, 3);
  const ExplorerBatch batch = two_states(graph);
  std::vector<float> grad(5);
  // State 0: errors 1 and 1 at labels 4 and 5: values ½·½ (weighed half, four short), deviations 0. State 1: right.
  const std::vector<float> label = {4, 5, kUnlabelled, 0, 1};
  const std::vector<float> shortfall = {5, 6, 0, 0, 1};
  EXPECT_NEAR(explorer_loss(batch, label, shortfall, 0, grad), 0.25 / 2, 1e-6);
}

}  // namespace
}  // namespace graphdrl
