// The trained Q-network of the paper as a policy.
#pragma once

#include <optional>
#include <vector>

#include "graphdrl/env/policy.h"
#include "graphdrl/nn/paper_features.h"
#include "graphdrl/nn/paper_network.h"

namespace graphdrl {

// Takes the action of the highest Q-value, the lowest index among equals; blocked moves are not masked. Works on grids
// of any size, in the directions action space. Throws Error on other worlds.
class PaperPolicy final : public Policy {
 public:
  explicit PaperPolicy(PaperParameters parameters);
  PaperPolicy(const PaperPolicy&) = delete;  // the network points into the parameters

  void act(std::span<const Observation> observations, std::span<int> actions, const Clock& clock = {}) override;

  // q: [B, A], raw. Many or large observations are worked off in blocks, cut by size.
  void q_values(std::span<const Observation> observations, std::span<float> q);

  // Of the world seen last; another one takes its place.
  const PaperFeatureEncoder& encoder_for(const View& view);

 private:
  void q_values_of_block(std::span<const Observation> observations, std::span<float> q);

  PaperParameters parameters_;
  PaperNetwork network_;
  std::optional<PaperFeatureEncoder> encoder_;
  GraphBatch batch_;
  std::vector<float> features_;  // [N, F]
  std::vector<float> q_;         // [B, A]
};

// The index of the largest value, the lowest among equals. REQUIRES: values is not empty.
int argmax(std::span<const float> values);

}  // namespace graphdrl
