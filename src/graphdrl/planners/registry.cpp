#include "graphdrl/planners/registry.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <charconv>
#include <filesystem>
#include <map>
#include <optional>

#include "graphdrl/base/error.h"
#include "graphdrl/planners/baselines.h"
#include "graphdrl/planners/beam.h"
#include "graphdrl/planners/exact.h"
#include "graphdrl/planners/explorer.h"
#include "graphdrl/planners/local_search.h"
#include "graphdrl/planners/paper_policy.h"
#include "graphdrl/planners/planner_policy.h"

namespace graphdrl {
namespace {

using PlannerFactory = std::unique_ptr<Planner> (*)();
using PolicyFactory = std::unique_ptr<Policy> (*)(std::uint64_t seed);

std::unique_ptr<Planner> make_explorer(SharedExplorer parameters) {
  return std::make_unique<ExplorerPlanner>(std::make_shared<ExplorerScorer>(std::move(parameters)));
}

const std::map<std::string, PlannerFactory>& planners() {
  static const std::map<std::string, PlannerFactory> table = {
      {"dfs", []() -> std::unique_ptr<Planner> { return std::make_unique<DepthFirstPlanner>(); }},
      {"nearest", []() -> std::unique_ptr<Planner> { return std::make_unique<NearestPlanner>(); }},
      {"explorer", [] { return make_explorer(builtin_explorer()); }},
      {"exact",
       []() -> std::unique_ptr<Planner> {
         return std::make_unique<ExactPlanner>(
             std::make_unique<LocalSearchPlanner>(LocalSearchOptions(), make_explorer(builtin_explorer())));
       }},
  };
  return table;
}

const std::map<std::string, PolicyFactory>& random_policies() {
  static const std::map<std::string, PolicyFactory> table = {
      {"random", [](std::uint64_t seed) -> std::unique_ptr<Policy> { return std::make_unique<RandomPolicy>(seed); }},
      {"random-walk",
       [](std::uint64_t seed) -> std::unique_ptr<Policy> { return std::make_unique<RandomWalkPolicy>(seed); }},
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

std::unique_ptr<Planner> make_beam(const BeamName& name) {
  const BeamOptions options{.width = name.width};
  if (!name.guided) return std::make_unique<BeamPlanner>(options);
  const auto scorer =
      std::make_shared<ExplorerScorer>(name.file.empty() ? builtin_explorer() : read_explorer_file(name.file));
  return std::make_unique<BeamPlanner>(options, scorer, std::make_unique<ExplorerPlanner>(scorer));
}

// `search[:ITERATIONS]`; empty for another name. Throws Error on a bad number.
std::optional<std::int64_t> parse_search_name(std::string_view name) {
  constexpr std::string_view kName = "search";
  if (name == kName) return 0;
  if (!name.starts_with(kName) || name[kName.size()] != ':') return std::nullopt;
  const std::string_view text = name.substr(kName.size() + 1);
  std::int64_t iterations = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), iterations);
  const bool good = error == std::errc() && end == text.data() + text.size();
  if (good && iterations >= 1 && iterations <= kMostIterations) return iterations;
  throw Error({.what = "bad number of iterations",
               .expected = fmt::format("search:N with N from 1 to {}", kMostIterations),
               .got = in_quotes(name, 200)});
}

}  // namespace

std::unique_ptr<Planner> make_planner(const std::string& name, std::uint64_t seed) {
  if (const auto iterations = parse_search_name(name)) {
    return std::make_unique<LocalSearchPlanner>(LocalSearchOptions{.iterations = *iterations, .seed = seed},
                                                make_explorer(builtin_explorer()));
  }
  if (const auto beam = parse_beam_name(name)) return make_beam(*beam);
  if (const auto factory = planners().find(name); factory != planners().end()) return factory->second();
  if (random_policies().contains(name)) return nullptr;
  std::error_code error;
  if (!std::filesystem::exists(name, error)) {
    throw Error({.what = "no such policy", .expected = policy_names(), .got = in_quotes(name, 200)});
  }
  return is_explorer_file(name) ? make_explorer(read_explorer_file(name)) : nullptr;
}

std::unique_ptr<Policy> make_policy(const std::string& name, std::uint64_t seed) {
  if (auto planner = make_planner(name, seed)) return std::make_unique<PlannerPolicy>(std::move(planner));
  if (const auto factory = random_policies().find(name); factory != random_policies().end()) {
    return factory->second(seed);
  }
  return std::make_unique<PaperPolicy>(read_policy_file(name));
}

bool is_random(const std::string& name) {
  return random_policies().contains(name);
}

std::string policy_names() {
  std::vector<std::string> names = {"search[:ITERATIONS]", "beam[:W]", "guided[:W[:FILE]]"};
  for (const auto& [name, unused] : planners()) names.push_back(name);
  for (const auto& [name, unused] : random_policies()) names.push_back(name);
  return fmt::format("{} or a policy file", fmt::join(names, ", "));
}

std::string policy_label(const std::string& name) {
  const bool known =
      planners().contains(name) || random_policies().contains(name) || parse_beam_name(name) || parse_search_name(name);
  return known ? name : std::filesystem::path(name).stem().string();
}

}  // namespace graphdrl
