#include "graphdrl/report/map_drawing.h"

#include <gtest/gtest.h>

#include "support.h"

namespace graphdrl {
namespace {

TEST(DrawMapText, ShowsTheMap) {
  EXPECT_EQ(draw_map_text(grid_world("...\n.#.\n")), "...\n.#.\n");
}

TEST(FirstVisits, AreTheStepsOfTheWalk) {
  EXPECT_EQ(first_visits(grid_world("...\n.#.\n"), std::vector<NodeId>{1, 0, 1, 2}),
            (std::vector<int>{1, 0, 3, -1, -1, -1}));
}

}  // namespace
}  // namespace graphdrl
