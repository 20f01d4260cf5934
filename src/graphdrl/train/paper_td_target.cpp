#include "graphdrl/train/paper_td_target.h"

#include <algorithm>

namespace graphdrl {

std::vector<float> td_targets(const TdBatch& batch, double discount) {
  std::vector<float> targets(batch.rewards.begin(), batch.rewards.end());
  const std::size_t actions = batch.next_q.size() / targets.size();
  for (std::size_t i = 0; i < targets.size(); ++i) {
    if (batch.terminal[i] != 0) continue;
    const std::span<const float> chooser = batch.chooser.subspan(i * actions, actions);
    const std::ptrdiff_t best = std::max_element(chooser.begin(), chooser.end()) - chooser.begin();
    targets[i] += static_cast<float>(discount) * batch.next_q[i * actions + best];  // y [paper, eq. 5]
  }
  return targets;
}

}  // namespace graphdrl
