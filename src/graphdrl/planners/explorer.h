// The trained explorer as a planner, and as the scorer of a beam.
#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include "graphdrl/nn/explorer_network.h"
#include "graphdrl/planners/beam.h"

namespace graphdrl {

using SharedExplorer = std::shared_ptr<const ExplorerParameters>;

// The policy file that is part of the program, policies/explorer.safetensors; made at build time.
std::string_view builtin_explorer_file();
SharedExplorer builtin_explorer();

// An explorer at work: its network, and scratch memory for states of any world. One thread at a time.
class ExplorerScorer final : public FirstVisitScorer {
 public:
  explicit ExplorerScorer(SharedExplorer parameters) : parameters_(std::move(parameters)) {
    network_.set_parameters(*parameters_);
  }

  //   score = shortfall - ceiling - kWorthOfCost · spendable / mean edge cost: how many nodes will be left and what the
  // whole walk costs, but for what all states share.
  // Throws Error where the network's weights are so large that it gives no number.
  bool score(std::span<const Exploration> states, std::vector<ScoredVisit>& visits) override;
  int most_states() const override { return 16; }  // a few milliseconds
  int most_visits() const override { return kExplorerScope; }

  // How many nodes the best walk after each first visit falls short of its state's ceiling. shortfall: [C], resized.
  // Throws Error as score() does.
  void shortfalls(const ExplorerBatch& batch, std::vector<float>& shortfall);

  // Which of a state's first visits to make, of at least one, nearest first; batch: that state alone. With a share u of
  // the work out of scope,
  //   score = shortfall - prize / mean prize (where there are prizes) + 0.5 u cost / mean edge cost.
  // Takes the nearest whose score is at most the least score + 0.8 u²; where edges lead one way, the least score. So
  // the less the network sees, the less its word counts.
  std::size_t choose(const Task& task, const ExplorerBatch& batch, std::span<const FirstVisit> visits);

 private:
  SharedExplorer parameters_;
  ExplorerNetwork network_;
  ExplorerScratch scratch_;
  ExplorerBatch batch_;
  std::vector<float> shortfall_;
};

// The explorer alone: one first visit after the other, each as ExplorerScorer::choose says. Where a deadline cuts it
// short, it is walked on by the nearest rule [plan_by_deadline()].
class ExplorerPlanner final : public Planner {
 public:
  explicit ExplorerPlanner(std::shared_ptr<ExplorerScorer> scorer) : scorer_(std::move(scorer)) {}

  Plan plan(const Task& task, const Clock& clock = {}) override;

 private:
  Plan walk_until(const Task& task, const Clock& clock);

  std::shared_ptr<ExplorerScorer> scorer_;
  ExplorerScratch scratch_;
  NearestFirst search_;
};

}  // namespace graphdrl
