// Many episodes of one world, stepped side by side.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "graphdrl/base/parallel.h"
#include "graphdrl/env/episode.h"

namespace graphdrl {

// Episodes know nothing of each other, so blocks of them are stepped by parallel_for; blocks are cut by size, and
// results do not depend on the number of threads. Not thread safe.
class VectorEnv {
 public:
  VectorEnv(const World& world, const EpisodeOptions& options, int count) : episodes_(count, Episode(world, options)) {}

  int size() const { return static_cast<int>(episodes_.size()); }
  Episode& operator[](int index) { return episodes_[index]; }
  const Episode& operator[](int index) const { return episodes_[index]; }

  // Calls visit(index, episode) for every episode, those of a block one after the other on one thread: to reset, step
  // or encode them.
  template <typename Visit>
  void for_each(const Visit& visit) {
    const auto visit_block = [&](int block) {
      const int end = std::min(size(), (block + 1) * kBlock);
      for (int i = block * kBlock; i < end; ++i) visit(i, episodes_[i]);
    };
    parallel_for((size() + kBlock - 1) / kBlock, visit_block, Schedule::kFixed);
  }

 private:
  static constexpr int kBlock = 64;  // episodes; their states fit a core's first-level cache

  std::vector<Episode> episodes_;
};

}  // namespace graphdrl
