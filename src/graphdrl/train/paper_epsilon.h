// How much an epsilon-greedy policy explores.
#pragma once

#include <cmath>
#include <cstdint>

namespace graphdrl {

// exp(-x), x evenly spaced from 0.1 in the first episode to 3 in the last, as the paper's author's code has it; one
// single episode has 0.1. REQUIRES: 0 <= episode < episodes.
inline double paper_epsilon(std::int64_t episode, std::int64_t episodes) {
  constexpr double kFirst = 0.1;
  constexpr double kLast = 3.0;
  if (episodes == 1) return std::exp(-kFirst);
  return std::exp(-(kFirst + (kLast - kFirst) * static_cast<double>(episode) / static_cast<double>(episodes - 1)));
}

}  // namespace graphdrl
