#include "graphdrl/report/picture.h"

#include <gmock/gmock.h>

#include <cmath>

#include "explored.h"
#include "graphdrl/io/picture.h"
#include "graphdrl/report/layout.h"
#include "support.h"

namespace graphdrl {
namespace {

using ::testing::HasSubstr;

int count(const std::string& text, const std::string& part) {
  int result = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++result;
  return result;
}

// How light a colour is [CIE 1976, L*].
double lightness(Colour colour) {
  const auto linear = [](double value) {
    value /= 255;
    return value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4);
  };
  const double y = 0.2126 * linear(colour.red) + 0.7152 * linear(colour.green) + 0.0722 * linear(colour.blue);
  return 116 * std::cbrt(y) - 16;
}

TEST(ColourScale, GetsLighterEvenly) {
  double last = lightness(colour_of_share(0));
  for (int i = 1; i <= 20; ++i) {
    const double next = lightness(colour_of_share(i / 20.0));
    EXPECT_GT(next - last, 1.5) << i;
    EXPECT_LT(next - last, 3.8) << i;
    last = next;
  }
  EXPECT_EQ(colour_of_share(-1), colour_of_share(0));
  EXPECT_EQ(colour_of_share(2), colour_of_share(1));
}

TEST(Picture, OfAFewCellsHasEveryNodeEdgeAndStep) {
  const World world = grid_world("...\n.#.\n");
  const std::string svg = Picture(world, std::vector<NodeId>{1, 0, 0, 1, 2}, "a <b> & c", {"visited 3"}).svg();
  EXPECT_EQ(count(svg, "L"), 7);             // edges, the only lines of paths
  EXPECT_EQ(count(svg, "<circle "), 6 + 3);  // and the ring around the start, and in the legend
  EXPECT_EQ(count(svg, "<polyline "), 3);    // a blocked move draws nothing
  EXPECT_THAT(svg, HasSubstr("<title>a &lt;b&gt; &amp; c</title>"));
  EXPECT_THAT(svg, HasSubstr(">visited 3</text>"));
  EXPECT_EQ(count(svg, "@keyframes"), 0);
  EXPECT_EQ(count(Picture(world, {}, "a", {}).svg(), "<polyline"), 0);
}

TEST(Picture, RunsOverAnEdgeAgainBesideIt) {
  const World world = grid_world("..\n");
  const std::string svg = Picture(world, std::vector<NodeId>{0, 1, 0}, "a", {}).svg();
  EXPECT_THAT(svg, HasSubstr("points=\"190,50 230,50\""));
  EXPECT_THAT(svg, HasSubstr("230,54 190,54\""));
}

TEST(FirstVisits, AreTheStepsOfTheWalk) {
  EXPECT_EQ(first_visits(grid_world("...\n.#.\n"), std::vector<NodeId>{1, 0, 1, 2}),
            (std::vector<int>{1, 0, 3, -1, -1, -1}));
}

TEST(Picture, MovesWithoutScript) {
  const World world = grid_world("...\n.#.\n");
  const std::string svg = Picture(world, std::vector<NodeId>{1, 0, 1, 2}, "a", {}).moving_svg();
  EXPECT_EQ(count(svg, "@keyframes"), 3);
  EXPECT_EQ(count(svg, "<script"), 0);
  EXPECT_THAT(svg, HasSubstr("prefers-reduced-motion: no-preference"));
}

TEST(Picture, OfManyCellsIsOneBitmap) {
  std::string map;
  for (int row = 0; row < 40; ++row) map += std::string(50, '.') + "\n";
  const World world = grid_world(map);
  const std::string svg = Picture(world, std::vector<NodeId>{0, 1}, "a", {}).svg();
  EXPECT_EQ(count(svg, "<image "), 1);
  EXPECT_LT(svg.size(), 8'000u);
}

// A walk over three cells of a row, which sees a column on and the row below.
TEST(Picture, HasFogOverWhatAWalkThatExploresHasNotSeen) {
  const World world = grid_world(".....\n.....\n");
  const std::vector<NodeId> walk = {0, 1, 2};
  const Picture picture(world, walk, "a", {}, Fog(explored(world, "edges", walk)));
  const std::string svg = picture.svg();
  const std::string unseen = R"(<g fill="#f6f7f9" stroke="#e0e4e9" stroke-width="1.5">)";
  const std::size_t begin = svg.find(unseen);
  ASSERT_NE(begin, std::string::npos);
  EXPECT_EQ(count(svg.substr(begin, svg.find("</g>", begin) - begin), "<circle "), 3) << "nodes 4, 8 and 9";
  EXPECT_THAT(svg, HasSubstr(">not seen</text>"));
  EXPECT_THAT(svg, HasSubstr(">not visited</text>"));
  EXPECT_EQ(count(svg, "fade"), 0);
  EXPECT_EQ(count(Picture(world, walk, "a", {}).svg(), "not seen"), 0);
  // Two steps show more: edges and nodes each give way to others.
  const std::string moving = picture.moving_svg();
  EXPECT_EQ(count(moving, "class=\"fade\" opacity=\"0\""), 4);
  EXPECT_EQ(count(moving, "class=\"fade\" opacity=\"1\""), 4);
  EXPECT_THAT(moving, HasSubstr("@keyframes f0{0%,43.59%{opacity:1}45%,100%{opacity:0}}"));
}

TEST(Picture, OfManyCellsHasBarsOfFogThatLift) {
  std::string map;
  for (int row = 0; row < 40; ++row) map += std::string(50, '.') + "\n";
  const World world = grid_world(map);
  const std::vector<NodeId> walk = {0, 1, 2};
  const Picture picture(world, walk, "a", {}, Fog(explored(world, "edges", walk)));
  EXPECT_EQ(count(picture.svg(), "<path "), 0);
  const std::string moving = picture.moving_svg();
  EXPECT_EQ(count(moving, "<path stroke=\"#cbd1da\""), 2);
  EXPECT_THAT(moving, HasSubstr("d=\"M64 40L84 40M44 60L64 60\"")) << "nodes 2 and 51, at step 1";
  const Bitmap pixels = picture.pixels();
  EXPECT_EQ(pixels.pixels[pixels.width * 100 + 100], (Colour{203, 209, 218}));
}

TEST(Picture, IsDrawnAsPng) {
  const World world = grid_world("...\n.#.\n");
  const std::string png = Picture(world, std::vector<NodeId>{1, 0, 1, 2}, "a", {"b"}).png();
  const Raster picture = read_picture(png, "picture");
  EXPECT_EQ(picture.width, 420);
  EXPECT_EQ(picture.samples.front(), 255);
  EXPECT_GT(std::count(picture.samples.begin(), picture.samples.end(), 255), picture.width * picture.height / 2);
  EXPECT_LT(*std::min_element(picture.samples.begin(), picture.samples.end()), 80);
}

// A path can be laid out as it is, a large one as well as a small one.
TEST(Layout, KeepsDistancesAndIsTheSameAgain) {
  for (const NodeId count : {3, 40, 3000}) {
    for (const EdgeKind kind : {EdgeKind::kUndirected, EdgeKind::kDirected}) {
      std::vector<Edge> edges;
      for (NodeId node = 1; node < count; ++node) edges.push_back({node, node - 1, 7});
      const Graph graph = Graph::from_edges(count, edges, kind);
      const std::vector<Point> points = lay_out(graph);
      ASSERT_EQ(std::ssize(points), count);
      const auto distance = [&](NodeId one, NodeId other) {
        return std::hypot(points[one].x - points[other].x, points[one].y - points[other].y);
      };
      EXPECT_NEAR(distance(0, count - 1), count - 1, 0.1 * count);
      EXPECT_NEAR(distance(0, count / 2), count / 2, 0.1 * count);
      EXPECT_NEAR(distance(count / 2, count / 2 + 1), 1, 0.4);
      EXPECT_EQ(lay_out(graph), points);
    }
  }
}

TEST(Layout, TakesAnyGraph) {
  for (const NodeId count : {1, 2, 2000}) {
    const std::vector<Point> points = lay_out(Graph::from_edges(count, {}));  // of single nodes
    ASSERT_EQ(std::ssize(points), count);
    for (const Point& point : points) EXPECT_TRUE(std::isfinite(point.x) && std::isfinite(point.y));
    EXPECT_TRUE(count == 1 || points[0] != points[1]);
  }
}

}  // namespace
}  // namespace graphdrl
