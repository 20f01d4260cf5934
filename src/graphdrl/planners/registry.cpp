#include "graphdrl/planners/registry.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <charconv>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>

#include "graphdrl/base/error.h"
#include "graphdrl/planners/baselines.h"
#include "graphdrl/planners/beam.h"
#include "graphdrl/planners/exact.h"
#include "graphdrl/planners/network_policy.h"

namespace graphdrl {
namespace {

using Factory = std::function<std::unique_ptr<Policy>(std::uint64_t seed, TimeLimit limit)>;

const std::map<std::string, Factory>& factories() {
  static const std::map<std::string, Factory> table = {
      {"random", [](std::uint64_t seed, TimeLimit) { return std::make_unique<RandomPolicy>(seed); }},
      {"random-walk", [](std::uint64_t seed, TimeLimit) { return std::make_unique<RandomWalkPolicy>(seed); }},
      {"dfs", [](std::uint64_t, TimeLimit) { return std::make_unique<DepthFirstPolicy>(); }},
      {"nearest", [](std::uint64_t, TimeLimit) { return std::make_unique<NearestUnvisitedPolicy>(); }},
      {"exact", [](std::uint64_t, TimeLimit limit) { return std::make_unique<ExactPolicy>(limit); }},
  };
  return table;
}

constexpr std::string_view kBeam = "beam";

// The width of `beam` or `beam:W`; empty for another name.
std::optional<int> beam_width(std::string_view name) {
  if (name == kBeam) return BeamOptions{}.width;
  if (!name.starts_with(std::string(kBeam) + ':')) return std::nullopt;
  const std::string_view text = name.substr(kBeam.size() + 1);
  int width = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), width);
  if (error == std::errc() && end == text.data() + text.size() && width >= 1 && width <= kMaxBeamWidth) return width;
  throw Error({.what = "bad beam width",
               .expected = fmt::format("beam:W with W from 1 to {}", kMaxBeamWidth),
               .got = in_quotes(name, 200)});
}

}  // namespace

std::unique_ptr<Policy> make_policy(const std::string& name, std::uint64_t seed, TimeLimit limit) {
  if (const auto width = beam_width(name)) return std::make_unique<BeamPolicy>(BeamOptions{.width = *width}, limit);
  if (limit && name != "exact") {
    throw Error({.what = "a time limit is for policies that plan",
                 .expected = "beam[:W] or exact",
                 .got = in_quotes(name, 200)});
  }
  const auto factory = factories().find(name);
  if (factory != factories().end()) return factory->second(seed, limit);
  std::error_code error;
  if (std::filesystem::exists(name, error)) return std::make_unique<NetworkPolicy>(read_policy_file(name));
  throw Error({.what = "no such policy", .expected = policy_names(), .got = in_quotes(name, 200)});
}

std::string policy_names() {
  std::vector<std::string> names = {"beam[:W]"};
  for (const auto& [name, unused] : factories()) names.push_back(name);
  return fmt::format("{} or a policy file", fmt::join(names, ", "));
}

std::string policy_label(const std::string& name) {
  return factories().contains(name) || beam_width(name) ? name : std::filesystem::path(name).stem().string();
}

}  // namespace graphdrl
