// One-step targets for DQN and Double DQN [paper, eq. 5; van Hasselt et al. 2016]:
//   y = r + discount · (1 - terminal) · Q_target(s', a*)
// where a* maximises Q_target(s', ·) (DQN) or Q_online(s', ·) (Double DQN), over all actions: blocked moves can be
// chosen, so they are not masked. A budget that runs out is no terminal state.
#pragma once

#include <torch/types.h>

namespace graphdrl {

struct TdBatch {
  torch::Tensor reward;    // [B] float32
  torch::Tensor terminal;  // [B] bool
  torch::Tensor next_q;    // [B, A] float32, from the target network
  torch::Tensor chooser;   // [B, A] float32, what a* maximises: next_q itself, or the online network's
};

// [B] float32; no gradient flows through it.
torch::Tensor td_targets(const TdBatch& batch, double discount);

}  // namespace graphdrl
