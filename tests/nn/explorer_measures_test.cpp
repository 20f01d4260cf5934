#include "graphdrl/nn/explorer_features.h"

#include <gtest/gtest.h>

#include "support.h"

namespace graphdrl {
namespace {

World corridor(int cells) {
  return grid_world(std::string(static_cast<std::size_t>(cells), '.') + "\n");
}

// A scope of all nodes within the horizon.
Scope whole(const Horizon& horizon) {
  Scope scope;
  for (int i = 0; i < horizon.size(); ++i) scope.nodes.push_back(i);
  return scope;
}

TEST(Horizon, EndsAtItsSizeAndKnowsThatMoreLiesBeyond) {
  const World world = corridor(3 * kExplorerHorizon);
  const Task task(world, kExplorerHorizon, 10);
  const NodeSet ground = task.ground();
  Horizon horizon;
  horizon.gather(Exploration(task, ground));
  EXPECT_EQ(horizon.size(), kExplorerHorizon);
  EXPECT_FALSE(horizon.is_all());
  EXPECT_EQ(horizon.most_steps(), kExplorerHorizon / 2);
  EXPECT_EQ(horizon.node(0), kExplorerHorizon);
  EXPECT_EQ(horizon.index_of(0), -1);
  EXPECT_EQ(horizon.unvisited_count(), kExplorerHorizon - 1);
  const int last = kExplorerHorizon - 1;
  EXPECT_EQ(horizon.neighbours(last).size(), 1u) << "the other one is beyond";
  EXPECT_EQ(horizon.unvisited_neighbours(last), 2);
  EXPECT_EQ(horizon.degree(last), 2);

  // The part goes on beyond the horizon, on either side: all that is unvisited there belongs to it.
  std::vector<int> queue;
  std::vector<int> size;
  measure_parts(horizon, whole(horizon), 2 * kExplorerHorizon, queue, size);
  EXPECT_EQ(size[0], 0);
  EXPECT_EQ(size[1], kExplorerHorizon / 2 + 2 * kExplorerHorizon);

  // A small world after a large one.
  const World small = corridor(3);
  const Task of_small(small, 0, 10);
  const NodeSet ground_of_small = of_small.ground();
  horizon.gather(Exploration(of_small, ground_of_small));
  EXPECT_EQ(horizon.size(), 3);
  EXPECT_TRUE(horizon.is_all());
}

TEST(ExplorerMeasures, CountNoWorkThatOthersHaveClaimed) {
  const World world = corridor(3 * kExplorerHorizon);
  const Task alone(world, kExplorerHorizon, 2 * kExplorerHorizon);
  NodeSet claimed(world.node_count());
  for (const NodeId node : {0, 1, kExplorerHorizon + 5}) claimed.insert(node);  // two beyond the horizon, one within
  const NodeSet ground = alone.ground();
  const auto work = [&](const Task& task) {
    const Exploration state(task, ground);
    Horizon horizon;
    NearestFirst search;
    Nearby nearby;
    horizon.gather(state);
    measure_nearby(state, horizon, kExplorerScope, search, nearby);
    return nearby.work;
  };
  EXPECT_EQ(work(alone), 3 * kExplorerHorizon - 1);
  EXPECT_EQ(work(alone.without(claimed)), 3 * kExplorerHorizon - 4);
}

TEST(ExplorerMeasures, FindTheTreeThatHangsOnACycle) {
  // 0 - 1 - 2 - 4 - 5, and 3 next to 1 and 2. From 0, the nodes 4 and 5 are a dead end.
  const std::vector<Edge> edges = {{0, 1}, {1, 2}, {1, 3}, {2, 3}, {2, 4}, {4, 5}};
  const World world("graph", Graph::from_edges(6, edges), std::vector<bool>(6));
  const Task task(world, 0, 10);
  const NodeSet ground = task.ground();
  Horizon horizon;
  horizon.gather(Exploration(task, ground));
  std::vector<int> queue;
  HangingTrees trees;
  measure_hanging_trees(horizon, queue, trees);
  std::vector<int> size;
  measure_parts(horizon, whole(horizon), 0, queue, size);
  std::vector<int> steps;
  measure_steps_to_work(horizon, queue, steps);
  const std::vector<int> hanging = {0, 0, 0, 0, 1, 1};
  const std::vector<int> tree_size = {0, 0, 2, 0, 2, 1};
  const std::vector<int> height = {0, 0, 2, 0, 2, 1};
  for (NodeId node = 0; node < 6; ++node) {
    const int i = horizon.index_of(node);
    EXPECT_EQ(trees.hanging[i], hanging[node]) << node;
    EXPECT_EQ(trees.size[i], tree_size[node]) << node;
    EXPECT_EQ(trees.height[i], height[node]) << node;
    EXPECT_EQ(size[i], node == 0 ? 0 : 5) << node;
    EXPECT_EQ(steps[i], node == 0 ? 1 : 0) << node;
  }
}

}  // namespace
}  // namespace graphdrl
