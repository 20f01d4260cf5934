#include "graphdrl/env/budget.h"

#include <gmock/gmock.h>

#include "support.h"

namespace graphdrl {
namespace {

TEST(Budget, IsStepsOrAMultipleOfTheValidNodes) {
  const World world = grid_world("...\n.#.\n...\n");  // 8 valid nodes
  EXPECT_EQ(Budget::parse("25").steps_in(world), 25);
  EXPECT_EQ(Budget::parse("0").steps_in(world), 0);
  EXPECT_EQ(Budget::parse("1.1x").steps_in(world), 8);  // floor(8.8)
  EXPECT_EQ(Budget::parse("1.25x").steps_in(world), 10);
  EXPECT_EQ(Budget::parse("1.1x").steps_in(grid_world("..........\n")), 11);  // not floor(10.999…)
}

TEST(Budget, RefusesWhatIsNoNumberFromZeroUp) {
  for (const char* text : {"-1", "nan", "inf", "", "x", "1.1xx", "25 ", "1e999", "abc", "-0.1x", "1e12"}) {
    EXPECT_THAT(error_of([&] { Budget::parse(text); }), ::testing::HasSubstr("bad budget")) << text;
  }
  EXPECT_THAT(error_of([] { Budget::parse("1e9x").steps_in(grid_world("..\n")); }), ::testing::HasSubstr("at most"));
}

}  // namespace
}  // namespace graphdrl
