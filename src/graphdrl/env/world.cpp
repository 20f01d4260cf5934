#include "graphdrl/env/world.h"

#include <algorithm>

namespace graphdrl {

World::World(std::string name, GridMap map) {
  Known known{.name = std::move(name), .open = Graph::grid(map), .blocked = map.blocked};
  known.grid = std::make_shared<const KnownGrid>(std::move(map));
  const auto made = make_known(std::move(known));
  data_ = std::make_shared<const Data>(Data{.known = made, .view = made});
}

World::World(std::string name, GraphMap map) {
  Known known{.name = std::move(name), .open = {}, .blocked = std::move(map.blocked), .prizes = std::move(map.prizes)};
  const bool any_blocked = std::find(known.blocked.begin(), known.blocked.end(), true) != known.blocked.end();
  std::optional<Graph> whole;
  if (any_blocked) {
    known.open = map.graph.without(known.blocked);
    whole = std::move(map.graph);
  } else {
    known.open = std::move(map.graph);
  }
  const auto made = make_known(std::move(known));
  data_ = std::make_shared<const Data>(Data{.known = made,
                                            .view = made,
                                            .graph = std::move(whole),
                                            .labels = std::move(map.labels),
                                            .given = map.task,
                                            .places = std::move(map.places),
                                            .multigraph = std::move(map.multigraph)});
}

World::World(std::string name, Graph graph, std::vector<bool> blocked, std::vector<std::string> labels,
             std::vector<double> prizes, GivenTask given, Places places)
    : World(std::move(name), GraphMap{.graph = std::move(graph),
                                      .blocked = std::move(blocked),
                                      .labels = std::move(labels),
                                      .prizes = std::move(prizes),
                                      .places = std::move(places),
                                      .task = given}) {}

GraphMap World::to_map() const {
  const bool diagonals = has_cells() && !is_grid();  // those past an obstacle are no edges
  GraphMap map{.graph = diagonals ? open() : graph(),
               .blocked = blocked(),
               .labels = labels(),
               .prizes = prizes(),
               .places = data_->places,
               .task = given(),
               .multigraph = data_->multigraph};
  if (!has_cells() || !this->map()->frame) return map;
  map.places.unit = unit();
  for (NodeId node = 0; node < node_count(); ++node) map.places.points.push_back(place(node));
  return map;
}

Point World::place(NodeId node) const {
  return has_cells() ? map()->place(node) : data_->places.points[node];
}

const std::string& World::unit() const {
  static const std::string kCells = "cells";
  if (!has_cells()) return data_->places.unit;
  return map()->frame ? map()->frame->unit : kCells;
}

const Graph& World::graph() const {
  if (data_->graph) return *data_->graph;
  return has_cells() && valid_count() < node_count() ? view().grid().graph() : open();
}

}  // namespace graphdrl
