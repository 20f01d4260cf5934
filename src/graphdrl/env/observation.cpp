#include "graphdrl/env/observation.h"

namespace graphdrl {

int Observation::action_to(NodeId next) const {
  for (int action = 0; action < action_count(); ++action) {
    if (target(action) == next) return action;
  }
  return kNoAction;
}

}  // namespace graphdrl
