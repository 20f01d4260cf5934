#include "graphdrl/train/td_target.h"

namespace graphdrl {

torch::Tensor td_targets(const TdBatch& batch, double discount) {
  const torch::NoGradGuard no_grad;
  const torch::Tensor best = batch.chooser.argmax(1, /*keepdim=*/true);
  const torch::Tensor value = batch.next_q.gather(1, best).squeeze(1);
  return batch.reward + discount * value.masked_fill(batch.terminal, 0.0);  // y [paper, eq. 5]
}

}  // namespace graphdrl
