#include "graphdrl/report/layout.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "graphdrl/base/random.h"
#include "graphdrl/graph/search.h"

namespace graphdrl {
namespace {

constexpr NodeId kMostByAllPairs = 1500;
constexpr std::int64_t kMostPairs = 2'000'000;
constexpr int kMostPivots = 100;
constexpr int kRounds = 30;
constexpr double kLastStep = 0.1;  // as in the paper, epsilon
constexpr std::uint64_t kSeed = 1;

struct Pair {
  NodeId one;
  NodeId other;
  double distance;  // wanted
};

// Distances in edges; every edge costs 1. Nodes without a way between them lie a little farther apart than any that
// have one.
std::vector<Pair> pairs_of(const Graph& graph) {
  const NodeId count = graph.node_count();
  const bool all = count <= kMostByAllPairs;
  const auto pivots = static_cast<NodeId>(std::clamp<std::int64_t>(kMostPairs / count, 1, kMostPivots));
  std::vector<Pair> pairs;
  if (!all) {
    for (const Edge& edge : graph.edges()) pairs.push_back({edge.a, edge.b, 1});
  }
  std::vector<int> nearest(count, std::numeric_limits<int>::max());  // hops from any source before
  NearestFirst search;
  NodeId source = 0;
  int most = 1;
  for (NodeId i = 0; i < (all ? count : pivots); ++i) {
    if (all) source = i;
    std::vector<int> hops(count, -1);  // from the source; -1 where no way leads
    hops[source] = 0;
    search.run(graph, source, kNoLimit, [&](NodeId node, double cost) {
      hops[node] = static_cast<int>(cost);
      return NearestFirst::Next::kThrough;
    });
    most = std::max(most, *std::max_element(hops.begin(), hops.end()));
    for (NodeId node = all ? i + 1 : 0; node < count; ++node) {
      if (node != source) pairs.push_back({source, node, static_cast<double>(hops[node])});
      if (hops[node] >= 0) nearest[node] = std::min(nearest[node], hops[node]);
    }
    // The next source is farthest from those before.
    source = static_cast<NodeId>(std::max_element(nearest.begin(), nearest.end()) - nearest.begin());
  }
  for (Pair& pair : pairs) {
    if (pair.distance < 0) pair.distance = most + 1;
  }
  return pairs;
}

std::vector<Point> on_a_circle(NodeId count) {
  std::vector<Point> points;
  points.reserve(static_cast<std::size_t>(count));
  for (NodeId node = 0; node < count; ++node) {
    const double angle = 2 * std::numbers::pi * node / count;
    points.push_back({count * std::sin(angle), count * std::cos(angle)});
  }
  return points;
}

std::vector<Point> by_stress(const Graph& graph) {
  const NodeId count = graph.node_count();
  std::vector<Edge> edges = graph.edges();
  for (Edge& edge : edges) edge.cost = 1;
  std::vector<Pair> pairs = pairs_of(Graph::from_edges(count, edges));

  Rng rng(kSeed);
  std::vector<Point> points;
  points.reserve(static_cast<std::size_t>(count));
  const double side = std::sqrt(count);
  for (NodeId node = 0; node < count; ++node) points.push_back({side * rng.uniform(), side * rng.uniform()});
  double longest = 1;
  for (const Pair& pair : pairs) longest = std::max(longest, pair.distance);
  const double first_step = longest * longest;
  const double decay = std::log(first_step / kLastStep) / (kRounds - 1);
  for (int round = 0; round < kRounds; ++round) {
    const double step = first_step * std::exp(-decay * round);
    for (std::size_t i = pairs.size(); i > 1; --i) {
      std::swap(pairs[i - 1], pairs[rng.below(static_cast<std::uint32_t>(i))]);
    }
    for (const Pair& pair : pairs) {
      Point& one = points[pair.one];
      Point& other = points[pair.other];
      const double dx = one.x - other.x;
      const double dy = one.y - other.y;
      const double length = std::max(1e-9, std::hypot(dx, dy));
      const double share = std::min(1.0, step / (pair.distance * pair.distance));
      const double move = share * (length - pair.distance) / (2 * length);
      one = {one.x - move * dx, one.y - move * dy};
      other = {other.x + move * dx, other.y + move * dy};
    }
  }
  return points;
}

}  // namespace

std::vector<Point> lay_out(const Graph& graph) {
  const bool is_stressed = !graph.is_complete() && graph.node_count() >= 3;
  std::vector<Point> points = is_stressed ? by_stress(graph) : on_a_circle(graph.node_count());
  const auto rounded = [](double value) { return std::round(1000 * value) / 1000; };
  for (Point& point : points) point = {rounded(point.x), rounded(point.y)};
  return points;
}

Box box_of(std::span<const Point> points) {
  Box box;
  for (const Point& point : points) {
    box = {std::min(box.left, point.x), std::min(box.bottom, point.y), std::max(box.right, point.x),
           std::max(box.top, point.y)};
  }
  return box;
}

std::vector<Point> places_of(const World& world) {
  if (!world.has_places()) return lay_out(world.open());
  std::vector<Point> places;
  places.reserve(world.node_count());
  for (NodeId node = 0; node < world.node_count(); ++node) places.push_back(world.place(node));
  return places;
}

}  // namespace graphdrl
