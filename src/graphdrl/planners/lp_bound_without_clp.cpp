// Takes the place of lp_bound.cpp in a build without CLP.
#include "graphdrl/planners/bound.h"

namespace graphdrl {

std::unique_ptr<LpBound> make_lp_bound(const Task& /*task*/, double) {
  return nullptr;
}

bool has_lp_bound() {
  return false;
}

}  // namespace graphdrl
