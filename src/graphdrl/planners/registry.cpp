#include "graphdrl/planners/registry.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "graphdrl/base/error.h"
#include "graphdrl/planners/baselines.h"
#include "graphdrl/planners/believing_policy.h"
#include "graphdrl/planners/exact.h"
#include "graphdrl/planners/local_search.h"
#include "graphdrl/planners/paper_policy.h"
#include "graphdrl/planners/planner_policy.h"
#include "graphdrl/planners/rules.h"

namespace graphdrl {
namespace {

struct PolicyName {
  std::string_view name;
  PolicyKind kind;
  std::string_view parameters = {};  // as help shows them
};

constexpr std::array<PolicyName, 13> kNames = {{{"search", PolicyKind::kSearch, "[:ITERATIONS]"},
                                                {"beam", PolicyKind::kBeam, "[:W]"},
                                                {"guided", PolicyKind::kGuided, "[:W[:FILE]]"},
                                                {"dfs", PolicyKind::kDepthFirst},
                                                {"exact", PolicyKind::kExact},
                                                {"explorer", PolicyKind::kExplorer},
                                                {"frontier", PolicyKind::kFrontier},
                                                {"nearest", PolicyKind::kNearest},
                                                {"open", PolicyKind::kOpen},
                                                {"pocket", PolicyKind::kPocket},
                                                {"random", PolicyKind::kRandom},
                                                {"random-walk", PolicyKind::kRandomWalk},
                                                {"tour", PolicyKind::kTour, "[:M]"}}};

constexpr std::int64_t kMostFirstVisits = 1'000'000;  // of a part of the frontier

// A whole number from 1 to `most`; empty where the text is none.
std::optional<std::int64_t> parse_count(std::string_view text, std::int64_t most) {
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool good = error == std::errc() && end == text.data() + text.size() && value >= 1 && value <= most;
  return good ? std::optional(value) : std::nullopt;
}

SharedExplorer read_explorer_parameters(const std::string& file) {
  TrainedPolicy policy = read_policy(file);
  if (auto* const explorer = std::get_if<SharedExplorer>(&policy)) return *explorer;
  throw Error({.what = "the policy is no explorer", .expected = "one that `graphdrl train` wrote", .where = file});
}

// What stands behind the first colon of a name.
void parse_parameters(const std::string& name, std::string_view text, PolicySpec& spec) {
  const auto check = [&](bool good, const char* what, const std::string& expected) {
    if (!good) throw Error({.what = what, .expected = expected, .got = in_quotes(name, 200)});
  };
  if (spec.kind == PolicyKind::kSearch) {
    const auto iterations = parse_count(text, kMostIterations);
    check(iterations.has_value(), "bad number of iterations",
          fmt::format("search:N with N from 1 to {}", kMostIterations));
    spec.iterations = *iterations;
    return;
  }
  if (spec.kind == PolicyKind::kTour) {
    const auto smallest = parse_count(text, kMostFirstVisits);
    check(smallest.has_value(), "bad size of a frontier", fmt::format("tour:M with M from 1 to {}", kMostFirstVisits));
    spec.smallest_part = static_cast<int>(*smallest);
    return;
  }
  const std::size_t colon = spec.kind == PolicyKind::kGuided ? text.find(':') : std::string_view::npos;
  const std::string file(colon == std::string_view::npos ? "" : text.substr(colon + 1));
  check(colon == std::string_view::npos || !file.empty(), "no policy file is named", "guided:W:FILE");
  text = text.substr(0, colon);
  const auto width = parse_count(text, kMaxBeamWidth);
  check(width.has_value(), "bad beam width",
        fmt::format("{}:W with W from 1 to {}", name.substr(0, name.find(':')), kMaxBeamWidth));
  spec.width = static_cast<int>(*width);
  if (!file.empty()) spec.trained = read_explorer_parameters(file);
}

// Of the names that are rules on any map.
std::optional<Rule> rule_of(PolicyKind kind) {
  if (kind == PolicyKind::kPocket) return Rule::kPocket;
  if (kind == PolicyKind::kOpen) return Rule::kOpen;
  if (kind == PolicyKind::kFrontier) return Rule::kFrontier;
  if (kind == PolicyKind::kTour) return Rule::kTour;
  return std::nullopt;
}

std::unique_ptr<Planner> explorer_planner(SharedExplorer parameters) {
  return std::make_unique<ExplorerPlanner>(std::make_shared<ExplorerScorer>(std::move(parameters)));
}

std::unique_ptr<Planner> search_planner(std::int64_t iterations = 0, std::uint64_t seed = 1) {
  return std::make_unique<LocalSearchPlanner>(iterations, seed, explorer_planner(builtin_explorer()));
}

}  // namespace

PolicySpec parse_policy(const std::string& name) {
  const std::size_t colon = std::min(name.find(':'), name.size());
  for (const PolicyName& known : kNames) {
    if (known.name != std::string_view(name).substr(0, colon)) continue;
    if (colon < name.size() && known.parameters.empty()) break;
    PolicySpec spec{.kind = known.kind, .label = name};
    if (colon < name.size()) parse_parameters(name, std::string_view(name).substr(colon + 1), spec);
    return spec;
  }
  std::error_code error;
  if (!std::filesystem::exists(name, error)) {
    throw Error({.what = "no such policy", .expected = policy_names(), .got = in_quotes(name, 200)});
  }
  return {.kind = PolicyKind::kFile,
          .trained = read_policy(name),
          .label = escaped(std::filesystem::path(name).stem().string())};
}

bool plans(const PolicySpec& spec) {
  if (spec.kind == PolicyKind::kFile) return std::holds_alternative<SharedExplorer>(spec.trained);
  return spec.kind != PolicyKind::kRandom && spec.kind != PolicyKind::kRandomWalk && !rule_of(spec.kind);
}

std::unique_ptr<Planner> make_planner(const PolicySpec& spec, std::uint64_t seed) {
  const auto* const trained = std::get_if<SharedExplorer>(&spec.trained);
  switch (spec.kind) {
    case PolicyKind::kRandom:
    case PolicyKind::kRandomWalk:
    case PolicyKind::kPocket:
    case PolicyKind::kOpen:
    case PolicyKind::kFrontier:
    case PolicyKind::kTour:
      return nullptr;
    case PolicyKind::kDepthFirst:
      return std::make_unique<DepthFirstPlanner>();
    case PolicyKind::kNearest:
      return std::make_unique<NearestPlanner>();
    case PolicyKind::kBeam:
      return std::make_unique<BeamPlanner>(BeamOptions{.width = spec.width});
    case PolicyKind::kGuided: {
      const auto scorer = std::make_shared<ExplorerScorer>(*trained == nullptr ? builtin_explorer() : *trained);
      return std::make_unique<BeamPlanner>(BeamOptions{.width = spec.width}, scorer,
                                           std::make_unique<ExplorerPlanner>(scorer));
    }
    case PolicyKind::kExplorer:
      return explorer_planner(builtin_explorer());
    case PolicyKind::kSearch:
      return search_planner(spec.iterations, seed);
    case PolicyKind::kExact:
      return std::make_unique<ExactPlanner>(search_planner());
    case PolicyKind::kFile:
      break;
  }
  return trained != nullptr ? explorer_planner(*trained) : nullptr;
}

std::unique_ptr<Policy> make_policy(const PolicySpec& spec, std::uint64_t seed) {
  if (spec.kind == PolicyKind::kRandom || spec.kind == PolicyKind::kRandomWalk) {
    return std::make_unique<RandomPolicy>(seed, /*blocked_too=*/spec.kind == PolicyKind::kRandom);
  }
  if (const auto rule = rule_of(spec.kind)) return std::make_unique<RulePolicy>(*rule, spec.smallest_part);
  if (auto planner = make_planner(spec, seed)) return std::make_unique<PlannerPolicy>(std::move(planner));
  if (const auto* const online = std::get_if<SharedOnlineExplorer>(&spec.trained)) {
    return std::make_unique<OnlineExplorerPolicy>(*online);
  }
  return std::make_unique<PaperPolicy>(std::get<PaperParameters>(spec.trained));
}

std::unique_ptr<Policy> make_online_policy(const PolicySpec& spec, std::uint64_t seed) {
  if (spec.kind == PolicyKind::kNearest) return std::make_unique<RulePolicy>(Rule::kNearest);
  if (spec.kind == PolicyKind::kDepthFirst) return std::make_unique<RulePolicy>(Rule::kDepthFirst);
  if (spec.kind == PolicyKind::kExplorer) return std::make_unique<OnlineExplorerPolicy>(builtin_online_explorer());
  return make_policy(spec, seed);
}

bool plans_online(const PolicySpec& spec) {
  return plans(spec) && spec.kind != PolicyKind::kNearest && spec.kind != PolicyKind::kDepthFirst &&
         spec.kind != PolicyKind::kExplorer;
}

std::unique_ptr<Policy> make_believing_policy(const PolicySpec& spec, std::uint64_t seed,
                                              std::shared_ptr<const BelievedMap> old) {
  if (!plans_online(spec)) {
    throw Error({.what = "the policy does not plan on an old map",
                 .expected = "search, beam, guided, exact or an explorer's file",
                 .got = spec.label});
  }
  return make_believing_policy(make_planner(spec, seed), std::move(old));
}

std::unique_ptr<Policy> make_believing_policy(std::unique_ptr<Planner> planner,
                                              std::shared_ptr<const BelievedMap> old) {
  return std::make_unique<BelievingPolicy>(std::move(old), std::move(planner),
                                           std::make_unique<OnlineExplorerPolicy>(builtin_online_explorer()));
}

TrainedPolicy read_policy(const std::string& name) {
  if (name == "explorer") return builtin_explorer();
  const Safetensors file = Safetensors::read(name);
  const auto description = policy_description(file);
  const auto kind = description.is_object() ? description.value("kind", nlohmann::json()) : nlohmann::json();
  if (kind == "explorer") return std::make_shared<const ExplorerParameters>(read_explorer(file));
  if (kind == "online_explorer") return std::make_shared<const OnlineParameters>(read_online_explorer(file));
  return read_policy_file(name);
}

KnownMapPolicy read_known_map_policy(const std::string& name) {
  TrainedPolicy policy = read_policy(name);
  if (auto* const explorer = std::get_if<SharedExplorer>(&policy)) return *explorer;
  if (auto* const paper = std::get_if<PaperParameters>(&policy)) return std::move(*paper);
  throw Error({.what = "this policy explores maps that are not known", .where = name});
}

std::string policy_names() {
  std::string text;
  for (const PolicyName& known : kNames) text += fmt::format("{}{}, ", known.name, known.parameters);
  return text.substr(0, text.size() - 2) + " or a policy file";
}

}  // namespace graphdrl
