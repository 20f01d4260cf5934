// What is known of a world: all that policies, planners, bounds and features may see of it.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "graphdrl/graph/graph.h"
#include "graphdrl/graph/grid_map.h"

namespace graphdrl {

// A grid as it is known: its cells, and where steps lead.
class KnownGrid {
 public:
  explicit KnownGrid(GridMap map);

  const GridMap& map() const { return map_; }
  // Whether steps lead in the paper's four directions, and where each leads; the node itself where the move is blocked.
  bool has_directions() const { return !map_.diagonals; }
  NodeId direction_target(NodeId node, int direction) const { return targets_[node][direction]; }
  // The graph with its obstacles as nodes like others. Made when it is first asked for.
  const Graph& graph() const;

 private:
  GridMap map_;
  std::vector<std::array<NodeId, 4>> targets_;  // [N]; empty where the grid has diagonals
  mutable std::once_flag graph_made_;
  mutable Graph graph_;
};

// Immutable once it is made [make_known()]: any number of threads may read it. What becomes known later is another one,
// of a higher version, in which every node keeps its number: nodes are numbered in the order of their discovery, so
// that vectors by node only grow.
struct Known {
  std::string name;                 // for messages
  std::uint64_t version = 0;        // 0 for ever of a known map
  std::uint64_t world = 0;          // the same for all versions of one world; 0 lets make_known() number a new one
  Graph open;                       // what can be walked: without the edges of obstacles
  std::vector<bool> blocked;        // [N], known obstacles
  std::vector<double> prizes = {};  // [N], of first visits; empty where each is 1
  std::vector<bool> frontier = {};  // [N], seen and not visited, so that edges may be missing; empty of a known map
  std::shared_ptr<const KnownGrid> grid = {};  // null where there are no cells

  // What follows from these, filled in by make_known():
  std::optional<Graph> into = {};        // of directed graphs: edges turned round
  std::optional<Graph> both_ways = {};   // likewise: every edge leads both ways
  std::vector<NodeId> valid_nodes = {};  // that are no obstacles, ascending
  double total_prize = 0;                // of these
};

// Throws Error where every node is blocked. REQUIRES: a value per node in each vector that is not empty; prizes are
// finite and not negative.
std::shared_ptr<const Known> make_known(Known&& known);

}  // namespace graphdrl
