#include "graphdrl/env/observation.h"

namespace graphdrl {

NodeSet Observation::ground() const {
  NodeSet visited(view().node_count());
  for (const NodeId node : walk) visited.insert(node);
  return visited;
}

int Observation::action_to(NodeId next) const {
  if (action_space == ActionSpace::kNeighbours) return view().open().index_of(position, next);
  for (int action = 0; action < action_count(); ++action) {
    if (target(action) == next) return action;
  }
  return kNoAction;
}

}  // namespace graphdrl
