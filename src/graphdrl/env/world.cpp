#include "graphdrl/env/world.h"

#include <algorithm>

#include "graphdrl/base/error.h"

namespace graphdrl {

World::World(std::string name, GridMap map) {
  const auto data = std::make_shared<Data>();
  data->name = std::move(name);
  data->open = Graph::grid(map);
  data->blocked = map.blocked;
  if (!map.diagonals) data->direction_targets.resize(data->open.node_count());
  for (NodeId node = 0; node < std::ssize(data->direction_targets); ++node) {
    for (const Direction direction : kAllDirections) {
      const NodeId next = grid_neighbour(map.rows, map.cols, node, direction);
      data->direction_targets[node][static_cast<int>(direction)] = next == kNoNode || map.blocked[next] ? node : next;
    }
  }
  data->map = std::move(map);
  index_nodes(*data);
  data_ = data;
}

World::World(std::string name, Graph graph, std::vector<bool> blocked, std::vector<std::string> labels,
             std::vector<double> prizes, GivenTask given, Places places) {
  const auto data = std::make_shared<Data>();
  data->name = std::move(name);
  data->blocked = std::move(blocked);
  data->labels = std::move(labels);
  data->prizes = std::move(prizes);
  data->given = given;
  data->places = std::move(places);
  const bool any_blocked = std::find(data->blocked.begin(), data->blocked.end(), true) != data->blocked.end();
  if (any_blocked) {
    data->open = graph.without(data->blocked);
    data->graph = std::move(graph);
  } else {
    data->open = std::move(graph);
  }
  if (data->open.directed()) {
    data->into = data->open.reversed();
    std::vector<Edge> edges = data->open.edges();
    for (Edge& edge : edges) edge.cost = 1;
    data->both_ways = Graph::from_edges(data->open.node_count(), edges);
  }
  index_nodes(*data);
  data_ = data;
}

void World::index_nodes(Data& data) {
  for (NodeId node = 0; node < data.open.node_count(); ++node) {
    if (data.blocked[node]) continue;
    data.valid_nodes.push_back(node);
    data.total_prize += data.prizes.empty() ? 1 : data.prizes[node];
  }
  if (data.valid_nodes.empty()) throw Error({.what = "the world has no valid node", .where = data.name});
  data.exact_sums = data.open.integer_costs();
}

Point World::place(NodeId node) const {
  return data_->map ? data_->map->place(node) : data_->places.points[node];
}

const std::string& World::unit() const {
  static const std::string kCells = "cells";
  if (!data_->map) return data_->places.unit;
  return data_->map->frame ? data_->map->frame->unit : kCells;
}

const Graph& World::graph() const {
  std::call_once(data_->graph_made, [&] {
    if (!data_->map || valid_count() == node_count()) return;
    GridMap map = *data_->map;
    map.blocked.assign(map.blocked.size(), false);
    data_->graph = Graph::grid(map);
  });
  return data_->graph ? *data_->graph : data_->open;
}

}  // namespace graphdrl
