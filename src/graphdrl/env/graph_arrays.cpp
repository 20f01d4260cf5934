#include "graphdrl/env/graph_arrays.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "graphdrl/base/error.h"

namespace graphdrl {
namespace {

constexpr std::int64_t kMostNodes = 1'000'000'000;

void require_length(std::size_t length, std::size_t expected, const char* what) {
  if (length == 0 || length == expected) return;
  throw Error({.what = fmt::format("bad length of {}", what),
               .expected = std::to_string(expected),
               .got = std::to_string(length)});
}

}  // namespace

World world_of(std::string name, const EdgeArrays& arrays, GraphMap map) {
  if (arrays.node_count < 1 || arrays.node_count > kMostNodes) {
    throw Error({.what = "bad number of nodes",
                 .expected = fmt::format("1 to {}", kMostNodes),
                 .got = std::to_string(arrays.node_count)});
  }
  const auto n = static_cast<std::size_t>(arrays.node_count);
  require_length(arrays.costs.size(), arrays.edges.size() / 2, "costs");
  require_length(map.blocked.size(), n, "blocked");
  require_length(map.labels.size(), n, "labels");
  require_length(map.prizes.size(), n, "prizes");
  require_length(map.places.points.size(), n, "places");
  std::vector<Edge> edges;
  edges.reserve(arrays.edges.size() / 2);
  for (std::size_t i = 0; i < arrays.edges.size() / 2; ++i) {
    const std::int64_t a = arrays.edges[2 * i];
    const std::int64_t b = arrays.edges[2 * i + 1];
    if (std::min(a, b) < 0 || std::max(a, b) >= arrays.node_count) {
      throw Error({.what = "an edge outside the graph",
                   .expected = fmt::format("nodes from 0 to {}", arrays.node_count - 1),
                   .got = fmt::format("{}, {}", a, b)});
    }
    edges.push_back({static_cast<NodeId>(a), static_cast<NodeId>(b), arrays.costs.empty() ? 1.0 : arrays.costs[i]});
  }
  for (const double prize : map.prizes) {
    if (!std::isfinite(prize) || prize < 0) {
      throw Error({.what = "bad prize", .expected = "a number from 0 up", .got = fmt::format("{}", prize)});
    }
  }
  for (std::size_t i = 0; i < map.places.points.size(); ++i) {
    if (std::isfinite(map.places.points[i].x) && std::isfinite(map.places.points[i].y)) continue;
    throw Error({.what = fmt::format("bad coordinates of node {}", i), .expected = "finite numbers"});
  }
  if (map.blocked.empty()) map.blocked.resize(n);
  map.graph = Graph::from_edges(static_cast<NodeId>(arrays.node_count), edges,
                                arrays.directed ? EdgeKind::kDirected : EdgeKind::kUndirected);
  return World(std::move(name), std::move(map));
}

}  // namespace graphdrl
