#include "graphdrl/report/map_drawing.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

namespace graphdrl {
namespace {

constexpr double kSpacing = 40;  // pixels from node to node
constexpr double kMargin = 30;
constexpr double kRadius = 9;
constexpr double kLane = 4;  // pixels between two runs over the same edge

struct Point {
  double x;
  double y;
};

Point centre(const GridMap& map, NodeId node) {
  const Cell cell = map.cell(node);
  return {kMargin + kSpacing * cell.col, kMargin + kSpacing * cell.row};
}

// The step at which each node was first visited; -1 where never.
std::vector<int> first_visits(const World& world, std::span<const NodeId> walk) {
  std::vector<int> steps(world.graph().node_count(), -1);
  for (std::size_t step = 0; step < walk.size(); ++step) {
    if (steps[walk[step]] < 0) steps[walk[step]] = static_cast<int>(step);
  }
  return steps;
}

std::string draw_edges(const World& world) {
  const GridMap& map = *world.map();
  std::string svg = "<g stroke=\"#b8bec7\" stroke-width=\"2\">\n";
  for (NodeId node = 0; node < world.graph().node_count(); ++node) {
    for (const NodeId next : world.graph().neighbours(node)) {
      if (next < node) continue;
      const Point a = centre(map, node);
      const Point b = centre(map, next);
      const bool open = !world.is_blocked(node) && !world.is_blocked(next);
      svg += fmt::format("<line x1=\"{:g}\" y1=\"{:g}\" x2=\"{:g}\" y2=\"{:g}\"{}/>\n", a.x, a.y, b.x, b.y,
                         open ? "" : " stroke=\"#e8ebef\"");
    }
  }
  return svg + "</g>\n";
}

std::string draw_nodes(const World& world, const std::vector<int>& visited_at) {
  const GridMap& map = *world.map();
  std::string svg;
  for (NodeId node = 0; node < world.graph().node_count(); ++node) {
    const Point at = centre(map, node);
    const char* const fill = world.is_blocked(node) ? "#d64550" : visited_at[node] >= 0 ? "#cfe3f5" : "#ffffff";
    const char* const stroke = world.is_blocked(node) ? "#a8323c" : "#5b6675";
    svg += fmt::format("<circle cx=\"{:g}\" cy=\"{:g}\" r=\"{:g}\" fill=\"{}\" stroke=\"{}\" stroke-width=\"1.5\"/>\n",
                       at.x, at.y, kRadius, fill, stroke);
  }
  return svg;
}

// The walk as one line. A run over an edge that was walked before keeps beside the earlier ones.
std::string draw_walk(const World& world, std::span<const NodeId> walk) {
  const GridMap& map = *world.map();
  std::map<std::pair<NodeId, NodeId>, int> runs;
  std::string points;
  for (std::size_t i = 1; i < walk.size(); ++i) {
    if (walk[i] == walk[i - 1]) continue;  // a blocked move
    const int run = runs[std::minmax(walk[i], walk[i - 1])]++;
    const Point a = centre(map, walk[i - 1]);
    const Point b = centre(map, walk[i]);
    const int place = (run % 2 == 1 ? 1 : -1) * ((run + 1) / 2);  // 0, 1, -1, 2, …
    const double lane = place * kLane;
    const bool across = a.y == b.y;
    const double dx = across ? 0 : lane;
    const double dy = across ? lane : 0;
    points += fmt::format("{}{:g},{:g} {:g},{:g}", points.empty() ? "" : " ", a.x + dx, a.y + dy, b.x + dx, b.y + dy);
  }
  const Point start = centre(map, walk.front());
  std::string svg;
  if (!points.empty()) {
    svg += fmt::format(
        "<polyline points=\"{}\" fill=\"none\" stroke=\"#1f6fb5\" stroke-width=\"2.5\" stroke-linejoin=\"round\" "
        "stroke-linecap=\"round\" marker-end=\"url(#end)\"/>\n",
        points);
  }
  svg +=
      fmt::format("<circle cx=\"{:g}\" cy=\"{:g}\" r=\"{:g}\" fill=\"none\" stroke=\"#1f6fb5\" stroke-width=\"3\"/>\n",
                  start.x, start.y, kRadius + 3);
  return svg;
}

}  // namespace

std::string draw_map_text(const World& world, std::span<const NodeId> walk) {
  const GridMap& map = *world.map();
  const std::vector<int> visited_at = first_visits(world, walk);
  const std::size_t width = walk.empty() ? 1 : fmt::format("{}", walk.size() - 1).size() + 1;
  std::string text;
  for (int row = 0; row < map.rows; ++row) {
    std::string line;
    for (int col = 0; col < map.cols; ++col) {
      const NodeId node = map.node({row, col});
      const std::string cell = world.is_blocked(node)  ? "#"
                               : visited_at[node] >= 0 ? fmt::format("{}", visited_at[node])
                                                       : ".";
      line += fmt::format("{:>{}}", cell, width);
    }
    text += line.substr(walk.empty() ? 0 : 1) + '\n';
  }
  return text;
}

std::string draw_map_svg(const World& world, std::span<const NodeId> walk) {
  const GridMap& map = *world.map();
  const double width = 2 * kMargin + kSpacing * (map.cols - 1);
  const double height = 2 * kMargin + kSpacing * (map.rows - 1);
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:g}\" height=\"{1:g}\" viewBox=\"0 0 {0:g} {1:g}\">\n"
      "<defs><marker id=\"end\" viewBox=\"0 0 10 10\" refX=\"7\" refY=\"5\" markerWidth=\"5\" markerHeight=\"5\" "
      "orient=\"auto\"><path d=\"M0,0 L10,5 L0,10 z\" fill=\"#1f6fb5\"/></marker></defs>\n"
      "<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n",
      width, height);
  svg += draw_edges(world) + draw_nodes(world, first_visits(world, walk));
  if (!walk.empty()) svg += draw_walk(world, walk);
  return svg + "</svg>\n";
}

}  // namespace graphdrl
