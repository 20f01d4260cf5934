#include "graphdrl/env/load_worlds.h"

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

}  // namespace

std::vector<World> load_worlds(const std::vector<std::string>& sources) {
  std::vector<World> worlds;
  for (const std::string& source : sources) {
    for (const NamedMap& named : load_maps(source)) worlds.emplace_back(named.name, named.map);
  }
  return worlds;
}

World load_one_world(const std::string& source) {
  const NamedMap named = load_map(source);
  return World(named.name, named.map);
}

NodeId parse_start(const World& world, std::string_view text) {
  NodeId node = parse_index(text);
  const std::size_t comma = text.find(',');
  if (comma != std::string_view::npos && world.is_grid()) {
    const Cell cell{parse_index(text.substr(0, comma)), parse_index(text.substr(comma + 1))};
    if (world.map()->contains(cell)) node = world.map()->node(cell);
  }
  if (node < 0 || node >= world.graph().node_count() || world.is_blocked(node)) {
    const bool obstacle = node >= 0 && node < world.graph().node_count();
    throw Error({.what = obstacle ? "start on an obstacle" : "start outside the map",
                 .expected = "a valid node's id, or row,col",
                 .got = in_quotes(text),
                 .where = world.name()});
  }
  return node;
}

}  // namespace graphdrl
