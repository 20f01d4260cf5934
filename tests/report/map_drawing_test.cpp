#include "graphdrl/report/map_drawing.h"

#include <gmock/gmock.h>

#include "support.h"

namespace graphdrl {
namespace {

using ::testing::HasSubstr;

int count(const std::string& text, const std::string& part) {
  int result = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++result;
  return result;
}

TEST(DrawMapText, ShowsTheMapAndTheStepsOfFirstVisits) {
  const World world = grid_world("...\n.#.\n");
  EXPECT_EQ(draw_map_text(world, {}), "...\n.#.\n");
  EXPECT_EQ(draw_map_text(world, std::vector<NodeId>{1, 0, 1, 2}), "1 0 3\n. # .\n");
}

TEST(DrawMapSvg, HasEveryNodeEdgeAndStep) {
  const World world = grid_world("...\n.#.\n");
  const std::string svg = draw_map_svg(world, std::vector<NodeId>{1, 0, 0, 1, 2});
  EXPECT_EQ(count(svg, "<line "), 7);
  EXPECT_EQ(count(svg, "<circle "), 6 + 1);  // and the ring around the start
  EXPECT_EQ(count(svg, "#d64550"), 1);
  // 1 to 0, back beside it, on to 2; the blocked move draws nothing.
  EXPECT_THAT(svg, HasSubstr("points=\"70,30 30,30 30,34 70,34 70,30 110,30\""));
  EXPECT_EQ(count(draw_map_svg(world, {}), "<polyline"), 0);
}

}  // namespace
}  // namespace graphdrl
