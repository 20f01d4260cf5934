// The number of move sequences of length d from a node, counted by walking episodes, is the row sum of the adjacency
// matrix to the power d: an answer that owes nothing to Episode.
#include <gtest/gtest.h>

#include "graphdrl/env/episode.h"
#include "support.h"

namespace graphdrl {
namespace {

constexpr int kMaxLength = 8;

std::uint64_t count_walks(const World& world, std::vector<int>& actions, int length) {
  // Episodes cannot step back: every sequence is walked from its start.
  Episode episode(world, {.budget = kMaxLength, .action_space = ActionSpace::kNeighbours});
  episode.reset(actions.front());
  for (std::size_t i = 1; i < actions.size(); ++i) episode.step(actions[i]);
  if (length == 0) return 1;
  std::uint64_t count = 0;
  for (int action = 0; action < episode.observation().action_count(); ++action) {
    actions.push_back(action);
    count += count_walks(world, actions, length - 1);
    actions.pop_back();
  }
  return count;
}

// Row sums of A^d, A the adjacency matrix of the valid nodes, from the list of edges.
std::vector<std::uint64_t> matrix_power_row_sums(NodeId nodes, const std::vector<Edge>& edges,
                                                 const std::vector<bool>& blocked, int power) {
  std::vector<std::uint64_t> sums(nodes, 1);
  for (int d = 0; d < power; ++d) {
    std::vector<std::uint64_t> next(nodes, 0);
    for (const Edge& edge : edges) {
      if (blocked[edge.a] || blocked[edge.b]) continue;
      next[edge.a] += sums[edge.b];
      next[edge.b] += sums[edge.a];
    }
    sums = next;
  }
  return sums;
}

void expect_walk_counts(const World& world, const std::vector<Edge>& edges) {
  const NodeId nodes = world.graph().node_count();
  const std::vector<bool>& blocked = world.blocked();
  for (int length = 0; length <= kMaxLength; ++length) {
    const auto expected = matrix_power_row_sums(nodes, edges, blocked, length);
    for (const NodeId start : world.valid_nodes()) {
      std::vector<int> actions = {start};
      ASSERT_EQ(count_walks(world, actions, length), expected[start]) << "start " << start << ", length " << length;
    }
  }
}

World world_of(NodeId nodes, const std::vector<Edge>& edges, std::vector<bool> blocked = {}) {
  blocked.resize(nodes);
  return World("graph", Graph::from_edges(nodes, edges), blocked);
}

TEST(WalkCount, Path) {
  const std::vector<Edge> edges = {{0, 1}, {1, 2}, {2, 3}};
  expect_walk_counts(world_of(4, edges), edges);
}

TEST(WalkCount, Cycle) {
  const std::vector<Edge> edges = {{0, 1}, {1, 2}, {2, 3}, {3, 4}, {4, 0}};
  expect_walk_counts(world_of(5, edges), edges);
}

TEST(WalkCount, Complete) {
  const std::vector<Edge> edges = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};
  expect_walk_counts(world_of(4, edges), edges);
}

TEST(WalkCount, StarWithABlockedLeaf) {
  const std::vector<Edge> edges = {{0, 1}, {0, 2}, {0, 3}, {0, 4}};
  expect_walk_counts(world_of(5, edges, {false, false, true}), edges);
}

TEST(WalkCount, GridMapWithAnObstacle) {
  const std::vector<Edge> edges = {{0, 1}, {1, 2}, {3, 4}, {4, 5}, {0, 3}, {1, 4}, {2, 5}};
  expect_walk_counts(grid_world("...\n#..\n"), edges);
}

}  // namespace
}  // namespace graphdrl
