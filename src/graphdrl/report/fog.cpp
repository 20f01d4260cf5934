#include "graphdrl/report/fog.h"

#include <algorithm>
#include <functional>

#include "graphdrl/report/picture.h"

namespace graphdrl {
namespace {

// The cells around a cell; of other nodes those to which edges lead.
void for_each_beside(const World& world, NodeId node, const std::function<void(NodeId)>& visit) {
  if (!world.has_cells()) {
    for (const NodeId next : world.graph().neighbours(node)) visit(next);
    return;
  }
  const GridMap& map = *world.map();
  for (int row = -1; row <= 1; ++row) {
    for (int col = -1; col <= 1; ++col) {
      const Cell near = map.cell(node) + Cell{row, col};
      if (map.contains(near)) visit(map.node(near));
    }
  }
}

}  // namespace

Fog::Fog(const Answer& answer) : directed_(answer.world.open().directed()) {
  const World& world = answer.world;
  const Discovered& discovered = answer.discovered;
  if (discovered.nodes.empty()) return;
  if (answer.reveal.kind() == Reveal::Kind::kEdges) visited_at_ = first_visits(world, answer.plan.walk);
  seen_at_.assign(world.node_count(), -1);
  const bool obstacles = world.valid_count() < world.node_count();
  int step = 0;
  for (int i = 0; i < std::ssize(discovered.nodes); ++i) {
    while (discovered.after_step[step] <= i) ++step;
    const NodeId node = discovered.nodes[i];
    seen_at_[node] = step;
    if (!obstacles) continue;
    for_each_beside(world, node, [&](NodeId beside) {
      if (world.is_blocked(beside) && seen_at_[beside] < 0) seen_at_[beside] = step;
    });
  }
}

int Fog::lifts_at(const Edge& edge) const {
  if (empty()) return 0;
  const std::vector<int>& steps = visited_at_.empty() ? seen_at_ : visited_at_;
  const auto [first, last] = std::minmax(steps[edge.a], steps[edge.b]);
  if (visited_at_.empty()) return first < 0 ? -1 : last;
  if (directed_) return steps[edge.a];
  return first < 0 ? last : first;
}

}  // namespace graphdrl
