// One-step targets for DQN and Double DQN [paper, eq. 5; van Hasselt et al. 2016]:
//   y = r + discount · (1 - terminal) · Q_target(s', a*)
// where a* maximises Q_target(s', ·) (DQN) or Q_online(s', ·) (Double DQN), over all actions: blocked moves can be
// chosen, so they are not masked. A budget that runs out is no terminal state.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace graphdrl {

struct TdBatch {
  std::span<const float> rewards;          // [B]
  std::span<const std::uint8_t> terminal;  // [B], 0 or 1
  std::span<const float> next_q;           // [B, A], from the target network
  std::span<const float> chooser;          // [B, A], what a* maximises: next_q itself, or the online network's
};

// [B]
std::vector<float> td_targets(const TdBatch& batch, double discount);

}  // namespace graphdrl
