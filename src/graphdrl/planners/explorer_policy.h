// The trained explorer as a policy, and as the guide of a beam.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "graphdrl/nn/explorer_network.h"
#include "graphdrl/planners/plan.h"

namespace graphdrl {

using SharedExplorer = std::shared_ptr<const ExplorerParameters>;

// The policy file that is part of the program, policies/explorer.safetensors; made at build time.
std::string_view builtin_explorer_file();
SharedExplorer builtin_explorer();

// Whether a policy file holds an explorer. Throws Error where it holds no policy.
bool is_explorer_file(const std::string& path);

// An explorer from a policy file. Throws Error.
SharedExplorer read_explorer_file(const std::string& path);

// An explorer at work: its network, and what it keeps for each world, which must outlive it. Not thread safe.
class ExplorerGuide {
 public:
  explicit ExplorerGuide(SharedExplorer parameters) : parameters_(std::move(parameters)) {
    network_.set_parameters(*parameters_);
  }

  ExplorerEncoder& encoder_for(const World& world) { return encoders_.try_emplace(&world, world).first->second; }

  // How many nodes the best walk after each first visit falls short of its state's ceiling. shortfall: [C], resized.
  // Throws Error where the network's weights are so large that it gives no number.
  void score(const ExplorerBatch& batch, std::vector<float>& shortfall);

  // Which of a state's first visits to make, of at least one, nearest first; batch: that state alone. A score is the
  // shortfall, and for every mean edge of the first visit's cost 0.5 u nodes, with a share u of the work out of scope,
  // and 0.1 (b - 1.2) nodes, 0 to 1, with b mean edges left for each unvisited node. The nearest whose score is within
  // 0.4 u² of the least: the one of the least shortfall where all the work is in scope and the budget is short. In
  // worlds much larger than the scope, and with budget to spare, which the network would waste, this visits several
  // points more than the shortfall alone (docs/explorer.md).
  std::size_t choose(const World& world, const ExplorerBatch& batch, std::span<const FirstVisit> visits);

 private:
  SharedExplorer parameters_;
  ExplorerNetwork network_;
  std::vector<float> score_;  // of choose()
  std::map<const World*, ExplorerEncoder> encoders_;
};

// One first visit after the other, each as ExplorerGuide::choose says, to the end or until the deadline passes.
Plan explorer_plan(const SearchStart& start, ExplorerGuide& guide, Deadline deadline = {});

// The explorer alone.
class ExplorerPolicy final : public PlanPolicy {
 public:
  explicit ExplorerPolicy(SharedExplorer parameters) : guide_(std::move(parameters)) {}

  Plan plan(const SearchStart& start) override { return explorer_plan(start, guide_); }

 private:
  ExplorerGuide guide_;
};

}  // namespace graphdrl
