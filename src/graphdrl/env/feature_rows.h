// What rows of observations are made of.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

#include "graphdrl/env/observation.h"

namespace graphdrl {

inline constexpr double kMostPrize = 8;  // mean prizes

inline float flag(bool value) {
  return value ? 1.0f : 0.0f;
}

// In kMostPrize mean prizes of the nodes known, 1 at most.
inline float prize_of(const View& view, NodeId node) {
  const double mean = view.total_prize() / view.valid_count();
  return mean > 0 ? static_cast<float>(std::min(view.prize(node) / mean / kMostPrize, 1.0)) : 0.0f;
}

// As a share.
inline float budget_left(const Observation& now) {
  const double budget = now.task->budget();
  return budget > 0 ? static_cast<float>(std::clamp(1 - now.spent / budget, 0.0, 1.0)) : 0.0f;
}

// The columns of `row` by name.
template <typename Feature>
auto columns(std::span<float> row) {
  return [row](Feature feature) -> float& { return row[static_cast<std::size_t>(feature)]; };
}

}  // namespace graphdrl
