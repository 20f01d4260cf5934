// A graph with its blocked nodes: what an episode is walked in.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "graphdrl/graph/graph.h"
#include "graphdrl/graph/grid_map.h"

namespace graphdrl {

// Immutable; any number of episodes and threads may share one, and all hold references to it.
class World {
 public:
  // A grid: has directions and cells. Throws Error where every cell is blocked.
  World(std::string name, const GridMap& map);

  // Any graph. Throws Error where every node is blocked. REQUIRES: blocked has a value per node, and so have the labels
  // where there are any.
  World(std::string name, Graph graph, std::vector<bool> blocked, std::vector<std::string> labels = {});

  const std::string& name() const { return name_; }
  const Graph& graph() const { return graph_; }  // with its blocked nodes
  const std::optional<GridMap>& map() const { return map_; }
  const std::vector<bool>& blocked() const { return blocked_; }
  bool is_blocked(NodeId node) const { return blocked_[node]; }
  bool is_grid() const { return map_.has_value(); }
  const std::vector<std::string>& labels() const { return labels_; }  // what users call the nodes; mostly empty

  std::span<const NodeId> valid_nodes() const { return valid_nodes_; }  // ascending
  int valid_count() const { return static_cast<int>(valid_nodes_.size()); }

  // The graph without the edges of blocked nodes: what can be walked.
  const Graph& open() const { return open_; }
  std::span<const NodeId> open_neighbours(NodeId node) const { return open_.neighbours(node); }

  // Where a direction leads; the node itself where the move is blocked. REQUIRES: is_grid().
  NodeId direction_target(NodeId node, int direction) const { return direction_targets_[node][direction]; }

 private:
  void index_nodes();

  std::string name_;
  Graph graph_;
  std::vector<bool> blocked_;
  std::optional<GridMap> map_;
  std::vector<std::string> labels_;
  Graph open_;
  std::vector<NodeId> valid_nodes_;
  std::vector<std::array<NodeId, 4>> direction_targets_;
};

}  // namespace graphdrl
