// One learning step of DQN: targets, loss, Adam, soft update [paper, section 2 and Algorithm 1, lines 9 to 11], as the
// recipe sees it. PaperKernelLearner does it with the kernels of nn/ on the CPU, a stack (train/torch/) with
// LibTorch's operators on any device that it has, for many trainings at once.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "graphdrl/base/random.h"
#include "graphdrl/nn/paper_network.h"
#include "graphdrl/train/adam.h"
#include "graphdrl/train/paper_replay_buffer.h"

namespace graphdrl {

struct PaperLearnerOptions {
  bool double_dqn = false;
  double discount = 0.99;       // alpha
  double learning_rate = 1e-3;  // Adam's
  double soft_update = 1e-3;    // beta
  double dropout = 0.5;
  bool tf32 = false;  // products on CUDA with factors of 10 bits
};

// The same whatever device the learner runs on.
struct PaperState {
  PaperParameters online;
  PaperParameters target;
  AdamState adam;

  // At the beginning: the online network initialised from rng, the target its copy.
  static PaperState begin(Rng& rng) {
    const PaperParameters online(rng);
    return {.online = online, .target = online, .adam = AdamState(PaperParameters::trainable_count())};
  }
};

class PaperLearner {
 public:
  virtual ~PaperLearner() = default;

  // One step. `rng` draws the dropout.
  virtual void learn(const PaperMinibatch& batch, Rng& rng) = 0;

  // Losses of the steps since the last call, in order, each from before its update. Waits for the device.
  virtual std::vector<double> take_losses() = 0;

  // The online network in eval mode. x: [N, F], q: [B, A].
  virtual void q_values(const GraphBatch& batch, std::span<const float> x, std::span<float> q) = 0;

  virtual PaperState state() const = 0;
  virtual void set_state(const PaperState& state) = 0;
};

// The dropout of a learning step: 0 with probability p, else 1 / (1 - p); [rows, width].
std::vector<float> draw_keep_scale(int rows, int width, double p, Rng& rng);

// Where the learner of a training comes from. Only the program knows which devices there are, so main makes the source.
// This one knows the CPU alone.
class LearnerSource {
 public:
  virtual ~LearnerSource() = default;

  // Called before a run that is to be gone on with is locked: a program that has the device may take this one's place.
  virtual void prepare(const std::string& /*device*/) const {}

  // Makes a learner on a device by its name, "cpu" or "cuda". It initialises the online network from rng and copies it
  // to the target. Throws Error where there is no such device.
  virtual std::unique_ptr<PaperLearner> make(const std::string& device, const PaperLearnerOptions& options,
                                             Rng& rng) const;

  // Sources for trainings whose work the device does together: one for each, on a thread of its own, for one learner.
  // The device waits for every training whose source is still there. Empty where each training works alone.
  virtual std::vector<std::unique_ptr<LearnerSource>> make_together(const std::string& device, int trainings) const;
};

inline const LearnerSource kCpuLearners{};

}  // namespace graphdrl
