#include "graphdrl/report/curve_figure.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace graphdrl {
namespace {

constexpr double kWidth = 300;
constexpr double kHeight = 190;
constexpr double kLeft = 50;
constexpr double kTop = 30;
constexpr double kBetween = 25;
constexpr double kBelow = 35;  // a panel: numbers and title of its axis
constexpr double kLabelSize = 11;
constexpr Colour kDark = {0x20, 0x20, 0x20};
constexpr Colour kRule = {0xdd, 0xdd, 0xdd};
constexpr Colour kLine = {0x00, 0x72, 0xb2};
constexpr Colour kBand = {0xc5, 0xdf, 0xee};

// Where a panel's curves are drawn.
struct Axes {
  Point corner;
  double last;  // of x, which begins at 0
  double low;   // of y
  double high;

  Point at(Point value) const {
    const double height = (std::clamp(value.y, low, high) - low) / (high - low);
    return {corner.x + kWidth * value.x / last, corner.y + kHeight * (1 - height)};
  }

  std::vector<Point> at(const std::vector<Point>& values) const {
    std::vector<Point> points(values.size());
    std::ranges::transform(values, points.begin(), [&](Point value) { return at(value); });
    return points;
  }

  void draw(Canvas& canvas, const std::string& title, const std::string& x_title) const {
    canvas.text({corner.x, corner.y - 10}, title, kLabelSize + 1, kDark, Anchor::kStart);
    for (const double tick : axis_ticks(low, high)) {
      const double y = at({0, tick}).y;
      canvas.segments(std::vector<Segment>{{{corner.x, y}, {corner.x + kWidth, y}}}, kRule, 1);
      canvas.text({corner.x - 6, y + 4}, fmt::format("{:g}", tick), kLabelSize, kDark, Anchor::kEnd);
    }
    for (const double tick : axis_ticks(0, last)) {
      const double x = at({tick, low}).x;
      canvas.text({x, corner.y + kHeight + 16}, fmt::format("{:g}", tick), kLabelSize, kDark, Anchor::kMiddle);
    }
    canvas.text({corner.x + kWidth / 2, corner.y + kHeight + 30}, x_title, kLabelSize, kDark, Anchor::kMiddle);
  }
};

Axes axes_of(const CurvePanel& panel, Point corner) {
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  double last = 0;
  for (const std::vector<Point>& curve : panel.curves) {
    for (const Point point : curve) {
      low = std::min(low, point.y);
      high = std::max(high, point.y);
      last = std::max(last, point.x);
    }
  }
  if (low > high) low = high = 0;  // no point at all
  low = panel.low.value_or(low);
  high = panel.high.value_or(high);
  return {corner, last > 0 ? last : 1, low, high > low ? high : low + std::max(1.0, std::abs(low))};
}

}  // namespace

CurveBand band_of(const std::vector<std::vector<Point>>& curves) {
  std::map<double, std::vector<double>> values;  // by x
  for (const std::vector<Point>& curve : curves) {
    for (const Point point : curve) values[point.x].push_back(point.y);
  }
  CurveBand band;
  for (const auto& [x, at_x] : values) {
    if (at_x.size() < curves.size()) continue;
    double sum = 0;
    for (const double value : at_x) sum += value;
    band.mean.push_back({x, sum / static_cast<double>(at_x.size())});
    band.lowest.push_back({x, *std::min_element(at_x.begin(), at_x.end())});
    band.highest.push_back({x, *std::max_element(at_x.begin(), at_x.end())});
  }
  return band;
}

std::vector<Point> smoothed(std::vector<Point> curve, std::size_t window) {
  const std::vector<Point> raw = curve;
  for (std::size_t i = 0; i < curve.size(); ++i) {
    const std::size_t first = i + 1 > window ? i + 1 - window : 0;
    double sum = 0;
    for (std::size_t j = first; j <= i; ++j) sum += raw[j].y;
    curve[i].y = sum / static_cast<double>(i + 1 - first);
  }
  return curve;
}

std::vector<double> axis_ticks(double low, double high) {
  const double range = high - low;
  double step = std::pow(10.0, std::floor(std::log10(range / 2)));
  for (const double factor : {1.0, 2.0, 5.0, 10.0}) {
    if (range / (factor * step) > 5) continue;
    step *= factor;
    break;
  }
  std::vector<double> ticks;
  const auto last = static_cast<std::int64_t>(std::floor(high / step + 1e-9));
  for (auto i = static_cast<std::int64_t>(std::ceil(low / step - 1e-9)); i <= last; ++i) {
    ticks.push_back(static_cast<double>(i) * step);
  }
  return ticks;
}

Point curve_figure_size(std::size_t panels) {
  const std::size_t rows = (panels + 1) / 2;
  return {2 * (kWidth + kLeft) + kBetween + 20, static_cast<double>(rows) * (kHeight + kTop + kBelow) + 25};
}

void draw_curves(Canvas& canvas, const std::vector<CurvePanel>& panels, const std::string& x_title,
                 const std::string& note) {
  const Point size = curve_figure_size(panels.size());
  canvas.rectangle({0, 0}, size.x, size.y, {0xff, 0xff, 0xff});
  for (std::size_t i = 0; i < panels.size(); ++i) {
    const std::size_t row = i / 2;
    const std::size_t column = i % 2;
    const Point corner = {kLeft + static_cast<double>(column) * (kWidth + kLeft + kBetween),
                          kTop + static_cast<double>(row) * (kHeight + kTop + kBelow)};
    const Axes axes = axes_of(panels[i], corner);
    const CurveBand band = band_of(panels[i].curves);
    if (panels[i].curves.size() > 1) {
      std::vector<Point> outline = axes.at(band.highest);
      const std::vector<Point> back = axes.at(band.lowest);
      outline.insert(outline.end(), back.rbegin(), back.rend());
      canvas.polygon(outline, kBand);
    }
    axes.draw(canvas, panels[i].title, x_title);
    const std::vector<Point> line = axes.at(band.mean);
    std::vector<Segment> segments;
    for (std::size_t j = 1; j < line.size(); ++j) segments.push_back({line[j - 1], line[j]});
    canvas.segments(segments, kLine, 1.5);
  }
  canvas.text({kLeft, size.y - 8}, note, kLabelSize, kDark, Anchor::kStart);
}

}  // namespace graphdrl
