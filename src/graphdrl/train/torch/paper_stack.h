// Many trainings of the paper's network on one device, whose learning steps and moves are done together. Each training
// runs on a thread of its own and waits in its learner until all others wait too; then one thread does the work of all.
// So the stack sees the same requests as single learners would, in the same order for each training.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "graphdrl/train/paper_learner.h"

namespace graphdrl {

// One source for each training of a stack on a device; a training leaves when its source is destroyed. Throws Error
// where LibTorch does not have the device.
std::vector<std::unique_ptr<LearnerSource>> stack_sources(const std::string& device, int trainings);

// Learners on the CPU by its kernels, on other devices by LibTorch, those of one kind of training by one stack.
class DeviceLearners final : public LearnerSource {
 public:
  std::unique_ptr<PaperLearner> make(const std::string& device, const PaperLearnerOptions& options,
                                     Rng& rng) const override;
  std::vector<std::unique_ptr<LearnerSource>> make_together(const std::string& device, int trainings) const override;
};

}  // namespace graphdrl
