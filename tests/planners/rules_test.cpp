#include "graphdrl/planners/rules.h"

#include <gmock/gmock.h>

#include "graphdrl/eval/rollout.h"
#include "graphdrl/planners/baselines.h"
#include "graphdrl/planners/registry.h"
#include "support.h"

namespace graphdrl {
namespace {

using ::testing::ElementsAre;

World graph_world(int nodes, const std::vector<Edge>& edges) {
  return World("graph", Graph::from_edges(nodes, edges), std::vector<bool>(nodes));
}

std::vector<NodeId> explored(const World& world, Rule rule, double budget, std::uint64_t seed = 1) {
  RulePolicy policy(rule);
  return plan_by_steps(
             world, Task(world, 0, budget),
             {.action_space = ActionSpace::kNeighbours, .reveal = Reveal::parse("edges"), .numbers_seed = seed}, policy)
      .walk;
}

// Notes where it chooses the nearest first visit.
class Noting final : public FirstVisitPolicy {
 public:
  explicit Noting(std::uint64_t held_for) : FirstVisitPolicy(held_for) {}
  std::vector<NodeId> chose_at;

 private:
  NodeId choose(const Exploration& now, const Observation& observation) override {
    chose_at.push_back(observation.position);
    return now.nearest_first_visit(search()).node;
  }
};

//   0 - 1 - 2 - 3 -- 4, of which a radius of 3 shows 0 to 3 at first, and 4 from 2.
TEST(FirstVisitPolicy, HoldsItsChoiceThoughMoreBecomesKnown) {
  const World world = graph_world(5, {{0, 1}, {1, 2}, {2, 3}, {3, 4, 2}});
  const auto chose_at = [&](std::uint64_t held_for) {
    Noting policy(held_for);
    const EpisodeOptions options{
        .action_space = ActionSpace::kNeighbours, .reveal = Reveal::parse("radius:3"), .score = Score::kSeen};
    EXPECT_THAT(plan_by_steps(world, Task(world, 0, kNoLimit), options, policy).walk, ElementsAre(0, 1, 2));
    return policy.chose_at;
  };
  EXPECT_THAT(chose_at(0), ElementsAre(0, 1, 2));
  EXPECT_THAT(chose_at(1), ElementsAre(0, 1, 2));
  EXPECT_THAT(chose_at(2), ElementsAre(0, 2)) << "at 2 nothing is left to see";
}

// Cells show directions, and the nearest node is the same whether more is known or not.
TEST(RulePolicy, NearestWalksAnUnknownGridAsAKnownOne) {
  Rng rng(4);
  for (int round = 0; round < 20; ++round) {
    const World world = random_world(rng, 9, 9, 0.25);
    const Task task(world, world.valid_nodes().front(), 60);
    const std::vector<NodeId> known = NearestPlanner().plan(task).walk;
    RulePolicy policy(Rule::kNearest);
    const EpisodeOptions options{.action_space = ActionSpace::kNeighbours, .reveal = Reveal::parse("edges")};
    EXPECT_EQ(plan_by_steps(world, task, options, policy).walk, known);
  }
}

TEST(RulePolicy, DepthFirstGoesOnFromWhatItSawLast) {
  //     1 - 2 - 3
  // 0 <
  //     4
  const World world = graph_world(5, {{0, 1}, {1, 2}, {2, 3}, {0, 4}});
  const std::vector<NodeId> walk = explored(world, Rule::kDepthFirst, 20);
  if (walk[1] == 1) {
    EXPECT_THAT(walk, ElementsAre(0, 1, 2, 3, 2, 1, 0, 4));
  } else {
    EXPECT_THAT(walk, ElementsAre(0, 4, 0, 1, 2, 3));
  }
}

// After 0 and 1 both 2 and 3 are one step away: 2 has two visited neighbours, 3 has one.
TEST(RulePolicy, TiesGoByVisitedNeighbours) {
  const World world = graph_world(5, {{0, 1, 1}, {0, 2, 1.5}, {1, 2, 1.5}, {1, 3, 1.5}, {3, 4, 9}});
  EXPECT_EQ(explored(world, Rule::kPocket, 20)[2], 2);
  EXPECT_EQ(explored(world, Rule::kOpen, 20)[2], 3);
}

TEST(RulePolicy, TiesGoAnywhereElse) {
  const World star = graph_world(4, {{0, 1}, {0, 2}, {0, 3}});
  int first[4] = {};
  for (std::uint64_t seed = 0; seed < 90; ++seed) ++first[explored(star, Rule::kNearest, 1, seed)[1]];
  for (int node = 1; node < 4; ++node) EXPECT_GT(first[node], 15) << node;
}

// From 2 node 3 is a little nearer than the eight leaves of the hub, which are worth more.
TEST(RulePolicy, FrontierWeighsDistanceAgainstSize) {
  std::vector<Edge> edges = {{0, 1, 1}, {1, 2, 1}, {1, 3, 2}};
  for (NodeId leaf = 4; leaf < 12; ++leaf) edges.push_back({2, leaf, 3.2});
  const World world = graph_world(12, edges);
  EXPECT_GE(explored(world, Rule::kFrontier, 60)[3], 4);
  EXPECT_EQ(explored(world, Rule::kNearest, 60)[3], 1);
}

// Walks of one unknown map begin with the same numbers, whatever is behind them.
TEST(RulePolicy, WalksManyUnknownMapsSideBySideAsOneByOne) {
  Rng rng(9);
  std::vector<Edge> edges;
  for (NodeId node = 1; node < 40; ++node) edges.push_back({node, rng.index(node)});
  for (int i = 0; i < 25; ++i) edges.push_back({i, i + 1 + rng.index(14), 2});
  const World world("graph", Graph::from_edges(40, edges), std::vector<bool>(40));
  const Episode episode(world, Task(world, 0, 45),
                        {.action_space = ActionSpace::kNeighbours, .reveal = Reveal::parse("edges")});
  const std::vector<NodeId> starts(64, 0);  // a block of eval/rollout
  for (const Rule rule : {Rule::kNearest, Rule::kDepthFirst, Rule::kPocket}) {
    RulePolicy together(rule);
    const auto results = roll_out(episode, starts, together);
    for (int i = 0; i < std::ssize(starts); ++i) {
      RulePolicy alone(rule);
      EXPECT_EQ(roll_out(episode, {&starts[i], 1}, alone, {}, {&i, 1}).front().walk, results[i].walk);
    }
  }
}

}  // namespace
}  // namespace graphdrl
