// Where the learner of a training comes from. Only the program knows which devices there are, so main makes the source.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "graphdrl/base/random.h"

namespace graphdrl {

class PaperLearner;
struct PaperLearnerOptions;

// This one knows the CPU alone.
class LearnerSource {
 public:
  virtual ~LearnerSource() = default;

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
