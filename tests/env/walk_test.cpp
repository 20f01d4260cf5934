#include "graphdrl/env/episode.h"

#include <gmock/gmock.h>

#include "support.h"

namespace graphdrl {
namespace {

TEST(FollowWalk, LeadsThroughEveryNodeAndCountsBlockedMoves) {
  const World world = grid_world("..\n#.\n");
  Episode episode(world, {.budget = 3});
  std::vector<NodeId> seen;
  const std::vector<NodeId> walk = {0, 1, 1, 3};
  follow_walk(episode, walk, [&](const Observation& observation) { seen.push_back(observation.position); });
  EXPECT_EQ(seen, walk);
  EXPECT_EQ(episode.visits(), (std::vector<std::uint32_t>{1, 2, 0, 1}));
}

TEST(FollowWalk, RefusesStepsThatCannotBe) {
  const World world = grid_world("...\n...\n...\n");
  const auto error_for = [&](std::vector<NodeId> walk) {
    Episode episode(world, {.budget = 9});
    return error_of([&] { follow_walk(episode, walk); });
  };
  using ::testing::HasSubstr;
  EXPECT_THAT(error_for({0, 4}), HasSubstr("got 4 at place 1"));
  EXPECT_THAT(error_for({0, 1, 99}), HasSubstr("got 99 at place 2"));
  EXPECT_THAT(error_for({4, 4}), HasSubstr("no such step")) << "no direction is blocked in the middle";
  EXPECT_THAT(error_for({}), HasSubstr("the walk is empty"));
  EXPECT_EQ(error_for({0, 0, 1}), "");
}

}  // namespace
}  // namespace graphdrl
