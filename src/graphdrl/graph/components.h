// Connected components; directions of edges do not count.
#pragma once

#include <vector>

#include "graphdrl/graph/graph.h"
#include "graphdrl/graph/grid_map.h"

namespace graphdrl {

struct Components {
  static constexpr int kNone = -1;

  std::vector<int> of;        // [N], the component of a node; kNone if it is blocked
  std::vector<NodeId> sizes;  // nodes of each component; components stand in the order of their lowest nodes

  int count() const { return static_cast<int>(sizes.size()); }
  int largest() const;  // the first among equals; kNone if there are none
};

// The components of the nodes that are not blocked. Cost: as good as linear. REQUIRES: blocked has a value per node.
Components find_components(const Graph& graph, const std::vector<bool>& blocked);

// The components of a map's free cells.
Components find_components(const GridMap& map);

// The number of components of the nodes that are not blocked. REQUIRES: blocked has a value per node.
int count_components(const Graph& graph, const std::vector<bool>& blocked);

}  // namespace graphdrl
