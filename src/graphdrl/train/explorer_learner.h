// One learning step of the explorer: the loss over a minibatch of lessons, its gradient, Adam.
#pragma once

#include <span>
#include <vector>

#include "graphdrl/base/ranks.h"
#include "graphdrl/nn/explorer_network.h"
#include "graphdrl/train/adam.h"
#include "graphdrl/train/lessons.h"

namespace graphdrl {

// Of the loss on which first visit is best: half a node of difference is odds of 1 to e. The weight of that loss was
// tried (docs/explorer.md, "What pays"), this figure was not.
inline constexpr double kRankingTemperature = 0.5;  // nodes

// The loss over states, and its derivative by `shortfall`. label, shortfall, grad: [C]; kUnlabelled ones count for
// nothing. The loss is a mean over all states of the sum of three, the first two of which are means over first visits:
// - Huber's loss [1964, linear past 2 nodes] of shortfall - label, weighed less where even the best falls far short;
// - the same of the deviations from their means: which first visit is better by how much;
// - `ranking` times the cross-entropy of softmax(-shortfall / 0.5) from softmax(-label / 0.5): which one is best.
double explorer_loss(const ExplorerBatch& batch, std::span<const float> label, std::span<const float> shortfall,
                     double ranking, std::span<float> grad);

class ExplorerLearner {
 public:
  // ranking: as of explorer_loss(). Initialises the network from rng. ranks: share the work.
  ExplorerLearner(double ranking, Rng& rng, Ranks& ranks = one_rank());
  ExplorerLearner(const ExplorerLearner&) = delete;

  // One step of Adam at this learning rate, gradients cut to ±1 one by one; gives the loss before it. Collective.
  double learn(std::span<const Lesson* const> lessons, double rate);

  // Of the last step: how many nodes the network's choice, among labelled first visits, is worse than the best of them;
  // a mean over states.
  double regret() const { return regret_; }

  const ExplorerParameters& parameters() const { return parameters_; }
  const AdamState& adam() const { return adam_; }
  void set_state(const ExplorerParameters& parameters, AdamState adam);

 private:
  // What a thread computes the gradient of some lessons with.
  struct Worker {
    ExplorerNetwork network;
    ExplorerScratch scratch;
    ExplorerBatch batch;
    ExplorerParameters grad;
    std::vector<float> label;      // [C]
    std::vector<float> shortfall;  // [C]
    std::vector<float> grad_shortfall;
  };
  struct Losses {
    double loss;
    double regret;
  };
  Losses compute_gradient(std::span<const Lesson* const> lessons, double share, Worker& worker) const;

  double ranking_;
  Ranks& ranks_;
  ExplorerParameters parameters_;
  AdamState adam_;
  std::vector<Worker> workers_;
  std::vector<float> sum_;  // the gradient, the loss, the regret
  double regret_ = 0;
};

}  // namespace graphdrl
