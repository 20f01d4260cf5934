#include "graphdrl/env/view.h"

#include <cmath>

#include "graphdrl/base/error.h"

namespace graphdrl {

KnownGrid::KnownGrid(GridMap map) : map_(std::move(map)) {
  if (map_.diagonals) return;
  targets_.resize(map_.blocked.size());
  for (NodeId node = 0; node < std::ssize(targets_); ++node) {
    for (int direction = 0; direction < kDirectionCount; ++direction) {
      const Cell next = map_.cell(node) + kGridSteps[direction];
      targets_[node][direction] = map_.is_free(next) ? map_.node(next) : node;
    }
  }
}

const Graph& KnownGrid::graph() const {
  std::call_once(graph_made_, [&] {
    GridMap whole = map_;
    whole.blocked.assign(whole.blocked.size(), false);
    graph_ = Graph::grid(whole);
  });
  return graph_;
}

std::shared_ptr<const Known> make_known(Known&& known) {
  const auto made = std::make_shared<Known>(std::move(known));
  for (NodeId node = 0; node < made->open.node_count(); ++node) {
    if (made->blocked[node]) continue;
    made->valid_nodes.push_back(node);
    made->total_prize += made->prizes.empty() ? 1 : made->prizes[node];
  }
  if (!std::isfinite(made->total_prize)) {
    throw Error({.what = "the prizes add up to more than a number holds", .where = made->name});
  }
  if (made->valid_nodes.empty()) throw Error({.what = "the world has no valid node", .where = made->name});
  if (made->open.directed()) {
    made->into = made->open.reversed();
    std::vector<Edge> edges = made->open.edges();
    for (Edge& edge : edges) edge.cost = 1;
    made->both_ways = Graph::from_edges(made->open.node_count(), edges);
  }
  return made;
}

}  // namespace graphdrl
