#include "graphdrl/report/curve_figure.h"

#include <gmock/gmock.h>

namespace graphdrl {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::vector<double> heights(const std::vector<Point>& curve) {
  std::vector<double> out;
  for (const Point point : curve) out.push_back(point.y);
  return out;
}

TEST(CurveFigure, SmoothsOverTheLastPoints) {
  EXPECT_THAT(heights(smoothed({{10, 3}, {20, 5}, {30, 10}, {40, 0}}, 2)), ElementsAre(3, 4, 7.5, 5));
  EXPECT_THAT(heights(smoothed({{10, 3}, {20, 5}}, 10)), ElementsAre(3, 4));
}

TEST(CurveFigure, BandsHoldWhatAllCurvesReach) {
  const CurveBand band = band_of({{{1, 4}, {2, 6}, {3, 1}}, {{2, 2}, {3, 5}}, {{2, 1}, {3, 3}, {4, 9}}});
  EXPECT_THAT(heights(band.mean), ElementsAre(3, 3));
  EXPECT_THAT(heights(band.lowest), ElementsAre(1, 1));
  EXPECT_THAT(heights(band.highest), ElementsAre(6, 5));
  EXPECT_EQ(band.mean[0].x, 2);
}

TEST(CurveFigure, TicksAreRoundNumbers) {
  EXPECT_THAT(axis_ticks(0, 10'000), ElementsAre(0, 2000, 4000, 6000, 8000, 10000));
  EXPECT_THAT(axis_ticks(-8.3, -5.2), ElementsAre(-8, -7, -6));
  EXPECT_EQ(axis_ticks(0, 1).size(), 6u);
}

TEST(CurveFigure, DrawsLinesAndBandsWhereThereAreSeveralRuns) {
  const auto draw = [](const std::vector<std::vector<Point>>& curves) {
    const Point size = curve_figure_size(2);
    const auto canvas = make_svg_canvas(size.x, size.y, "Curves", "a note");
    draw_curves(*canvas, {{.title = "loss", .curves = curves}, {.title = "flat", .curves = {{{1, 2}, {2, 2}}}}},
                "episode", "a note");
    return canvas->finish();
  };
  const std::string one = draw({{{10, 1}, {20, 2}}});
  EXPECT_THAT(one, HasSubstr("loss"));
  EXPECT_THAT(one, HasSubstr("episode"));
  EXPECT_EQ(one.find("polygon"), std::string::npos);
  EXPECT_THAT(draw({{{10, 1}, {20, 2}}, {{10, 3}, {20, 1}}}), HasSubstr("polygon"));
  EXPECT_THAT(draw({{}}), HasSubstr("loss"));  // no point yet
}

}  // namespace
}  // namespace graphdrl
