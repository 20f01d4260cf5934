#include "graphdrl/env/load_worlds.h"

#include <gmock/gmock.h>

#include "support.h"

namespace graphdrl {
namespace {

using ::testing::HasSubstr;

TEST(ParseStart, IsANodeOrACell) {
  const World world = grid_world("...\n.#.\n");
  EXPECT_EQ(parse_start(world, "5"), 5);
  EXPECT_EQ(parse_start(world, "1,2"), 5);
  for (const char* text : {"6", "-1", "2,0", "0,3", "1,", "a", "", "1,2,3"}) {
    EXPECT_THAT(error_of([&] { parse_start(world, text); }), HasSubstr("start outside the map")) << text;
  }
  EXPECT_THAT(error_of([&] { parse_start(world, "4"); }), HasSubstr("start on an obstacle"));
  EXPECT_THAT(error_of([&] { parse_start(world, "1,1"); }), HasSubstr("start on an obstacle"));
}

TEST(LoadWorlds, TakesManySources) {
  EXPECT_EQ(load_worlds({"paper:b", "paper"}).size(), 11u);
  EXPECT_EQ(load_one_world("paper:b").valid_count(), 18);
  EXPECT_NE(error_of([] { load_one_world("paper"); }), "");
}

}  // namespace
}  // namespace graphdrl
