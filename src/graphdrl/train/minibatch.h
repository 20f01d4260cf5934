// The gradient of a minibatch, computed on all threads of all ranks.
#pragma once

#include <algorithm>
#include <functional>
#include <span>
#include <vector>

#include "graphdrl/base/ranks.h"

namespace graphdrl {

// A minibatch is cut into so many shards, whose gradients are summed in a fixed order: a training's bytes depend
// neither on threads nor on ranks. Two rounds of the explorer take one thread as long with them as without (43.1
// and 44.6 s).
inline constexpr int kShards = 16;

// Orders samples so that all shards cost about the same: from the most costly one on they go to one shard after the
// other, there and back. A rank waits for the slowest in every step.
template <typename Sample, typename Cost>
void balance_shards(std::vector<Sample>& samples, const Cost& cost) {
  std::ranges::stable_sort(samples, std::ranges::greater(), cost);
  std::vector<std::vector<Sample>> shards(kShards);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const std::size_t place = i % kShards;
    shards[i / kShards % 2 == 0 ? place : kShards - 1 - place].push_back(samples[i]);
  }
  samples.clear();
  for (const std::vector<Sample>& shard : shards) samples.insert(samples.end(), shard.begin(), shard.end());
}

// Sums what each shard adds. compute(worker, begin, end, sum) adds what the samples begin … end - 1 bring to `sum`,
// which is 0. Workers 0 … threads() - 1 are at work at once, each on one shard at a time. Collective.
void sum_over_minibatch(Ranks& ranks, int samples,
                        const std::function<void(int worker, int begin, int end, std::span<float> sum)>& compute,
                        std::span<float> sum);

}  // namespace graphdrl
