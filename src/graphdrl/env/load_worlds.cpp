#include "graphdrl/env/load_worlds.h"

#include <algorithm>
#include <charconv>

#include "graphdrl/base/error.h"
#include "graphdrl/io/map_source.h"

namespace graphdrl {
namespace {

// -1 where the text is no whole number from 0 up.
int parse_index(std::string_view text) {
  int value = -1;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() ? value : -1;
}

World make_world(NamedMap named) {
  if (auto* const grid = std::get_if<GridMap>(&named.map)) return World(named.name, std::move(*grid));
  auto& map = std::get<GraphMap>(named.map);
  return World(named.name, std::move(map.graph), std::move(map.blocked), std::move(map.labels));
}

}  // namespace

std::vector<World> load_worlds(const std::vector<std::string>& sources) {
  std::vector<World> worlds;
  for (const std::string& source : sources) {
    for (NamedMap& named : load_maps(source)) worlds.push_back(make_world(std::move(named)));
  }
  return worlds;
}

World load_one_world(const std::string& source) {
  return make_world(load_map(source));
}

NodeId parse_start(const World& world, std::string_view text) {
  NodeId node = parse_index(text);
  const auto label = std::find(world.labels().begin(), world.labels().end(), text);
  if (label != world.labels().end()) node = static_cast<NodeId>(label - world.labels().begin());
  const std::size_t comma = text.find(',');
  if (comma != std::string_view::npos && world.is_grid()) {
    const Cell cell{parse_index(text.substr(0, comma)), parse_index(text.substr(comma + 1))};
    if (world.map()->contains(cell)) node = world.map()->node(cell);
  }
  if (node < 0 || node >= world.node_count() || world.is_blocked(node)) {
    const bool obstacle = node >= 0 && node < world.node_count();
    throw Error({.what = obstacle ? "start on an obstacle" : "start outside the map",
                 .expected = "a valid node's id, label or row,col",
                 .got = in_quotes(text),
                 .where = world.name()});
  }
  return node;
}

}  // namespace graphdrl
