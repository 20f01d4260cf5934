// Curves of trainings as a picture of panels, two a row.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "graphdrl/graph/point.h"
#include "graphdrl/report/canvas.h"

namespace graphdrl {

struct CurvePanel {
  std::string title;
  std::vector<std::vector<Point>> curves;  // one a run; x ascends
  std::optional<double> low = {};          // of the axis; if empty, as low as the curves need
  std::optional<double> high = {};
};

// The mean, the lowest and the highest of several curves, at each x that all of them have.
struct CurveBand {
  std::vector<Point> mean;
  std::vector<Point> lowest;   // as long as the mean
  std::vector<Point> highest;  // as long as the mean
};
CurveBand band_of(const std::vector<std::vector<Point>>& curves);

// The mean over the last `window` points, fewer at the beginning.
std::vector<Point> smoothed(std::vector<Point> curve, std::size_t window);

// About five round numbers from low to high. REQUIRES: low < high.
std::vector<double> axis_ticks(double low, double high);

// Width and height of the picture, in pixels.
Point curve_figure_size(std::size_t panels);

// Draws each panel's mean as a line, and the band of several curves. x_title: under each panel. note: at the bottom.
void draw_curves(Canvas& canvas, const std::vector<CurvePanel>& panels, const std::string& x_title,
                 const std::string& note);

}  // namespace graphdrl
