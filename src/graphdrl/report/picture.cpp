#include "graphdrl/report/picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "graphdrl/report/layout.h"

namespace graphdrl {
namespace {

constexpr double kMargin = 24;
constexpr double kTextSize = 13;
constexpr double kLineHeight = 19;
constexpr double kTitleHeight = 30;
constexpr double kLeastWidth = 420;
constexpr double kLeastWidthInFog = 600;  // has more to say
constexpr double kSide = 1000;            // of the map, in pixels, if its cells are not too large or too small for that

constexpr int kFewCells = 200;  // drawn as nodes and edges
constexpr double kFewCellsSpacing = 40;
constexpr double kMostCellPixels = 24;
constexpr double kLinePixels = 5;  // larger cells have the walk as a line; smaller ones are coloured themselves

constexpr NodeId kMostWithLabels = 60;
constexpr std::int64_t kMostEdgesDrawn = 300'000;
constexpr std::int64_t kMostArrows = 400;
constexpr int kWalkParts = 64;  // of one colour each
constexpr std::size_t kMostMovingSteps = 200'000;

constexpr Colour kPaper = {255, 255, 255};
constexpr Colour kInk = {33, 38, 46};
constexpr Colour kQuiet = {96, 105, 118};
constexpr Colour kEdge = {196, 203, 212};
constexpr Colour kFree = {244, 246, 248};
constexpr Colour kVisited = {226, 232, 240};
constexpr Colour kBlocked = {74, 81, 92};
constexpr Colour kMissed = {250, 190, 140};
constexpr Colour kMissedLine = {178, 84, 12};
constexpr Colour kFog = {203, 209, 218};  // over cells
constexpr Colour kBlockedInFog = {184, 191, 201};
constexpr Colour kFaint = {246, 247, 249};  // nodes
constexpr Colour kFaintLine = {224, 228, 233};
constexpr Colour kFaintBlocked = {212, 217, 223};
constexpr Colour kFaintText = {168, 176, 186};

// Points in a direction. spread: of its back corners, from there.
std::array<Point, 3> triangle(Point centre, double angle, double length, double spread) {
  const auto corner = [&](double turn) {
    return Point{centre.x + length * std::cos(angle + turn), centre.y + length * std::sin(angle + turn)};
  };
  return {corner(0), corner(spread), corner(-spread)};
}

// What is drawn, by the part of the walk that shows it. First what is known from the beginning, last what never is.
template <typename Item>
using Parts = std::array<std::vector<Item>, kWalkParts + 2>;

// The share of the walk's time at which a part begins. The first is number 1.
double begin_of(int part) {
  return (part - 1.0) / kWalkParts;
}

// draw(items, faint): draws some of them. What is faint lies below the rest.
template <typename Item, typename Draw>
void draw_parts(Canvas& canvas, const Parts<Item>& parts, const Draw& draw) {
  draw(parts.back(), true);
  for (int part = 1; part <= kWalkParts; ++part) {
    if (parts[part].empty()) continue;
    canvas.fade_out(begin_of(part), begin_of(part + 1), [&] { draw(parts[part], true); });
  }
  draw(parts.front(), false);
  for (int part = 1; part <= kWalkParts; ++part) {
    if (parts[part].empty()) continue;
    canvas.fade_in(begin_of(part), begin_of(part + 1), [&] { draw(parts[part], false); });
  }
}

}  // namespace

std::vector<int> first_visits(const World& world, std::span<const NodeId> walk) {
  std::vector<int> steps(world.node_count(), -1);
  for (std::size_t step = 0; step < walk.size(); ++step) {
    if (steps[walk[step]] < 0) steps[walk[step]] = static_cast<int>(step);
  }
  return steps;
}

Picture::Picture(const World& world, std::span<const NodeId> walk, std::string title, std::vector<std::string> notes,
                 Fog fog)
    : world_(world),
      walk_(walk.begin(), walk.end()),
      title_(std::move(title)),
      notes_(std::move(notes)),
      fog_(std::move(fog)),
      first_visits_(first_visits(world, walk)) {
  cells_ = world.has_cells() && world.node_count() > kFewCells;
  if (world.has_cells()) {
    place_cells();
  } else {
    place_nodes();
  }
}

void Picture::place_cells() {
  const GridMap& map = *world_.map();
  const double size = std::floor(kSide / std::max(map.rows, map.cols));
  spacing_ = cells_ ? std::clamp(size, 1.0, kMostCellPixels) : kFewCellsSpacing;
  width_ = std::max(fog_.empty() ? kLeastWidth : kLeastWidthInFog, 2 * kMargin + spacing_ * map.cols);
  map_bottom_ = kTitleHeight + spacing_ * map.rows;
  const double left = (width_ - spacing_ * map.cols) / 2;
  places_.reserve(static_cast<std::size_t>(world_.node_count()));
  for (NodeId node = 0; node < world_.node_count(); ++node) {
    const Cell cell = map.cell(node);
    places_.push_back({left + spacing_ * (cell.col + 0.5), kTitleHeight + spacing_ * (cell.row + 0.5)});
  }
}

void Picture::place_nodes() {
  const std::vector<Point> points = places_of(world_);
  const auto [left, bottom, right, top] = box_of(points);
  // Away from the equator degrees of longitude are shorter than those of latitude.
  const bool degrees = world_.unit() == "degrees";
  const double stretch = degrees ? std::max(0.05, std::cos((bottom + top) / 2 * std::numbers::pi / 180)) : 1;
  const double across = (right - left) * stretch;
  const double up = top - bottom;
  const double nodes = world_.node_count();
  const double inner = std::clamp(90 * std::sqrt(nodes), 320.0, kSide);
  const double scale = std::max(across, up) > 0 ? inner / std::max(across, up) : 1;
  const double padding = kMargin + 10;
  width_ = std::ceil(std::max(fog_.empty() ? kLeastWidth : kLeastWidthInFog, 2 * padding + scale * across));
  map_bottom_ = kTitleHeight + 2 * padding + scale * up;
  const double shift = (width_ - scale * across) / 2;
  for (const Point& point : points) {
    places_.push_back({shift + scale * stretch * (point.x - left), kTitleHeight + padding + scale * (top - point.y)});
  }
  spacing_ = std::sqrt(std::max(1.0, scale * across) * std::max(1.0, scale * up) / nodes);
  spacing_ = std::clamp(std::max(spacing_, inner / nodes), 3.0, kFewCellsSpacing);
}

double Picture::height() const {
  const double legend = walk_.empty() ? 0 : kLineHeight + 6;
  return std::ceil(map_bottom_ + 14 + legend + kLineHeight * static_cast<double>(notes_.size()) + 10);
}

std::string Picture::description() const {
  std::string text;
  for (const std::string& note : notes_) text += note + ". ";
  return text;
}

std::string Picture::drawn_on(Canvas& canvas) const {
  draw(canvas);
  return canvas.finish();
}

std::string Picture::svg() const {
  return drawn_on(*make_svg_canvas(width_, height(), title_, description()));
}

std::string Picture::moving_svg() const {
  const double steps = static_cast<double>(std::min(walk_.size(), kMostMovingSteps));
  return drawn_on(*make_svg_canvas(width_, height(), title_, description(), std::clamp(0.12 * steps, 4.0, 24.0)));
}

std::string Picture::png() const {
  return drawn_on(*make_png_canvas(width_, height()));
}

Bitmap Picture::pixels() const {
  return draw_bitmap(width_, height(), [&](Canvas& canvas) { draw(canvas); });
}

void Picture::draw(Canvas& canvas) const {
  canvas.rectangle({0, 0}, width_, height(), kPaper);
  canvas.text({width_ / 2, 20}, title_, kTextSize + 2, kInk, Anchor::kMiddle);
  if (cells_) {
    draw_cells(canvas);
  } else {
    draw_edges(canvas);
    draw_nodes(canvas);
  }
  if (!walk_.empty()) draw_walk(canvas);
  draw_legend(canvas);
}

Colour Picture::colour_at(std::size_t step) const {
  const std::size_t last = std::max<std::size_t>(1, walk_.size() - 1);
  return colour_of_share(static_cast<double>(step) / static_cast<double>(last));
}

// Where draw_parts() looks for what becomes known at a step.
std::size_t Picture::part_at(int step) const {
  if (step < 0) return kWalkParts + 1;
  const std::size_t steps = std::max<std::size_t>(1, walk_.size() - 1);
  return (step * std::size_t{kWalkParts} + steps - 1) / steps;
}

void Picture::draw_cells(Canvas& canvas) const {
  const GridMap& map = *world_.map();
  std::array<Colour, 256> scale{};
  for (std::size_t i = 0; i < scale.size(); ++i) scale[i] = colour_of_share(static_cast<double>(i) / 255);
  Bitmap bitmap{.width = map.cols, .height = map.rows, .pixels = {}};
  bitmap.pixels.reserve(map.blocked.size());
  const double last = std::max<double>(1, static_cast<double>(walk_.size()) - 1);
  for (NodeId node = 0; node < world_.node_count(); ++node) {
    if (fog_.lifts_at(node) < 0) {
      bitmap.pixels.push_back(world_.is_blocked(node) ? kBlockedInFog : kFog);
      continue;
    }
    const int visited = first_visits_[node];
    const Colour by_step = scale[static_cast<std::size_t>(255 * std::max(visited, 0) / last)];
    bitmap.pixels.push_back(world_.is_blocked(node)  ? kBlocked
                            : walk_.empty()          ? kFree
                            : visited < 0            ? kMissed
                            : spacing_ < kLinePixels ? by_step
                                                     : kVisited);
  }
  const Point first = places_.front();
  canvas.bitmap(bitmap, {first.x - spacing_ / 2, first.y - spacing_ / 2}, spacing_ * map.cols);
  if (!fog_.empty()) draw_fog_of_cells(canvas);
}

// A bar lies over each run of cells in a row until they are seen.
void Picture::draw_fog_of_cells(Canvas& canvas) const {
  Parts<Segment> free;
  Parts<Segment> blocked;
  const int cols = world_.map()->cols;
  for (NodeId begin = 0, end = 0; begin < world_.node_count(); begin = end) {
    const std::size_t part = part_at(fog_.lifts_at(begin));
    const bool is_blocked = world_.is_blocked(begin);
    for (end = begin + 1; end % cols != 0; ++end) {
      if (part_at(fog_.lifts_at(end)) != part || world_.is_blocked(end) != is_blocked) break;
    }
    const Point from = places_[begin];
    const Point to = places_[end - 1];
    (is_blocked ? blocked : free)[part].push_back({{from.x - spacing_ / 2, from.y}, {to.x + spacing_ / 2, to.y}});
  }
  for (int part = 1; part <= kWalkParts; ++part) {
    if (free[part].empty() && blocked[part].empty()) continue;
    canvas.fade_out(begin_of(part), begin_of(part + 1), [&] {
      canvas.segments(free[part], kFog, spacing_);
      canvas.segments(blocked[part], kBlockedInFog, spacing_);
    });
  }
}

void Picture::draw_edges(Canvas& canvas) const {
  const Graph& graph = world_.graph();
  if (graph.is_complete() || graph.edge_count() > kMostEdgesDrawn) return;
  Parts<Edge> parts;
  for (const Edge& edge : graph.edges()) parts[part_at(fog_.lifts_at(edge))].push_back(edge);
  const double line = std::clamp(spacing_ / 20, 0.4, 2.0);
  draw_parts(canvas, parts, [&](const std::vector<Edge>& edges, bool faint) {
    std::vector<Segment> open;
    std::vector<Segment> closed;
    for (const Edge& edge : edges) {
      const bool blocked = world_.is_blocked(edge.a) || world_.is_blocked(edge.b);
      (blocked ? closed : open).push_back({places_[edge.a], places_[edge.b]});
    }
    canvas.segments(closed, faint ? kFaintLine : kVisited, line);
    canvas.segments(open, faint ? kFaintLine : kEdge, line);
    if (!graph.directed() || graph.edge_count() > kMostArrows) return;
    for (const Segment& segment : open) {
      // In the middle, where they do not meet.
      const Point middle{(segment.from.x + 2 * segment.to.x) / 3, (segment.from.y + 2 * segment.to.y) / 3};
      const double angle = std::atan2(segment.to.y - segment.from.y, segment.to.x - segment.from.x);
      canvas.polygon(triangle(middle, angle, 5, 2.6), faint ? kFaintLine : kEdge);
    }
  });
}

void Picture::draw_nodes(Canvas& canvas) const {
  Parts<NodeId> parts;
  for (NodeId node = 0; node < world_.node_count(); ++node) parts[part_at(fog_.lifts_at(node))].push_back(node);
  const double radius = std::clamp(spacing_ * 0.225, 1.0, 9.0);
  const double line = std::clamp(radius / 6, 0.3, 1.5);
  draw_parts(canvas, parts, [&](const std::vector<NodeId>& nodes, bool faint) {
    std::vector<Point> free;
    std::vector<Point> visited;
    std::vector<Point> missed;
    std::vector<Point> blocked;
    for (const NodeId node : nodes) {
      auto& kind = world_.is_blocked(node)   ? blocked
                   : walk_.empty() || faint  ? free
                   : first_visits_[node] < 0 ? missed
                                             : visited;
      kind.push_back(places_[node]);
    }
    const auto discs = [&](const std::vector<Point>& points, Colour fill, Colour stroke) {
      canvas.discs(points, {.radius = radius, .fill = fill, .stroke = stroke, .stroke_width = line});
    };
    discs(blocked, faint ? kFaintBlocked : kBlocked, faint ? kFaintBlocked : kInk);
    discs(free, faint ? kFaint : kPaper, faint ? kFaintLine : kQuiet);
    discs(visited, kVisited, kQuiet);
    discs(missed, kMissed, kMissedLine);
    if (world_.labels().empty() || world_.node_count() > kMostWithLabels) return;
    for (const NodeId node : nodes) {
      canvas.text({places_[node].x, places_[node].y - radius - 4}, world_.labels()[node], 11, faint ? kFaintText : kInk,
                  Anchor::kMiddle);
    }
  });
}

void Picture::draw_walk(Canvas& canvas) const {
  const double line = std::clamp(spacing_ / 14, 0.8, 3.0);
  const bool lines = !cells_ || spacing_ >= kLinePixels;
  // A run over an edge that was walked before is drawn beside the earlier ones.
  std::map<std::pair<NodeId, NodeId>, int> runs;
  const std::size_t steps = walk_.size() - 1;
  Point from = places_[walk_.front()];
  Point to = from;
  Point last = from;
  for (int part = 0; lines && part < kWalkParts; ++part) {
    const std::size_t begin = steps * part / kWalkParts;
    const std::size_t end = steps * (part + 1) / kWalkParts;
    std::vector<Point> points;
    for (std::size_t step = begin; step < end; ++step) {
      if (walk_[step] == walk_[step + 1]) continue;  // a blocked move
      const int run = runs[std::minmax(walk_[step], walk_[step + 1])]++;
      const int lane = (run % 2 == 1 ? 1 : -1) * ((run + 1) / 2);  // 0, 1, -1, 2, …
      const double beside = lane * std::min(4.0, spacing_ / 6);
      const Point a = places_[walk_[step]];
      const Point b = places_[walk_[step + 1]];
      const double length = std::max(1e-9, std::hypot(b.x - a.x, b.y - a.y));
      // To the same side in both directions of the edge.
      const double side = walk_[step] < walk_[step + 1] ? beside : -beside;
      const Point shift{-side * (b.y - a.y) / length, side * (b.x - a.x) / length};
      from = {a.x + shift.x, a.y + shift.y};
      to = {b.x + shift.x, b.y + shift.y};
      if (points.empty() && step > 0) points.push_back(last);
      points.push_back(from);
      points.push_back(to);
      last = to;
    }
    if (points.empty()) continue;
    const double all = static_cast<double>(steps);
    canvas.walk_part(points, colour_at((begin + end) / 2), line, static_cast<double>(begin) / all,
                     static_cast<double>(end) / all);
  }
  const double radius = std::clamp(spacing_ * 0.3, 5.0, 12.0);
  if (lines && steps > 0) draw_arrow_head(canvas, from, to);
  const Point start = places_[walk_.front()];
  canvas.discs({&start, 1}, {.radius = radius, .stroke = kPaper, .stroke_width = 5});
  canvas.discs({&start, 1}, {.radius = radius, .stroke = colour_at(0), .stroke_width = 3});
  if (lines && steps > 0) return;
  const Point end = places_[walk_.back()];
  canvas.discs({&end, 1}, {.radius = radius * 0.8, .fill = colour_at(steps), .stroke = kInk, .stroke_width = 2});
}

void Picture::draw_arrow_head(Canvas& canvas, Point from, Point to) const {
  const double angle = std::atan2(to.y - from.y, to.x - from.x);
  const double size = std::clamp(spacing_ / 4, 6.0, 11.0);
  canvas.polygon(triangle(to, angle, size + 2.5, 2.5), kInk);
  canvas.polygon(triangle(to, angle, size, 2.5), colour_at(walk_.size() - 1));
}

void Picture::draw_legend(Canvas& canvas) const {
  double y = map_bottom_ + 20;
  double x = kMargin;
  const auto say = [&](const std::string& text) {
    canvas.text({x, y}, text, kTextSize - 1, kQuiet, Anchor::kStart);
    x += 6.6 * static_cast<double>(text.size()) + 16;
  };
  const auto explain = [&](Colour colour, const std::string& meaning) {
    canvas.rectangle({x, y - 9}, 10, 10, colour);
    x += 16;
    say(meaning);
  };
  if (!walk_.empty()) {
    const Point ring{x + 6, y - 4};
    canvas.discs({&ring, 1}, {.radius = 5, .stroke = colour_at(0), .stroke_width = 3});
    x += 18;
    say("start");
    for (int i = 0; i < 48; ++i) canvas.rectangle({x + 2.0 * i, y - 9}, 2.2, 10, colour_of_share(i / 47.0));
    x += 104;
    say("end");
    const auto any_valid = [&](const auto& is_so) { return std::ranges::any_of(world_.valid_nodes(), is_so); };
    const auto unseen = [&](NodeId node) { return fog_.lifts_at(node) < 0; };
    if (any_valid([&](NodeId node) { return first_visits_[node] < 0 && !unseen(node); })) {
      explain(kMissed, "not visited");
    }
    if (any_valid(unseen)) explain(cells_ ? kFog : kFaintLine, "not seen");
    if (world_.valid_count() < world_.node_count()) explain(kBlocked, "blocked");
    y += kLineHeight + 4;
  }
  for (const std::string& note : notes_) {
    canvas.text({kMargin, y}, note, kTextSize, kInk, Anchor::kStart);
    y += kLineHeight;
  }
}

}  // namespace graphdrl
