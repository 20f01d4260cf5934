// One learning step of DQN: targets, loss, Adam, soft update [paper, section 2 and Algorithm 1, lines 9 to 11], as the
// trainer sees it. KernelLearner does it with the kernels of nn/ on the CPU, DeviceLearner with LibTorch's operators on
// any device it has.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "graphdrl/base/random.h"
#include "graphdrl/io/safetensors.h"
#include "graphdrl/nn/paper_network.h"
#include "graphdrl/train/minibatch.h"

namespace graphdrl {

struct LearnerOptions {
  bool double_dqn = false;
  double discount = 0.99;       // alpha
  double learning_rate = 1e-3;  // Adam's
  double soft_update = 1e-3;    // beta
  double dropout = 0.5;
};

// All that a learner has learned; the same whatever device it runs on.
struct LearnerState {
  PaperParameters online;
  PaperParameters target;
  std::vector<float> adam_first;   // [240678], the mean of the gradients
  std::vector<float> adam_second;  // of their squares
  std::int64_t adam_steps = 0;
};

class Learner {
 public:
  virtual ~Learner() = default;

  // One step; gives the loss before it. `rng` draws the dropout.
  virtual double learn(const Minibatch& batch, Rng& rng) = 0;

  // The online network in eval mode. x: [N, F], q: [B, A].
  virtual void q_values(const GraphBatch& batch, std::span<const float> x, std::span<float> q) = 0;

  virtual LearnerState state() const = 0;
  virtual void set_state(const LearnerState& state) = 0;
};

// A learner on a device by its name: "cpu" or "cuda". Initialises the online network from rng and copies it to the
// target. Throws Error where LibTorch does not have the device.
std::unique_ptr<Learner> make_learner(const std::string& device, const LearnerOptions& options, Rng& rng);

// The arrays online.*, target.* and adam.* of a checkpoint, as views of `state`.
void append_state(const LearnerState& state, std::vector<TensorView>& tensors);
// Throws Error where they do not fit.
LearnerState read_state(const Safetensors& file);

}  // namespace graphdrl
