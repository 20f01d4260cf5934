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
#include "graphdrl/planners/explorer_policy.h"
#include "graphdrl/planners/paper_policy.h"

namespace graphdrl {
namespace {

using Factory = std::function<std::unique_ptr<Policy>(std::uint64_t seed, TimeLimit limit)>;

const std::map<std::string, Factory>& factories() {
  static const std::map<std::string, Factory> table = {
      {"random", [](std::uint64_t seed, TimeLimit) { return std::make_unique<RandomPolicy>(seed); }},
      {"random-walk", [](std::uint64_t seed, TimeLimit) { return std::make_unique<RandomWalkPolicy>(seed); }},
      {"dfs", [](std::uint64_t, TimeLimit) { return std::make_unique<DepthFirstPolicy>(); }},
      {"nearest", [](std::uint64_t, TimeLimit) { return std::make_unique<NearestUnvisitedPolicy>(); }},
      {"explorer", [](std::uint64_t, TimeLimit) { return std::make_unique<ExplorerPolicy>(builtin_explorer()); }},
      {"exact", [](std::uint64_t, TimeLimit limit) { return std::make_unique<ExactPolicy>(limit); }},
  };
  return table;
}

// `beam[:W]` and `guided[:W[:FILE]]`, taken apart.
struct BeamName {
  int width;
  bool guided;
  std::string file;  // empty for the explorer in the program
};

// Empty for another name. Throws Error on a bad width.
std::optional<BeamName> parse_beam_name(std::string_view name) {
  const std::size_t colon = std::min(name.find(':'), name.size());
  const std::string_view kind = name.substr(0, colon);
  if (kind != "beam" && kind != "guided") return std::nullopt;
  BeamName result{.width = BeamOptions{}.width, .guided = kind == "guided", .file = {}};
  if (colon == name.size()) return result;
  std::string_view text = name.substr(colon + 1);
  if (const std::size_t next = text.find(':'); result.guided && next != std::string_view::npos) {
    result.file = text.substr(next + 1);
    text = text.substr(0, next);
    if (result.file.empty()) {
      throw Error({.what = "no policy file is named", .expected = "guided:W:FILE", .got = in_quotes(name, 200)});
    }
  }
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), result.width);
  const bool good = error == std::errc() && end == text.data() + text.size();
  if (good && result.width >= 1 && result.width <= kMaxBeamWidth) return result;
  throw Error({.what = "bad beam width",
               .expected = fmt::format("{}:W with W from 1 to {}", kind, kMaxBeamWidth),
               .got = in_quotes(name, 200)});
}

std::unique_ptr<Policy> policy_of_file(const std::string& path) {
  if (is_explorer_file(path)) return std::make_unique<ExplorerPolicy>(read_explorer_file(path));
  return std::make_unique<PaperPolicy>(read_policy_file(path));
}

}  // namespace

std::unique_ptr<Policy> make_policy(const std::string& name, std::uint64_t seed, TimeLimit limit) {
  if (const auto beam = parse_beam_name(name)) {
    const BeamOptions options{.width = beam->width};
    if (!beam->guided) return std::make_unique<BeamPolicy>(options, limit);
    const SharedExplorer guide = beam->file.empty() ? builtin_explorer() : read_explorer_file(beam->file);
    return std::make_unique<BeamPolicy>(options, guide, limit);
  }
  if (limit && name != "exact") {
    throw Error({.what = "a time limit is for policies that search",
                 .expected = "beam[:W], guided[:W[:FILE]] or exact",
                 .got = in_quotes(name, 200)});
  }
  const auto factory = factories().find(name);
  if (factory != factories().end()) return factory->second(seed, limit);
  std::error_code error;
  if (std::filesystem::exists(name, error)) return policy_of_file(name);
  throw Error({.what = "no such policy", .expected = policy_names(), .got = in_quotes(name, 200)});
}

std::string policy_names() {
  std::vector<std::string> names = {"beam[:W]", "guided[:W[:FILE]]"};
  for (const auto& [name, unused] : factories()) names.push_back(name);
  return fmt::format("{} or a policy file", fmt::join(names, ", "));
}

std::string policy_label(const std::string& name) {
  return factories().contains(name) || parse_beam_name(name) ? name : std::filesystem::path(name).stem().string();
}

}  // namespace graphdrl
