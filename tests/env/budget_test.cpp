#include "graphdrl/env/budget.h"

#include <gmock/gmock.h>

#include "support.h"

namespace graphdrl {
namespace {

TEST(Budget, IsStepsOrAMultipleOfTheValidNodes) {
  const World world = grid_world("...\n.#.\n...\n");  // 8 valid nodes
  EXPECT_EQ(Budget::parse("25").cost_in(world), 25);
  EXPECT_EQ(Budget::parse("0").cost_in(world), 0);
  EXPECT_EQ(Budget::parse("1.1x").cost_in(world), 8);  // floor(8.8)
  const std::vector<Edge> edges = {{0, 1, 2}, {1, 2, 4}};
  const World weighted("weighted", Graph::from_edges(3, edges), std::vector<bool>(3));
  EXPECT_EQ(Budget::parse("1.4x").cost_in(weighted), 12);  // floor(4.2) · the mean cost 3
  EXPECT_EQ(Budget::parse("5").cost_in(weighted), 5);
  EXPECT_EQ(Budget::parse("1.25x").cost_in(world), 10);
  EXPECT_EQ(Budget::parse("1.1x").cost_in(grid_world("..........\n")), 11);  // not floor(10.999…)
}

TEST(Budget, RefusesWhatIsNoNumberFromZeroUp) {
  for (const char* text : {"-1", "nan", "inf", "", "x", "1.1xx", "25 ", "1e999", "abc", "-0.1x"}) {
    EXPECT_THAT(error_of([&] { Budget::parse(text); }), ::testing::HasSubstr("bad budget")) << text;
  }
  EXPECT_THAT(error_of([] { Budget::parse("1e12").cost_in(grid_world("..\n")); }), ::testing::HasSubstr("at most"));
  EXPECT_THAT(error_of([] { Budget::parse("1e9x").cost_in(grid_world("..\n")); }), ::testing::HasSubstr("at most"));
}

TEST(Budget, IsCheckedWhereverItComesFrom) {
  const World world = grid_world("..\n");
  EXPECT_EQ(checked_budget(world, 1e8), 1e8);
  EXPECT_THAT(error_of([&] { checked_budget(world, 1.1e8); }), ::testing::HasSubstr("at most 1e+08"));
}

}  // namespace
}  // namespace graphdrl
