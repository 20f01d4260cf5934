#include "graphdrl/planners/explorer_policy.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "graphdrl/base/error.h"
#include "graphdrl/planners/beam.h"

namespace graphdrl {

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

Plan ExplorerPolicy::plan(const SearchStart& start) {
  return *beam_plan(start, {.width = 1}, {}, &guide_);
}

}  // namespace graphdrl
