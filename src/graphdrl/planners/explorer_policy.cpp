#include "graphdrl/planners/explorer_policy.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "graphdrl/base/error.h"

namespace graphdrl {
namespace {

// Of the rule of choose(), both in nodes; chosen on the validation split.
constexpr double kWorthOfBudget = 0.5;  // of a mean edge's cost, to spend on work out of scope
constexpr double kWorthOfPlenty = 0.1;  // likewise, for each mean edge a node that is left beyond kPlenty; 1 at most
constexpr double kPlenty = 1.2;
constexpr double kIndifference = 0.4;  // by which the nearest may fall behind, all work being out of scope

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
  score(batch, score_);
  const double unseen = batch.unseen[0];
  const double unit = world.open().mean_cost();
  const double worth =
      kWorthOfBudget * unseen + std::clamp(kWorthOfPlenty * (batch.budget_per_work[0] - kPlenty), 0.0, 1.0);
  for (std::size_t i = 0; i < visits.size(); ++i) {
    score_[i] += static_cast<float>(worth * visits[i].cost / unit);
  }
  const double most = *std::min_element(score_.begin(), score_.end()) + kIndifference * unseen * unseen;
  return static_cast<std::size_t>(
      std::find_if(score_.begin(), score_.end(), [&](float score) { return score <= most; }) - score_.begin());
}

Plan explorer_plan(const SearchStart& start, ExplorerGuide& guide, Deadline deadline) {
  ExplorerEncoder& encoder = guide.encoder_for(*start.world);
  std::vector<std::uint64_t> visited = bits_of(start.visited);
  ExplorerState state{.visited = visited.data(), .position = start.position, .spendable = start.limit()};
  ExplorerBatch batch;
  std::vector<NodeId> first_visits;
  bool optimal = true;
  while (!passed(deadline)) {
    batch.clear();
    const std::span<const FirstVisit> visits = encoder.append(state, kExplorerScope, batch);
    if (visits.empty()) return {.walk = walk_through(start, first_visits), .optimal = optimal};
    optimal = optimal && visits.size() == 1 && !encoder.overlooked();
    const FirstVisit& choice = visits[guide.choose(*start.world, batch, visits)];
    first_visits.push_back(choice.node);
    visited[choice.node / 64] |= std::uint64_t{1} << (choice.node % 64);
    state.position = choice.node;
    state.spendable -= choice.cost;
  }
  return {.walk = walk_through(start, first_visits), .optimal = false};
}

}  // namespace graphdrl
