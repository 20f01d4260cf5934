#include "graphdrl/env/world.h"

#include <algorithm>
#include <utility>

#include "graphdrl/io/map_formats.h"

namespace graphdrl {
namespace {

std::shared_ptr<const Known> known_grid(std::string name, GridMap map) {
  Known known{.name = std::move(name), .open = Graph::grid(map), .blocked = map.blocked};
  known.grid = std::make_shared<const KnownGrid>(std::move(map));
  return make_known(std::move(known));
}

// Takes what is known out of a map. Its graph stays if it has blocked nodes.
std::shared_ptr<const Known> take_known(std::string name, GraphMap& map) {
  const bool any_blocked = std::ranges::find(map.blocked, true) != map.blocked.end();
  return make_known({.name = std::move(name),
                     .open = any_blocked ? map.graph.without(map.blocked) : std::exchange(map.graph, Graph()),
                     .blocked = std::move(map.blocked),
                     .prizes = std::move(map.prizes)});
}

}  // namespace

World::World(std::string name, GridMap map)
    : View(known_grid(std::move(name), std::move(map))), rest_(std::make_shared<const GraphMap>()) {}

World::World(std::string name, GraphMap map)
    : View(take_known(std::move(name), map)), rest_(std::make_shared<const GraphMap>(std::move(map))) {}

World::World(std::string name, Graph graph, std::vector<bool> blocked, std::vector<std::string> labels,
             std::vector<double> prizes, GivenTask given, Places places)
    : World(std::move(name), GraphMap{.graph = std::move(graph),
                                      .blocked = std::move(blocked),
                                      .labels = std::move(labels),
                                      .prizes = std::move(prizes),
                                      .places = std::move(places),
                                      .task = given}) {}

GraphMap World::to_map() const {
  if (has_cells()) return as_graph(*map());
  GraphMap whole = *rest_;
  whole.graph = graph();
  whole.blocked = blocked();
  whole.prizes = prizes();
  return whole;
}

Point World::place(NodeId node) const {
  return has_cells() ? map()->place(node) : rest_->places.points[node];
}

const std::string& World::unit() const {
  static const std::string kCells = "cells";
  if (!has_cells()) return rest_->places.unit;
  return map()->frame ? map()->frame->unit : kCells;
}

const Graph& World::graph() const {
  if (valid_count() == node_count()) return open();
  return has_cells() ? grid().graph() : rest_->graph;
}

}  // namespace graphdrl
