#include "graphdrl/env/load_worlds.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "graphdrl/base/error.h"
#include "graphdrl/io/map_source.h"

namespace graphdrl {
namespace {

constexpr std::int64_t kMostNodes = 1'000'000'000;

// kNoNode where the text is no whole number from 0 up.
int parse_index(std::string_view text) {
  int value = kNoNode;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() ? value : kNoNode;
}

World make_world(NamedMap&& named) {
  if (auto* const grid = std::get_if<GridMap>(&named.map)) return World(std::move(named.name), std::move(*grid));
  return World(std::move(named.name), std::get<GraphMap>(std::move(named.map)));
}

// kNoNode where the text names no node.
NodeId find_node(const World& world, std::string_view text) {
  const auto label = std::find(world.labels().begin(), world.labels().end(), text);
  if (label != world.labels().end()) return static_cast<NodeId>(label - world.labels().begin());
  if (text.starts_with('#')) return parse_index(text.substr(1));
  if (!world.labels().empty()) return kNoNode;
  const std::size_t comma = text.find(',');
  if (comma == std::string_view::npos || !world.has_cells()) return parse_index(text);
  const Cell cell{parse_index(text.substr(0, comma)), parse_index(text.substr(comma + 1))};
  return world.map()->contains(cell) ? world.map()->node(cell) : kNoNode;
}

void require_length(std::size_t length, std::size_t expected, const char* what) {
  if (length == 0 || length == expected) return;
  throw Error({.what = fmt::format("bad length of {}", what),
               .expected = std::to_string(expected),
               .got = std::to_string(length)});
}

}  // namespace

std::vector<World> load_worlds(const std::vector<std::string>& sources, const MapOptions& options) {
  std::vector<World> worlds;
  for (const std::string& source : sources) {
    for (NamedMap& named : load_maps(source, options)) worlds.push_back(make_world(std::move(named)));
  }
  return worlds;
}

World load_one_world(const std::string& source, const MapOptions& options) {
  return make_world(load_map(source, options));
}

World world_of(std::string name, const EdgeArrays& arrays, GraphMap map) {
  if (arrays.node_count < 1 || arrays.node_count > kMostNodes) {
    throw Error({.what = "bad number of nodes",
                 .expected = fmt::format("1 to {}", kMostNodes),
                 .got = std::to_string(arrays.node_count)});
  }
  const auto n = static_cast<std::size_t>(arrays.node_count);
  require_length(arrays.costs.size(), arrays.edges.size() / 2, "costs");
  require_length(arrays.labels.size(), arrays.edges.size() / 2, "labels of edges");
  require_length(arrays.prizes.size(), arrays.edges.size() / 2, "prizes of edges");
  require_length(arrays.both_ways.size(), arrays.edges.size() / 2, "edges that lead both ways");
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
  for (const std::span<const double> prizes : {std::span<const double>(map.prizes), arrays.prizes}) {
    for (const double prize : prizes) {
      if (std::isfinite(prize) && prize >= 0) continue;
      throw Error({.what = "bad prize", .expected = "a number from 0 up", .got = fmt::format("{}", prize)});
    }
  }
  for (std::size_t i = 0; i < map.places.points.size(); ++i) {
    if (std::isfinite(map.places.points[i].x) && std::isfinite(map.places.points[i].y)) continue;
    throw Error({.what = fmt::format("bad coordinates of node {}", i), .expected = "finite numbers"});
  }
  if (map.blocked.empty()) map.blocked.resize(n);
  Multigraph all{.edges = std::move(edges), .labels = arrays.labels};
  all.prizes.assign(arrays.prizes.begin(), arrays.prizes.end());
  if (arrays.directed) all.both_ways = arrays.both_ways;
  set_edges(map, static_cast<NodeId>(arrays.node_count), std::move(all),
            arrays.directed ? EdgeKind::kDirected : EdgeKind::kUndirected);
  return World(std::move(name), std::move(map));
}

NodeId parse_node(const World& world, std::string_view text, std::string_view role) {
  const NodeId node = find_node(world, text);
  const bool there = node >= 0 && node < world.node_count();
  if (there && !world.is_blocked(node)) return node;
  std::string expected = "a valid node's id";
  if (world.has_cells()) expected += " or row,col";
  if (!world.labels().empty()) expected = "a label of the map, or #N for node id N";
  throw Error({.what = fmt::format("{} {}", role, there ? "on an obstacle" : "outside the map"),
               .expected = expected,
               .got = in_quotes(text),
               .where = world.name()});
}

std::string node_name(const World& world, NodeId node) {
  if (!world.labels().empty()) return world.labels()[node];
  if (!world.has_cells()) return std::to_string(node);
  const Cell cell = world.map()->cell(node);
  return fmt::format("{},{}", cell.row, cell.col);
}

NodeId checked_node(const World& world, std::int64_t id, std::string_view role) {
  const bool there = id >= 0 && id < world.node_count();
  if (there && !world.is_blocked(static_cast<NodeId>(id))) return static_cast<NodeId>(id);
  throw Error({.what = fmt::format("{} {}", role, there ? "on an obstacle" : "outside the map"),
               .expected = "a valid node",
               .got = std::to_string(id),
               .where = world.name()});
}

End parse_end(const World& world, std::string_view text) {
  if (text == "anywhere") return End::anywhere();
  if (text == "start") return End::at_start();
  return End::at(parse_node(world, text, "end"));
}

Asked asked_of(const World& world, const AskedText& text) {
  Asked asked;
  if (!text.budget.empty()) asked.budget = Budget::parse(text.budget);
  if (!text.start.empty()) asked.start = parse_node(world, text.start, "start");
  if (!text.end.empty()) asked.end = parse_end(world, text.end);
  return asked;
}

}  // namespace graphdrl
