// What a walk that explores does not know yet.
#pragma once

#include <vector>

#include "graphdrl/answer/answer.h"

namespace graphdrl {

// The steps of a walk at which nodes and edges become known. Where the map was known beforehand, there is no fog: all
// is known at step 0.
class Fog {
 public:
  Fog() = default;
  explicit Fog(const Answer& answer);

  bool empty() const { return seen_at_.empty(); }

  // The step at which the fog lifts; -1: never. A blocked node is seen with the first node that is beside it or leads
  // to it.
  int lifts_at(NodeId node) const { return empty() ? 0 : seen_at_[node]; }
  // Where visits show edges, an edge is known once a node that it leaves is visited; else once both ends are seen.
  int lifts_at(const Edge& edge) const;

 private:
  std::vector<int> seen_at_;     // [N], steps; -1: never
  std::vector<int> visited_at_;  // [N], likewise; empty unless visits show edges
  bool directed_ = false;
};

}  // namespace graphdrl
