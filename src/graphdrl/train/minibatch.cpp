#include "graphdrl/train/minibatch.h"

#include <algorithm>
#include <atomic>
#include <vector>

#include "graphdrl/base/parallel.h"

namespace graphdrl {

void sum_over_minibatch(Ranks& ranks, int samples,
                        const std::function<void(int worker, int begin, int end, std::span<float> sum)>& compute,
                        std::span<float> sum) {
  ShardedSum shards(ranks, kShards);
  const int first = shards.first_shard();
  const int count = shards.shard_count();
  std::vector<std::vector<float>> sums(static_cast<std::size_t>(count));
  std::atomic<int> next = 0;
  parallel_for(std::min(threads(), count), [&](int worker) {
    for (int shard = next++; shard < count; shard = next++) {
      sums[shard].assign(sum.size(), 0.0f);
      const int begin = samples * (first + shard) / kShards;
      const int end = samples * (first + shard + 1) / kShards;
      if (begin < end) compute(worker, begin, end, sums[shard]);
    }
  });
  shards.sum(sums, sum);
}

}  // namespace graphdrl
