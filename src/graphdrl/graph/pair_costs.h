// Costs between all pairs of places, computed when they are asked for.
#pragma once

#include <cstdint>

namespace graphdrl {

using NodeId = std::int32_t;

// Symmetric, finite, not negative. Immutable: any number of threads may ask.
class PairCosts {
 public:
  virtual ~PairCosts() = default;
  virtual double cost(NodeId from, NodeId to) const = 0;
  // Whether no way through other places is cheaper than the straight one. Distances that are rounded to the nearest
  // number are not metric.
  virtual bool metric() const { return false; }
};

}  // namespace graphdrl
