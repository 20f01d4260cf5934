#include "graphdrl/graph/placed_graph_generators.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "graphdrl/graph/components.h"
#include "graphdrl/graph/graph_generators.h"

namespace graphdrl {
namespace {

constexpr int kStreetMetres = 100;
constexpr int kMovedMetres = 80;
constexpr double kDiagonals = 0.05;
constexpr double kWinding = 1.0 / 7;
const double kHalfRoot3 = std::sqrt(3.0) / 2;  // the height of a triangle with sides of 1

GraphMap placed(Graph graph, std::vector<Point> points, std::string unit = "") {
  return {.graph = std::move(graph),
          .blocked = std::vector<bool>(points.size()),
          .places = {.points = std::move(points), .unit = std::move(unit)}};
}

GraphMap placed(const std::vector<Edge>& edges, std::vector<Point> points) {
  Graph graph = Graph::from_edges(static_cast<NodeId>(points.size()), edges);
  return placed(std::move(graph), std::move(points));
}

// The point of a circle after a share of a turn, to six digits.
Point on_circle(Point centre, double radius, double turn) {
  constexpr double kDigits = 1e6;
  const auto rounded = [&](double value) { return std::round(value * kDigits) / kDigits; };
  const double angle = 2 * std::numbers::pi * turn;
  return {rounded(centre.x + radius * std::cos(angle)), rounded(centre.y + radius * std::sin(angle))};
}

double radius_of(double circumference) {
  return circumference / (2 * std::numbers::pi);
}

}  // namespace

GraphMap ladder_map(int rungs) {
  std::vector<Edge> edges;
  std::vector<Point> points;
  for (int node = 0; node < 2 * rungs; ++node) {
    const int along = node % rungs;
    if (along + 1 < rungs) edges.push_back({node, node + 1});
    if (node < rungs) edges.push_back({node, node + rungs});
    points.push_back({static_cast<double>(along), node < rungs ? 0.0 : -1.0});
  }
  return placed(edges, std::move(points));
}

GraphMap hexagons_map(int rows, int cols) {
  std::vector<Edge> edges;
  std::vector<Point> points;
  for (int node = 0; node < rows * cols; ++node) {
    const int row = node / cols;
    const int col = node % cols;
    const bool leads_down = (row + col) % 2 == 0;
    if (col + 1 < cols) edges.push_back({node, node + 1});
    if (leads_down && row + 1 < rows) edges.push_back({node, node + cols});
    points.push_back({col * kHalfRoot3, -1.5 * row + (leads_down ? -0.25 : 0.25)});
  }
  return placed(edges, std::move(points));
}

GraphMap triangles_map(int rows, int cols) {
  std::vector<Edge> edges;
  std::vector<Point> points;
  for (int node = 0; node < rows * cols; ++node) {
    const int row = node / cols;
    const int col = node % cols;
    const bool moved_right = row % 2 == 1;  // by half a side
    const int aslant = moved_right ? col + 1 : col - 1;
    if (col + 1 < cols) edges.push_back({node, node + 1});
    if (row + 1 < rows) edges.push_back({node, node + cols});
    if (row + 1 < rows && aslant >= 0 && aslant < cols) edges.push_back({node, node + cols - col + aslant});
    points.push_back({col + (moved_right ? 0.5 : 0.0), -kHalfRoot3 * row});
  }
  return placed(edges, std::move(points));
}

GraphMap torus_map(int rows, int cols) {
  const double tube = radius_of(rows);
  const double ring = tube + radius_of(cols);
  std::vector<Edge> edges;
  std::vector<Point> points;
  for (int node = 0; node < rows * cols; ++node) {
    const int row = node / cols;
    const int col = node % cols;
    edges.push_back({node, row * cols + (col + 1) % cols});
    edges.push_back({node, (row + 1) % rows * cols + col});
    // The quarter keeps nodes in front from covering those behind.
    const auto [outward, upward] = on_circle({ring, 0}, tube, (row + 0.25) / rows);
    const Point seen_from_above = on_circle({0, 0}, outward, static_cast<double>(col) / cols);
    points.push_back({seen_from_above.x, 0.5 * seen_from_above.y + kHalfRoot3 * upward});  // at a slant of 30°
  }
  return placed(edges, std::move(points));
}

GraphMap balanced_tree_map(int nodes, int branching) {
  std::vector<Edge> edges;
  std::vector<Point> points;
  double depth = 0;
  std::int64_t first = 0;  // of the level of this depth
  std::int64_t width = 1;
  for (int node = 0; node < nodes; ++node) {
    if (node == first + width) {
      first += width;
      width *= branching;
      ++depth;
    }
    if (node > 0) edges.push_back({(node - 1) / branching, node});
    points.push_back(on_circle({0, 0}, depth, (static_cast<double>(node - first) + 0.5) / static_cast<double>(width)));
  }
  return placed(edges, std::move(points));
}

GraphMap caveman_map(int nodes, int caves) {
  std::vector<Edge> edges;
  std::vector<Point> points;
  const double cave_radius = radius_of(static_cast<double>(nodes) / caves);
  const double ring_radius = caves == 1 ? 0 : (cave_radius + 0.5) / std::sin(std::numbers::pi / caves);
  for (int cave = 0; cave < caves; ++cave) {
    const int size = nodes / caves + (cave < nodes % caves ? 1 : 0);
    const int first = static_cast<int>(points.size());
    const Point centre = on_circle({0, 0}, ring_radius, static_cast<double>(cave) / caves);
    for (int a = 0; a < size; ++a) {
      for (int b = a + 1; b < size; ++b) {
        if (caves == 1 || a != 0 || b != 1) edges.push_back({first + a, first + b});
      }
      points.push_back(on_circle(centre, cave_radius, static_cast<double>(a) / size));
    }
    if (caves > 1) edges.push_back({first, (first + nodes - 1) % nodes});
  }
  return placed(edges, std::move(points));
}

GraphMap road_map(int rows, int cols, double kept, bool lengths_cost, Rng& rng) {
  std::vector<Point> points;
  for (int node = 0; node < rows * cols; ++node) {
    const int east = node % cols * kStreetMetres + rng.index(kMovedMetres + 1);
    const int north = -(node / cols) * kStreetMetres + rng.index(kMovedMetres + 1);
    points.push_back({static_cast<double>(east), static_cast<double>(north)});
  }
  std::vector<Edge> edges;
  const auto draw_street = [&](int a, int b, double share) {
    if (!(rng.uniform() < share)) return;
    const double x = points[a].x - points[b].x;
    const double y = points[a].y - points[b].y;
    const double winding = rng.uniform() < kWinding ? 1 + rng.uniform() : 1;
    edges.push_back({a, b, lengths_cost ? std::ceil(winding * std::sqrt(x * x + y * y)) : 1});
  };
  for (int node = 0; node < rows * cols; ++node) {
    const bool has_next = node % cols + 1 < cols;
    const bool has_below = node / cols + 1 < rows;
    if (has_next) draw_street(node, node + 1, kept);
    if (has_below) draw_street(node, node + cols, kept);
    if (has_next && has_below) draw_street(node, node + cols + 1, kDiagonals);
  }
  const Graph streets = Graph::from_edges(rows * cols, edges);
  const Components components = find_components(streets, std::vector<bool>(points.size()));
  const int largest = components.largest();
  std::vector<Point> kept_points;
  for (NodeId node = 0; node < streets.node_count(); ++node) {
    if (components.of[node] == largest) kept_points.push_back(points[node]);
  }
  return placed(largest_part(streets), std::move(kept_points), "m");
}

GraphMap shuffled(const GraphMap& map, Rng& rng) {
  std::vector<NodeId> number(map.graph.node_count());
  std::iota(number.begin(), number.end(), 0);
  for (int left = map.graph.node_count(); left > 1; --left) std::swap(number[left - 1], number[rng.index(left)]);
  std::vector<Edge> edges = map.graph.edges();
  for (Edge& edge : edges) edge = {number[edge.a], number[edge.b], edge.cost};
  std::vector<Point> points(number.size());
  for (std::size_t node = 0; node < number.size(); ++node) points[number[node]] = map.places.points[node];
  return placed(Graph::from_edges(map.graph.node_count(), edges), std::move(points), map.places.unit);
}

}  // namespace graphdrl
