#include "graphdrl/eval/comparison.h"

#include <algorithm>
#include <array>

#include "graphdrl/base/error.h"
#include "graphdrl/base/random.h"
#include "graphdrl/eval/rollout.h"
#include "graphdrl/planners/exact.h"
#include "graphdrl/planners/registry.h"

namespace graphdrl {
namespace {

// The paper, Table 2: environments a to j.
constexpr std::array<PaperResult, 10> kPaperTable2 = {{{89.8, 8.3, 100.0},
                                                       {61.9, 25.6, 88.9},
                                                       {78.5, 10.7, 94.4},
                                                       {55.2, 20.7, 88.9},
                                                       {74.0, 9.5, 89.5},
                                                       {62.6, 18.0, 83.3},
                                                       {71.4, 19.1, 88.2},
                                                       {63.5, 11.1, 81.0},
                                                       {56.0, 23.9, 85.0},
                                                       {82.1, 9.2, 95.5}}};
constexpr double kPaperBudget = 25;

// Purposes of derive_seed: what a map's figures are does not depend on the other policies of the comparison.
constexpr std::uint64_t kStartSeeds = 1;
constexpr std::uint64_t kPolicySeeds = 2;

// A world with what all policies share on it.
struct Arena {
  const World* world;
  double budget;
  std::vector<NodeId> starts;
  std::optional<double> optimum;  // percent
};

std::optional<double> mean_optimum(const Arena& arena) {
  const int nodes = arena.world->valid_count();
  if (nodes > kOptimumMaxNodes) return std::nullopt;
  std::vector<std::optional<double>> by_start(arena.world->graph().node_count());
  double sum = 0;
  for (const NodeId start : arena.starts) {
    if (!by_start[start]) {
      const auto gain = exact_gain(search_start(*arena.world, start, arena.budget));
      if (!gain) return std::nullopt;
      by_start[start] = 100.0 * (1 + *gain) / nodes;
    }
    sum += *by_start[start];
  }
  return sum / static_cast<double>(arena.starts.size());
}

std::vector<Arena> make_arenas(const std::vector<World>& worlds, const ComparisonOptions& options) {
  std::vector<Arena> arenas;
  for (const World& world : worlds) {
    Arena arena{.world = &world, .budget = options.budget.cost_in(world), .starts = {}, .optimum = {}};
    const auto nodes = world.valid_nodes();
    if (options.all_starts) {
      arena.starts.assign(nodes.begin(), nodes.end());
    } else {
      Rng rng(derive_seed(options.seed, kStartSeeds, arenas.size()));
      for (int i = 0; i < options.episodes; ++i) {
        arena.starts.push_back(nodes[rng.below(static_cast<std::uint32_t>(nodes.size()))]);
      }
    }
    arena.optimum = mean_optimum(arena);
    arenas.push_back(std::move(arena));
  }
  return arenas;
}

std::optional<Summary> measure(const Arena& arena, Policy& policy) {
  const EpisodeOptions options{.budget = arena.budget, .action_space = action_space_of(*arena.world)};
  std::vector<double> coverages;
  try {
    for (const RolloutResult& result : roll_out(*arena.world, arena.starts, options, policy)) {
      coverages.push_back(100.0 * result.coverage);
    }
  } catch (const SearchOutOfReach&) {
    return std::nullopt;
  }
  return summarise(coverages);
}

// A policy's label; the name as given where two policies would share one.
std::string unambiguous_label(const std::string& name, const std::vector<std::string>& all) {
  const std::string label = policy_label(name);
  for (const std::string& other : all) {
    if (other != name && policy_label(other) == label) return name;
  }
  return label;
}

ComparisonOverall summarise_rows(const std::string& policy, std::span<const ComparisonRow> rows) {
  ComparisonOverall overall{.policy = policy, .maps = 0, .mean = {}, .ratio_to_optimum = {}};
  double sum = 0;
  double optimum_sum = 0;
  bool all_known = true;
  for (const ComparisonRow& row : rows) {
    if (!row.coverage) continue;
    ++overall.maps;
    sum += row.coverage->mean;
    all_known = all_known && row.optimum.has_value();
    optimum_sum += row.optimum.value_or(0);
  }
  if (overall.maps > 0) overall.mean = sum / overall.maps;
  if (overall.maps > 0 && all_known) overall.ratio_to_optimum = sum / optimum_sum;
  return overall;
}

}  // namespace

std::optional<PaperResult> paper_result(const std::string& map, double budget) {
  constexpr std::string_view kPrefix = "paper:";
  if (budget != kPaperBudget || map.size() != kPrefix.size() + 1 || !map.starts_with(kPrefix)) {
    return std::nullopt;
  }
  const int index = map.back() - 'a';
  if (index < 0 || index >= std::ssize(kPaperTable2)) return std::nullopt;
  return kPaperTable2[index];
}

Comparison compare(const std::vector<World>& worlds, const ComparisonOptions& options) {
  if (options.episodes < 1) {
    throw Error({.what = "too few episodes", .expected = "at least 1", .got = std::to_string(options.episodes)});
  }
  for (const std::string& name : options.policies) make_policy(name, 0);  // a bad name fails before any work

  Comparison comparison{.options = options, .rows = {}, .overall = {}};
  const std::vector<Arena> arenas = make_arenas(worlds, options);
  for (const std::string& name : options.policies) {
    const std::string label = unambiguous_label(name, options.policies);
    for (std::size_t map = 0; map < arenas.size(); ++map) {
      const Arena& arena = arenas[map];
      const auto policy = make_policy(name, derive_seed(options.seed, kPolicySeeds, map));
      comparison.rows.push_back({.map = arena.world->name(),
                                 .policy = label,
                                 .valid_nodes = arena.world->valid_count(),
                                 .budget = arena.budget,
                                 .episodes = static_cast<int>(arena.starts.size()),
                                 .coverage = measure(arena, *policy),
                                 .optimum = arena.optimum,
                                 .paper = paper_result(arena.world->name(), arena.budget)});
    }
    comparison.overall.push_back(summarise_rows(label, std::span(comparison.rows).last(arenas.size())));
  }
  return comparison;
}

}  // namespace graphdrl
