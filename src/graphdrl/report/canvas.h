// What pictures are drawn on: SVG as text, or PNG by way of Cairo.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "graphdrl/graph/point.h"
#include "graphdrl/report/colour.h"

namespace graphdrl {

// Pixels, row by row from the top.
struct Bitmap {
  int width = 0;
  int height = 0;
  std::vector<Colour> pixels;  // [width * height]
};

struct Segment {
  Point from;
  Point to;
};

struct Disc {
  double radius;
  std::optional<Colour> fill = {};
  std::optional<Colour> stroke = {};
  double stroke_width = 1;
};

enum class Anchor { kStart, kMiddle, kEnd };

// Units are pixels of the picture, y downward. What is drawn later covers what was drawn before.
class Canvas {
 public:
  virtual ~Canvas() = default;

  virtual void rectangle(Point corner, double width, double height, Colour fill) = 0;
  // Every pixel a square, sharp, of width / bitmap.width.
  virtual void bitmap(const Bitmap& bitmap, Point corner, double width) = 0;
  virtual void segments(std::span<const Segment> segments, Colour colour, double width) = 0;
  virtual void discs(std::span<const Point> centres, const Disc& disc) = 0;
  virtual void polygon(std::span<const Point> corners, Colour fill) = 0;
  virtual void text(Point at, std::string_view text, double size, Colour colour, Anchor anchor) = 0;

  // A part of the walk, between two shares of its time, at which a moving picture draws it.
  virtual void walk_part(std::span<const Point> points, Colour colour, double width, double begin, double end) = 0;

  // What `draw` draws fades in, or out, between two shares of the walk's time. A still picture shows how it ends.
  virtual void fade_in(double begin, double end, const std::function<void()>& draw) = 0;
  virtual void fade_out(double begin, double end, const std::function<void()>& draw) = 0;

  // The bytes of the file.
  virtual std::string finish() = 0;
};

// title, description: what screen readers say. seconds: the length of a moving picture, which repeats itself by CSS
// alone; empty: a still picture.
std::unique_ptr<Canvas> make_svg_canvas(double width, double height, const std::string& title,
                                        const std::string& description, std::optional<double> seconds = {});

// REQUIRES: at most kMostPngSide a side.
inline constexpr int kMostPngSide = 32'000;
std::unique_ptr<Canvas> make_png_canvas(double width, double height);

// What `draw` draws, as pixels. REQUIRES: likewise.
Bitmap draw_bitmap(double width, double height, const std::function<void(Canvas&)>& draw);

}  // namespace graphdrl
