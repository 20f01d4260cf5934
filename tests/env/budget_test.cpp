#include "graphdrl/env/task.h"

#include <gmock/gmock.h>

#include <cmath>

#include "graphdrl/planners/registry.h"
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
  for (const char* text : {"-1", "nan", "", "x", "1.1xx", "25 ", "1e999", "abc", "-0.1x"}) {
    EXPECT_THAT(error_of([&] { Budget::parse(text); }), ::testing::HasSubstr("bad budget")) << text;
  }
}

TEST(Budget, IsEnoughWhereItIsMoreThanEnough) {
  const World world = grid_world("...\n");
  for (const char* const text : {"1000", "1e12", "1e300", "1e9x", "inf"}) {
    const Task task(world, {.budget = Budget::parse(text)});
    EXPECT_LE(task.limit(), static_cast<double>(kMaxSteps)) << text;
    EXPECT_TRUE(std::isfinite(task.budget())) << text;
    EXPECT_EQ(make_planner("search")->plan(task).visited, 3) << text;
  }
}

}  // namespace
}  // namespace graphdrl
