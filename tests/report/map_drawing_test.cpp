#include "graphdrl/report/map_drawing.h"

#include <gtest/gtest.h>

#include "support.h"

namespace graphdrl {
namespace {

TEST(DrawMapText, ShowsTheMapAndTheStepsOfFirstVisits) {
  const World world = grid_world("...\n.#.\n");
  EXPECT_EQ(draw_map_text(world, {}), "...\n.#.\n");
  EXPECT_EQ(draw_map_text(world, std::vector<NodeId>{1, 0, 1, 2}), "1 0 3\n. # .\n");
}

}  // namespace
}  // namespace graphdrl
