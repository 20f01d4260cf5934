#include "graphdrl/planners/covering_walk.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "../support.h"
#include "graphdrl/base/parallel.h"
#include "graphdrl/env/world_families.h"
#include "graphdrl/planners/baselines.h"
#include "graphdrl/planners/bound.h"
#include "graphdrl/planners/parts.h"
#include "graphdrl/planners/registry.h"
#include "graphdrl/planners/two_matching.h"

namespace graphdrl {
namespace {

struct Kind {
  const char* family;
  int size;
  bool weighted = false;
};
constexpr Kind kKinds[] = {{"open", 20},
                           {"obstacles", 25},
                           {"rooms", 21},
                           {"loop-maze", 21},
                           {"tree", 150},
                           {"erdos-renyi", 120},
                           {"geometric", 150},
                           {"geometric", 150, true},
                           {"barabasi-albert", 150},
                           {"watts-strogatz", 90}};

World world_of_kind(const Kind& kind, int index, bool directed = false) {
  return split_world({.family = kind.family, .size = kind.size, .weighted = kind.weighted, .directed = directed},
                     Split::kTrain, index);
}

World open_cells(int rows, int cols) {
  return World("open", Graph::grid(rows, cols), std::vector<bool>(static_cast<std::size_t>(rows) * cols));
}

// Ends of every sort: the far one is the last that a search meets.
std::vector<End> ends(const World& world, NodeId start) {
  const Task task(world, start, 1e9);
  return {End::anywhere(), End::at_start(), End::at(task.reach().nodes.back())};
}

TEST(TwoMatching, LinksEachNodeToTwoOthersAtMost) {
  for (const Kind& kind : kKinds) {
    const World world = world_of_kind(kind, 5);
    const auto nodes = world.valid_nodes();
    TwoMatching matching(world.open(), nodes);
    matching.end_at(nodes.front());
    matching.grow_paths();
    matching.join_ends();
    matching.patch_cycles();
    for (const NodeId node : nodes) {
      EXPECT_LE(matching.degree(node), node == nodes.front() ? 1 : 2);
      for (const NodeId next : matching.links(node)) {
        if (next == kNoNode) continue;
        EXPECT_GE(world.open().index_of(node, next), 0);
        const auto& back = matching.links(next);
        EXPECT_EQ(std::count(back.begin(), back.end(), node), 1);
      }
    }
    for (const TwoMatching::Hop& hop : matching.hops()) {
      EXPECT_GE(world.open().index_of(hop.from, hop.over), 0);
      EXPECT_GE(world.open().index_of(hop.over, hop.to), 0);
    }
  }
}

TEST(CoveringWalk, VisitsAllThatIsInReach) {
  for (const Kind& kind : kKinds) {
    const World world = world_of_kind(kind, 4);
    const NodeId start = world.valid_nodes().front();
    for (const End& end : ends(world, start)) {
      const Task task(world, start, 1e9, end);
      const Plan plan = covering_plan(task);
      EXPECT_TRUE(can_walk(task, plan.walk)) << kind.family;
      EXPECT_EQ(plan.visited, std::ssize(task.reach().nodes)) << kind.family;
    }
  }
}

TEST(CoveringWalk, KeepsToItsBudgetAndEndsWhereItMust) {
  for (const Kind& kind : kKinds) {
    const World world = world_of_kind(kind, 6);
    const NodeId start = world.valid_nodes().front();
    for (const End& end : ends(world, start)) {
      const double least = end.of(start) == kNoNode ? 0 : costs_to(world.into(), end.of(start))[start];
      for (const double share : {0.0, 0.02, 0.3, 0.7, 1.0}) {
        const double budget = least + share * world.valid_count() * world.open().mean_cost();
        const Task task(world, start, budget, end);
        const Plan plan = covering_plan(task);
        EXPECT_TRUE(can_walk(task, plan.walk)) << kind.family << " " << share;
        EXPECT_LE(plan.prize, max_prize(task) * (1 + 1e-9));
      }
    }
  }
}

TEST(CoveringWalk, StepsOnNoCellTwiceWhereGroundIsOpen) {
  const World world = open_cells(40, 40);
  for (const double budget : {799.0, 1599.0}) {
    EXPECT_EQ(covering_plan(Task(world, 0, budget)).visited, budget + 1);
  }
  EXPECT_EQ(covering_plan(Task(world, 0, 1600, End::at_start())).visited, 1600);
}

// A corridor of 30 cells, of which each second has a dead end beside it: 15 steps must be saved of 75.
TEST(CoveringWalk, LeavesOutDeadEndsFirst) {
  std::vector<Edge> edges;
  for (NodeId node = 0; node < 29; ++node) edges.push_back({node, node + 1});
  for (NodeId node = 0; node < 15; ++node) edges.push_back({2 * node, 30 + node});
  const World world("comb", Graph::from_edges(45, edges), std::vector<bool>(45));
  const Plan plan = covering_plan(Task(world, 0, 29 + 2 * 7));
  EXPECT_EQ(plan.visited, 30 + 7);
}

TEST(CoveringWalk, EndsSoonAroundAHub) {
  constexpr NodeId kLeaves = 20'000;
  std::vector<Edge> edges;
  for (NodeId leaf = 1; leaf <= kLeaves; ++leaf) edges.push_back({0, leaf});
  const World world("star", Graph::from_edges(kLeaves + 1, edges), std::vector<bool>(kLeaves + 1));
  EXPECT_EQ(covering_plan(Task(world, 0, 1e9)).visited, kLeaves + 1);
  EXPECT_EQ(covering_plan(Task(world, 1, kLeaves)).visited, kLeaves / 2 + 2);
}

TEST(CoveringWalk, PassesOverWhatIsWorthNothing) {
  std::vector<double> prizes(900);
  for (int row = 0; row < 30; row += 10) {
    for (int col = 0; col < 30; ++col) prizes[30 * row + col] = 2;
  }
  const World world("rows", Graph::grid(30, 30), std::vector<bool>(900), {}, prizes);
  const Task task(world, 0, 1e9, End::at(899));
  const Plan plan = covering_plan(task);
  EXPECT_TRUE(can_walk(task, plan.walk));
  EXPECT_EQ(plan.prize, 180);
  EXPECT_LT(plan.cost, 200);
}

TEST(Parts, MakeAWalkBetterAndNeverWorse) {
  for (const bool directed : {false, true}) {
    for (const Kind& kind : kKinds) {
      if (directed && (world_of_kind(kind, 7).is_grid() || kind.family == std::string_view("tree"))) continue;
      const World world = world_of_kind(kind, 7, directed);
      const NodeId start = world.valid_nodes().front();
      for (const End& end : {End::anywhere(), End::at_start()}) {
        const Task task(world, start, 0.8 * world.valid_count() * world.open().mean_cost(), end);
        const Plan nearest = NearestPlanner().plan(task);
        const Plan plan = improve_by_parts(task, nearest, 2'000, 1);
        EXPECT_TRUE(can_walk(task, plan.walk)) << kind.family;
        EXPECT_FALSE(better(nearest, plan)) << kind.family;
        EXPECT_LE(plan.prize, max_prize(task) * (1 + 1e-9)) << kind.family;
      }
    }
  }
  const World world = world_of_kind({"obstacles", 40}, 1);
  const Task task(world, world.valid_nodes().front(), world.valid_count());
  EXPECT_GT(improve_by_parts(task, NearestPlanner().plan(task), 300'000, 1).visited,
            NearestPlanner().plan(task).visited + 10);
}

TEST(Parts, AreTheSameForAnyNumberOfThreads) {
  const World world = world_of_kind({"obstacles", 60}, 2);
  const Task task(world, world.valid_nodes().front(), world.valid_count());
  const Plan start = covering_plan(task);
  const Plan one = improve_by_parts(task, start, 400'000, 1);
  set_threads(2);
  const Plan two = improve_by_parts(task, start, 400'000, 1);
  set_threads(1);
  EXPECT_EQ(one.walk, two.walk);
  EXPECT_TRUE(can_walk(task, one.walk));
  EXPECT_GT(one.visited, start.visited);
}

TEST(Parts, StopAtADeadline) {
  const World world = world_of_kind({"obstacles", 85}, 2);
  const Task task(world, world.valid_nodes().front(), world.valid_count(), End::at_start());
  ASSERT_GT(task.reach().nodes.size(), 5000);  // so that the search goes by parts
  const auto planner = make_planner(parse_policy("search"));
  for (const double seconds : {0.0, 0.001, 0.02, 0.3}) {
    const Plan plan = planner->plan(task, Clock(seconds));
    EXPECT_TRUE(can_walk(task, plan.walk));
  }
}

}  // namespace
}  // namespace graphdrl
