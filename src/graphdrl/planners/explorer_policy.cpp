#include "graphdrl/planners/explorer_policy.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "graphdrl/base/error.h"

namespace graphdrl {
namespace {

// Nodes for a mean edge's cost, and nodes, where all work is out of scope. Chosen on the validation split.
constexpr double kWorthOfBudget = 0.5;
constexpr double kIndifference = 0.4;

}  // namespace

SharedExplorer builtin_explorer() {
  static const SharedExplorer explorer = std::make_shared<const ExplorerParameters>(
      read_explorer(Safetensors::parse(std::string(builtin_explorer_file()), "the policy in the program")));
  return explorer;
}

bool is_explorer_file(const std::string& path) {
  const auto description = policy_description(Safetensors::read(path));
  return description.is_object() && description.value("kind", nlohmann::json()) == "explorer";
}

SharedExplorer read_explorer_file(const std::string& path) {
  return std::make_shared<const ExplorerParameters>(read_explorer(Safetensors::read(path)));
}

void ExplorerGuide::score(const ExplorerBatch& batch, std::vector<float>& shortfall) {
  shortfall.resize(static_cast<std::size_t>(batch.visit_count()));
  network_.forward(batch, shortfall);
  for (const float value : shortfall) {
    if (!std::isfinite(value)) throw Error({.what = "the explorer's weights are too large to compute with"});
  }
}

std::size_t ExplorerGuide::choose(const World& world, const ExplorerBatch& batch, std::span<const FirstVisit> visits) {
  score(batch, shortfall_);
  const double unseen = batch.unseen[0];
  const double unit = world.open().mean_cost();
  for (std::size_t i = 0; i < visits.size(); ++i) {
    shortfall_[i] += static_cast<float>(kWorthOfBudget * unseen * visits[i].cost / unit);
  }
  const float least = *std::min_element(shortfall_.begin(), shortfall_.end());
  const auto good_enough = [&](float value) { return value <= least + kIndifference * unseen * unseen; };
  return static_cast<std::size_t>(std::find_if(shortfall_.begin(), shortfall_.end(), good_enough) - shortfall_.begin());
}

Plan ExplorerPolicy::plan(const SearchStart& start) {
  ExplorerEncoder& encoder = guide_.encoder_for(*start.world);
  std::vector<std::uint64_t> visited((start.visited.size() + 63) / 64);
  for (std::size_t node = 0; node < start.visited.size(); ++node) {
    if (start.visited[node]) visited[node / 64] |= std::uint64_t{1} << (node % 64);
  }
  ExplorerState state{.visited = visited.data(), .position = start.position, .spendable = start.limit()};
  ExplorerBatch batch;
  std::vector<NodeId> first_visits;
  bool optimal = true;
  for (;;) {
    batch.clear();
    const std::span<const FirstVisit> visits = encoder.append(state, kExplorerScope, batch);
    if (visits.empty()) break;
    optimal = optimal && visits.size() == 1 && !encoder.overlooked();
    const FirstVisit& choice = visits[guide_.choose(*start.world, batch, visits)];
    first_visits.push_back(choice.node);
    visited[choice.node / 64] |= std::uint64_t{1} << (choice.node % 64);
    state.position = choice.node;
    state.spendable -= choice.cost;
  }
  return {.walk = walk_through(start, first_visits), .optimal = optimal};
}

}  // namespace graphdrl
