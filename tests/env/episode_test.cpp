#include "graphdrl/env/episode.h"

#include <gmock/gmock.h>

#include "support.h"

namespace graphdrl {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr int kLeft = 0;
constexpr int kUp = 1;
constexpr int kRight = 2;
constexpr int kDown = 3;

// 0 1
// # 3
World corner() {
  return grid_world("..\n#.\n");
}

TEST(Episode, RewardsAsEquation3) {
  const World world = corner();
  Episode episode(world, {.budget = 8});
  episode.reset(0);
  EXPECT_EQ(episode.visits(), (std::vector<std::uint32_t>{1, 0, 0, 0}));

  StepResult step = episode.step(kLeft);  // off the map: stays, counts as a visit
  EXPECT_DOUBLE_EQ(step.reward, -0.5);
  EXPECT_TRUE(step.blocked);
  EXPECT_EQ(episode.position(), 0);
  EXPECT_EQ(episode.visits()[0], 2u);

  step = episode.step(kDown);  // into the obstacle
  EXPECT_DOUBLE_EQ(step.reward, -0.5);
  EXPECT_EQ(episode.visits()[0], 3u);
  EXPECT_EQ(episode.visits()[2], 0u);

  step = episode.step(kRight);  // a new node
  EXPECT_DOUBLE_EQ(step.reward, 0.1);
  EXPECT_TRUE(step.first_visit);

  step = episode.step(kLeft);  // back: 0.1 times the three visits before
  EXPECT_DOUBLE_EQ(step.reward, -0.1 * 3);
  EXPECT_FALSE(step.first_visit);
  EXPECT_EQ(episode.visits()[0], 4u);

  EXPECT_DOUBLE_EQ(episode.coverage(), 2.0 / 3);
  EXPECT_THAT(episode.walk(), ElementsAre(0, 0, 0, 1, 0));
  EXPECT_EQ(episode.spent(), 4);
}

TEST(Episode, RewardsAsEquation2) {
  const World world = corner();
  Episode episode(world, {.budget = 8, .reward = RewardKind::kCoverageGain});
  episode.reset(0);
  double sum = 0;
  for (const auto& [action, reward] : {std::pair(kUp, 0.0), {kRight, 1.0 / 3}, {kLeft, 0.0}}) {
    const StepResult step = episode.step(action);
    EXPECT_DOUBLE_EQ(step.reward, reward);
    sum += step.reward;
  }
  // Over an episode, the rewards add up to the coverage gained since the start [paper, eq. 1 and 2].
  EXPECT_DOUBLE_EQ(sum, episode.coverage() - 1.0 / 3);
}

TEST(Episode, GoesOnAfterFullCoverageUntilTheBudgetIsSpent) {
  const World world = corner();
  Episode episode(world, {.budget = 3});
  episode.reset(0);
  episode.step(kRight);
  episode.step(kDown);
  EXPECT_EQ(episode.coverage(), 1);
  EXPECT_FALSE(episode.done());
  EXPECT_FALSE(episode.terminal());
  episode.step(kUp);
  EXPECT_TRUE(episode.done());
  EXPECT_FALSE(episode.terminal()) << "a spent budget is a truncation";
}

TEST(Episode, CanEndAtFullCoverageWithABonus) {
  const World world = corner();
  for (const auto& [kind, reward] :
       {std::pair(RewardKind::kVisitPenalty, 0.1), std::pair(RewardKind::kCoverageGain, 1.0 / 3)}) {
    Episode episode(world, {.budget = 9, .reward = kind, .end_at_full_coverage = true});
    episode.reset(0);
    EXPECT_DOUBLE_EQ(episode.step(kRight).reward, reward);
    EXPECT_DOUBLE_EQ(episode.step(kDown).reward, reward + 1);
    EXPECT_TRUE(episode.done());
    EXPECT_TRUE(episode.terminal());
  }
}

TEST(Episode, CanPunishBlockedMovesByVisits) {
  const World world = corner();
  Episode episode(world, {.budget = 9, .punish_blocked_by_visits = true});
  episode.reset(0);
  EXPECT_DOUBLE_EQ(episode.step(kLeft).reward, -0.5 - 0.1 * 1);
  EXPECT_DOUBLE_EQ(episode.step(kLeft).reward, -0.5 - 0.1 * 2);
}

TEST(Episode, WalksAnyGraphByNeighbours) {
  const std::vector<Edge> edges = {{0, 1}, {0, 2}, {0, 3}, {2, 3}};
  const World world("star", Graph::from_edges(4, edges), {false, true, false, false});
  Episode episode(world, {.budget = 2, .action_space = ActionSpace::kNeighbours});
  episode.reset(0);
  EXPECT_EQ(episode.observation().action_count(), 2);  // 2 and 3; 1 is blocked
  episode.step(1);
  EXPECT_EQ(episode.position(), 3);
  EXPECT_EQ(episode.observation().action_to(2), 1);
  EXPECT_EQ(episode.observation().action_to(1), kNoAction);
}

TEST(Observation, MasksBlockedMovesForThoseWhoAsk) {
  const World world = corner();
  Episode episode(world, {});
  episode.reset(0);
  const Observation observation = episode.observation();
  EXPECT_EQ(observation.action_count(), 4);
  EXPECT_FALSE(observation.legal(kLeft));
  EXPECT_FALSE(observation.legal(kUp));
  EXPECT_TRUE(observation.legal(kRight));
  EXPECT_FALSE(observation.legal(kDown));
  EXPECT_EQ(observation.target(kRight), 1);
  EXPECT_EQ(observation.target(kDown), 0);
  EXPECT_EQ(observation.action_to(0), kLeft);
  Episode by_neighbours(world, {.action_space = ActionSpace::kNeighbours});
  by_neighbours.reset(1);
  EXPECT_EQ(by_neighbours.observation().action_count(), 2);
  EXPECT_TRUE(by_neighbours.observation().legal(0));
  EXPECT_TRUE(by_neighbours.observation().legal(1));
}

TEST(Episode, EndsWhereThereIsNowhereToGo) {
  const World world("alone", Graph::from_edges(1, {}), {false});
  Episode episode(world, {.budget = 5, .action_space = ActionSpace::kNeighbours});
  episode.reset(0);
  EXPECT_TRUE(episode.done());
  EXPECT_EQ(episode.coverage(), 1);
}

TEST(Episode, RefusesBadStartsBudgetsAndSpaces) {
  const World world = corner();
  Episode episode(world, {});
  EXPECT_THAT(error_of([&] { episode.reset(2); }), HasSubstr("start on an obstacle"));
  EXPECT_THAT(error_of([&] { episode.reset(4); }), HasSubstr("expected a node from 0 to 3, got 4"));
  EXPECT_THAT(error_of([&] { episode.reset(-1); }), HasSubstr("start outside the world"));
  EXPECT_THAT(error_of([&] { Episode(world, {.budget = -1}); }), HasSubstr("bad budget"));
  EXPECT_THAT(error_of([&] { Episode(world, {.budget = NAN}); }), HasSubstr("bad budget"));
  const World graph("graph", Graph::from_edges(2, {}), {false, false});
  EXPECT_THAT(error_of([&] { Episode(graph, {}); }), HasSubstr("directions need a grid"));
  EXPECT_THAT(error_of([&] { World("w", Graph::from_edges(1, {}), {true}); }), HasSubstr("no valid node"));
}

TEST(Episode, AZeroBudgetIsOverAtOnce) {
  const World world = corner();
  Episode episode(world, {.budget = 0});
  episode.reset(3);
  EXPECT_TRUE(episode.done());
  EXPECT_THAT(episode.walk(), ElementsAre(3));
}

TEST(Episode, SpendsCostsAndMasksWhatCannotBePaid) {
  const std::vector<Edge> edges = {{0, 1, 2.5}, {0, 2, 0.5}, {1, 2, 1}};
  const World world("triangle", Graph::from_edges(3, edges, EdgeKind::kDirected), std::vector<bool>(3));
  Episode episode(world, {.budget = 2, .action_space = ActionSpace::kNeighbours});
  episode.reset(0);
  EXPECT_FALSE(episode.observation().legal(0)) << "2.5 of 2";
  EXPECT_TRUE(episode.observation().legal(1));
  EXPECT_FALSE(episode.done());
  episode.step(1);
  EXPECT_EQ(episode.spent(), 0.5);
  EXPECT_NEAR(episode.observation().spendable, 1.5, 1e-8);
  EXPECT_TRUE(episode.done()) << "no edge leads on";
  episode.reset(1);
  episode.step(0);
  EXPECT_EQ(episode.spent(), 1);
}

// Integer costs are exact: 1000000001 of 1000000000 is too much, though it is within a billionth.
TEST(Episode, SpendsWholeNumbersToTheLast) {
  const std::vector<Edge> edges = {{0, 1, 1'000'000'001}, {1, 2, 1'000'000'000}};
  const World world("far", Graph::from_edges(3, edges), std::vector<bool>(3));
  Episode episode(world, {.budget = 1'000'000'000, .action_space = ActionSpace::kNeighbours});
  episode.reset(0);
  EXPECT_TRUE(episode.done());
  episode.reset(2);
  EXPECT_FALSE(episode.done());
}

TEST(Episode, MasksMovesAfterWhichTheEndIsOutOfReach) {
  // 0 - 1 - 2 - 3, and back to 0 with 4 steps: 2 can be had, 3 cannot.
  const World world = grid_world("....\n");
  Episode episode(world, {.budget = 4, .end = End::at_start()});
  episode.reset(0);
  episode.step(kRight);
  EXPECT_TRUE(episode.observation().legal(kRight));
  episode.step(kRight);
  EXPECT_FALSE(episode.observation().legal(kRight));
  EXPECT_FALSE(episode.observation().affordable(kUp)) << "a blocked move costs a step too";
  episode.step(kLeft);
  episode.step(kLeft);
  EXPECT_TRUE(episode.done());
  EXPECT_EQ(episode.position(), 0);
  EXPECT_THAT(error_of([&] { Episode(world, {.budget = 2, .end = End::at(3)}).reset(0); }),
              HasSubstr("the end cannot be reached within the budget"));
  EXPECT_THAT(error_of([&] { Episode(world, {.budget = 2, .end = End::at(4)}).reset(0); }), HasSubstr("end outside"));
}

TEST(Episode, AddsUpThePrizesOfFirstVisits) {
  const std::vector<Edge> edges = {{0, 1}, {1, 2}};
  const World world("prizes", Graph::from_edges(3, edges), std::vector<bool>(3), {}, {0.5, 2, 3});
  EXPECT_EQ(world.percent_of_all(2.75), 50);
  Episode episode(world, {.budget = 9, .action_space = ActionSpace::kNeighbours});
  episode.reset(0);
  for (const int action : {0, 0, 0, 1}) episode.step(action);  // 1, 0, 1, 2
  EXPECT_EQ(episode.prize(), 5.5);
  EXPECT_EQ(world.total_prize(), 5.5);
}

TEST(Episode, ForgivesTheRoundingOfSums) {
  const std::vector<Edge> edges = {{0, 1, 0.1}};
  const World world("pair", Graph::from_edges(2, edges), std::vector<bool>(2));
  Episode episode(world, {.budget = 0.3, .action_space = ActionSpace::kNeighbours});
  episode.reset(0);
  for (int i = 0; i < 3; ++i) {
    ASSERT_FALSE(episode.done()) << i;  // 0.1 + 0.1 + 0.1 > 0.3
    episode.step(0);
  }
  EXPECT_TRUE(episode.done());
}

// 0, 1 and 2 are joined at no cost; the budget does not reach 3.
World free_ring(double cost) {
  const std::vector<Edge> edges = {{0, 1, cost}, {1, 2, cost}, {2, 0, cost}, {2, 3, 7}};
  return World("ring", Graph::from_edges(4, edges), std::vector<bool>(4));
}

TEST(Episode, OfFreeMovesThatVisitNothingNewEnds) {
  const World world = free_ring(0);
  Episode episode(world, {.budget = 3, .action_space = ActionSpace::kNeighbours});
  episode.reset(0);
  int steps = 0;
  for (; !episode.done(); ++steps) {
    ASSERT_LT(steps, 1000);
    episode.step(0);  // 1, 0, 1, 0 …
  }
  EXPECT_TRUE(episode.too_long());
  EXPECT_EQ(steps, 1 + 4 * kFreeMovesPerNode);
  episode.step(episode.observation().action_to(2));  // a walk that is given goes on
  EXPECT_EQ(episode.visited_count(), 3);
  EXPECT_FALSE(episode.done());
}

TEST(Episode, OfMovesThatCostEndsByItsBudgetAlone) {
  Episode episode(free_ring(0.001), {.budget = 3, .action_space = ActionSpace::kNeighbours});
  episode.reset(0);
  for (; !episode.done(); episode.step(0)) ASSERT_FALSE(episode.too_long());
  EXPECT_EQ(episode.walk().size(), 3001U);
}

}  // namespace
}  // namespace graphdrl
