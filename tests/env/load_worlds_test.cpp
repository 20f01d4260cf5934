#include "graphdrl/env/load_worlds.h"

#include <gmock/gmock.h>

#include "support.h"

namespace graphdrl {
namespace {

using ::testing::HasSubstr;

TEST(ParseNode, IsANodeOrACell) {
  const World world = grid_world("...\n.#.\n");
  EXPECT_EQ(parse_node(world, "5", "start"), 5);
  EXPECT_EQ(parse_node(world, "1,2", "start"), 5);
  EXPECT_EQ(parse_node(world, "#5", "start"), 5);
  for (const char* text : {"6", "-1", "2,0", "0,3", "1,", "a", "", "1,2,3"}) {
    EXPECT_THAT(error_of([&] { parse_node(world, text, "start"); }), HasSubstr("start outside the map")) << text;
  }
  EXPECT_THAT(error_of([&] { parse_node(world, "4", "start"); }), HasSubstr("start on an obstacle"));
  EXPECT_THAT(error_of([&] { parse_node(world, "1,1", "start"); }), HasSubstr("start on an obstacle"));
}

TEST(ParseNode, IsALabelWhereThereAreLabels) {
  const World world("plant", Graph::from_edges(4, {}), {false, false, false, true}, {"dock", "0", "#1", "wall"});
  EXPECT_EQ(parse_node(world, "dock", "start"), 0);
  EXPECT_EQ(parse_node(world, "0", "start"), 1);
  EXPECT_EQ(parse_node(world, "#0", "start"), 0);
  EXPECT_EQ(parse_node(world, "#1", "start"), 2) << "a label comes first";
  for (const char* text : {"2", "1", "door", "", "#4", "#", "#-1", "#x"}) {
    EXPECT_THAT(error_of([&] { parse_node(world, text, "end"); }),
                HasSubstr("end outside the map: expected a label of the map, or #N for node id N, got"))
        << text;
  }
  EXPECT_THAT(error_of([&] { parse_node(world, "#3", "end"); }), HasSubstr("end on an obstacle"));
}

TEST(LoadWorlds, TakesManySources) {
  EXPECT_EQ(load_worlds({"paper:b", "paper"}).size(), 11u);
  EXPECT_EQ(load_one_world("paper:b").valid_count(), 18);
  EXPECT_NE(error_of([] { load_one_world("paper"); }), "");
}

}  // namespace
}  // namespace graphdrl
