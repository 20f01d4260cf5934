// The one interface of random walks, searches and trained networks.
#pragma once

#include <span>

#include "graphdrl/base/clock.h"
#include "graphdrl/env/observation.h"

namespace graphdrl {

// Chooses the next move of many episodes at once. May keep random numbers and scratch memory: calls are not thread
// safe.
class Policy {
 public:
  virtual ~Policy() = default;

  // Writes a move for each observation: an action of its action space, or kStop. Once the clock passes, the best that
  // it knows by then.
  // REQUIRES: actions is as long as observations; no observed episode is done.
  virtual void act(std::span<const Observation> observations, std::span<int> actions, const Clock& clock = {}) = 0;
};

}  // namespace graphdrl
