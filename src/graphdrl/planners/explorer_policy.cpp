#include "graphdrl/planners/explorer_policy.h"

#include <nlohmann/json.hpp>

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

Plan ExplorerPolicy::plan(const SearchStart& start) {
  return *beam_plan(start, {.width = 1}, {}, &guide_);
}

}  // namespace graphdrl
