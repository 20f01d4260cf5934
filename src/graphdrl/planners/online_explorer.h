// The online explorer: a network that explores unknown maps.
#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include "graphdrl/nn/online_network.h"
#include "graphdrl/planners/rules.h"

namespace graphdrl {

using SharedOnlineExplorer = std::shared_ptr<const OnlineParameters>;

// The policy file that is part of the program, policies/online_explorer.safetensors; made at build time.
std::string_view builtin_online_explorer_file();
SharedOnlineExplorer builtin_online_explorer();

// Makes the first visit with the highest score. Where neighbours have an order, as on cells, the nearest one, of those
// the first: its sweeps are better than anything that the network learned there (docs/unknown.md). Throws Error on a
// map that is known.
class OnlineExplorerPolicy final : public FirstVisitPolicy {
 public:
  explicit OnlineExplorerPolicy(SharedOnlineExplorer parameters) : parameters_(std::move(parameters)) {}

 private:
  NodeId choose(const Exploration& now, const Observation& observation) override;

  SharedOnlineExplorer parameters_;
  OnlineNetwork network_;
  OnlineScratch scratch_;
  std::vector<float> rows_;
  std::vector<float> score_;
};

}  // namespace graphdrl
