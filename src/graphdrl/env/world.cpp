#include "graphdrl/env/world.h"

#include "graphdrl/base/error.h"

namespace graphdrl {

World::World(std::string name, const GridMap& map)
    : name_(std::move(name)), graph_(Graph::grid(map.rows, map.cols)), blocked_(map.blocked), map_(map) {
  index_nodes();
  direction_targets_.resize(graph_.node_count());
  for (NodeId node = 0; node < graph_.node_count(); ++node) {
    for (const Direction direction : kAllDirections) {
      const NodeId next = grid_neighbour(map.rows, map.cols, node, direction);
      direction_targets_[node][static_cast<int>(direction)] = next == kNoNode || blocked_[next] ? node : next;
    }
  }
}

World::World(std::string name, Graph graph, std::vector<bool> blocked, std::vector<std::string> labels)
    : name_(std::move(name)), graph_(std::move(graph)), blocked_(std::move(blocked)), labels_(std::move(labels)) {
  index_nodes();
}

void World::index_nodes() {
  for (NodeId node = 0; node < graph_.node_count(); ++node) {
    if (!blocked_[node]) valid_nodes_.push_back(node);
  }
  if (valid_nodes_.empty()) throw Error({.what = "the world has no valid node", .where = name_});
  open_ = graph_.without(blocked_);
}

}  // namespace graphdrl
