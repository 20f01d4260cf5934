#include "graphdrl/planners/registry.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>
#include <functional>
#include <map>

#include "graphdrl/base/error.h"
#include "graphdrl/planners/baselines.h"
#include "graphdrl/planners/exact.h"
#include "graphdrl/planners/network_policy.h"

namespace graphdrl {
namespace {

using Factory = std::function<std::unique_ptr<Policy>(std::uint64_t seed)>;

const std::map<std::string, Factory>& factories() {
  static const std::map<std::string, Factory> table = {
      {"random", [](std::uint64_t seed) { return std::make_unique<RandomPolicy>(seed); }},
      {"random-walk", [](std::uint64_t seed) { return std::make_unique<RandomWalkPolicy>(seed); }},
      {"dfs", [](std::uint64_t) { return std::make_unique<DepthFirstPolicy>(); }},
      {"nearest", [](std::uint64_t) { return std::make_unique<NearestUnvisitedPolicy>(); }},
      {"exact", [](std::uint64_t) { return std::make_unique<ExactPolicy>(); }},
  };
  return table;
}

}  // namespace

std::unique_ptr<Policy> make_policy(const std::string& name, std::uint64_t seed) {
  const auto factory = factories().find(name);
  if (factory != factories().end()) return factory->second(seed);
  std::error_code error;
  if (std::filesystem::exists(name, error)) return std::make_unique<NetworkPolicy>(read_policy_file(name));
  throw Error({.what = "no such policy", .expected = policy_names(), .got = in_quotes(name, 200)});
}

std::string policy_names() {
  std::vector<std::string> names;
  for (const auto& [name, unused] : factories()) names.push_back(name);
  return fmt::format("{} or a policy file", fmt::join(names, ", "));
}

std::string policy_label(const std::string& name) {
  return factories().contains(name) ? name : std::filesystem::path(name).stem().string();
}

}  // namespace graphdrl
