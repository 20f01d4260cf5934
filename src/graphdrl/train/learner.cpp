#include "graphdrl/train/learner.h"

#include <torch/torch.h>

#include <algorithm>

#include "graphdrl/base/error.h"
#include "graphdrl/train/device_learner.h"
#include "graphdrl/train/kernel_learner.h"

namespace graphdrl {

std::unique_ptr<Learner> make_learner(const std::string& device, const LearnerOptions& options, Rng& rng) {
  if (device == "cpu") return std::make_unique<KernelLearner>(options, rng);
  if (!torch::cuda::is_available()) {
    throw Error({.what = "this LibTorch finds no CUDA device", .expected = "cpu", .got = device, .where = "--device"});
  }
  return std::make_unique<DeviceLearner>(torch::Device(device), options, rng);
}

void append_state(const LearnerState& state, std::vector<TensorView>& tensors) {
  for (const TensorView& view : state.online.views("online.")) tensors.push_back(view);
  for (const TensorView& view : state.target.views("target.")) tensors.push_back(view);
  const auto count = static_cast<std::int64_t>(PaperParameters::trainable_count());
  tensors.emplace_back("adam.exp_avg", Shape{count}, std::span(state.adam_first));
  tensors.emplace_back("adam.exp_avg_sq", Shape{count}, std::span(state.adam_second));
  tensors.emplace_back("adam.step", Shape{1}, std::span(&state.adam_steps, 1));
}

LearnerState read_state(const Safetensors& file) {
  const auto count = static_cast<std::int64_t>(PaperParameters::trainable_count());
  LearnerState state{.online = PaperParameters::from_file(file, "online."),
                     .target = PaperParameters::from_file(file, "target."),
                     .adam_first = file.get<float>("adam.exp_avg", {count}),
                     .adam_second = file.get<float>("adam.exp_avg_sq", {count}),
                     .adam_steps = file.get<std::int64_t>("adam.step", {1}).front()};
  const bool moments_are_real =
      std::all_of(state.adam_second.begin(), state.adam_second.end(), [](float value) { return value >= 0; });
  if (state.adam_steps < 0 || !moments_are_real)
    throw Error({.what = "Adam's state is damaged", .where = file.source()});
  return state;
}

}  // namespace graphdrl
