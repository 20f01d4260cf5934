#include "graphdrl/train/adam.h"

#include <gtest/gtest.h>
#include <torch/torch.h>

#include "graphdrl/base/parallel.h"

namespace graphdrl {
namespace {

std::span<float> values_of(const torch::Tensor& tensor) {
  return {tensor.data_ptr<float>(), static_cast<std::size_t>(tensor.numel())};
}

TEST(Adam, IsLibTorchsWithClampedGradients) {
  torch::manual_seed(1);
  constexpr std::int64_t kCount = 40'001;  // blocks, and a remainder
  const torch::Tensor expected = torch::randn({kCount}).requires_grad_(true);
  const torch::Tensor values = expected.detach().clone();
  torch::optim::Adam reference({expected}, torch::optim::AdamOptions(3e-3));
  AdamState adam(kCount);
  for (int step = 0; step < 20; ++step) {
    const torch::Tensor grad = torch::randn({kCount}) * 0.8;
    set_threads(1 + step % 3);
    adam.step(values_of(grad), 3e-3, values_of(values));
    expected.mutable_grad() = grad.clamp(-1, 1);
    reference.step();
  }
  set_threads(1);
  EXPECT_EQ(adam.steps, 20);
  EXPECT_TRUE(torch::allclose(values, expected, 1e-5, 1e-6));
}

}  // namespace
}  // namespace graphdrl
