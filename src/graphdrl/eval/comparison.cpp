#include "graphdrl/eval/comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>
#include <set>

#include "graphdrl/base/error.h"
#include "graphdrl/base/random.h"
#include "graphdrl/env/load_worlds.h"
#include "graphdrl/eval/rollout.h"
#include "graphdrl/planners/exact.h"
#include "graphdrl/planners/registry.h"

namespace graphdrl {
namespace {

using Json = nlohmann::ordered_json;

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
// Purposes of derive_seed: what a map's figures are does not depend on the other policies of the comparison.
constexpr std::uint64_t kStartSeeds = 1;
constexpr std::uint64_t kPolicySeeds = 2;
constexpr std::uint64_t kBlockSeeds = 3;  // of a map's policy seed

// One of the policies, its file read once.
struct Contender {
  std::string label;  // the name as given where two would share a label
  bool plans;
  bool believes;  // where there is an old map
  // believed: an old map, or null.
  std::function<std::unique_ptr<Policy>(std::uint64_t seed, const std::shared_ptr<const BelievedMap>& believed)> make;
};

std::vector<Contender> make_contenders(const ComparisonOptions& options) {
  std::vector<Contender> contenders;
  for (const std::string& name : options.policies) {
    if (options.counts_edges()) {
      contenders.push_back({.label = name, .plans = false, .believes = false, .make = {}});
    } else if (const auto own = options.own_policies.find(name); own != options.own_policies.end()) {
      contenders.push_back({name, false, false, [make = own->second](auto&&...) { return make(); }});
    } else {
      const auto spec = std::make_shared<const PolicySpec>(parse_policy(name));
      const bool known = options.reveal.all();
      if (options.until_covered && (spec->kind == PolicyKind::kRandom || spec->kind == PolicyKind::kRandomWalk)) {
        throw Error({.what = "random walks do not end until covered", .got = name});
      }
      const auto make = [spec, known](std::uint64_t seed, const std::shared_ptr<const BelievedMap>& believed) {
        if (believed != nullptr && plans_online(*spec)) return make_believing_policy(*spec, seed, believed);
        return known ? make_policy(*spec, seed) : make_online_policy(*spec, seed);
      };
      contenders.push_back({spec->label, known && plans(*spec), plans_online(*spec), make});
    }
  }
  if (!options.believed.empty() && std::ranges::none_of(contenders, &Contender::believes)) {
    throw Error({.what = "no policy plans on old maps", .expected = "one that plans, as search"});
  }
  std::map<std::string, std::set<std::string>> names;
  for (std::size_t i = 0; i < contenders.size(); ++i) names[contenders[i].label].insert(options.policies[i]);
  for (std::size_t i = 0; i < contenders.size(); ++i) {
    if (names[contenders[i].label].size() > 1) contenders[i].label = options.policies[i];
  }
  return contenders;
}

// A world with what all policies share on it.
struct Arena {
  World world;
  Task task;                           // of any of the starts
  std::vector<NodeId> starts;          // one per episode
  std::optional<double> optimum = {};  // percent, the mean
  std::vector<double> known = {};      // of walks that know the map, by episode; empty where the map is known
};

// What a walk gets that knows the map.
struct KnownResult {
  double value;  // percent, or a cost
  bool optimal;
};

std::optional<KnownResult> known_result(const World& world, const Task& task, const ComparisonOptions& options,
                                        const Clock& clock) {
  if (options.score == Score::kSeen) return std::nullopt;
  if (options.counts_edges()) {
    if (!options.price_s) return std::nullopt;
    const auto [percent, cost] = options.cover_known_edges(world, task);
    return KnownResult{options.until_covered ? cost : percent, /*optimal=*/false};
  }
  if (world.valid_count() <= kOptimumMaxNodes && !options.until_covered) {
    if (const auto prize = exact_prize(task)) return KnownResult{world.percent_of_all(*prize), /*optimal=*/true};
  }
  if (!options.price_s) return std::nullopt;
  const Plan plan = plan_knowing_the_map(task, options.until_covered, *options.price_s, options.seed, clock);
  if (options.until_covered && plan.visited < std::ssize(task.reach().nodes)) return std::nullopt;  // time was short
  return KnownResult{options.until_covered ? plan.cost : world.percent_of_all(plan.prize), /*optimal=*/false};
}

constexpr const char* kOptimumKey = "optimum";
constexpr const char* kKnownKey = "known";

// What is known of the optimum: its mean over the starts, and what is known of each; nothing where one is out of reach.
Json solve(const Arena& arena, const ComparisonOptions& options, const Clock& clock) {
  std::map<NodeId, std::optional<KnownResult>> by_start;
  Task task = arena.task;
  std::vector<double> values;
  bool optimal = true;
  for (const NodeId start : arena.starts) {
    const auto [result, fresh] = by_start.try_emplace(start);
    if (fresh) {
      task.start_at(start);
      result->second = known_result(arena.world, task, options, clock);
    }
    if (!result->second) return nullptr;
    values.push_back(result->second->value);
    optimal = optimal && result->second->optimal;
  }
  Json solved = Json::object();
  if (optimal) {
    solved[kOptimumKey] = std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
  }
  if (!options.reveal.all()) solved[kKnownKey] = values;
  return solved;
}

// Results by task; nothing where those of other shares are lacking. Failed ones are empty.
using Tasks = std::function<std::optional<std::vector<Json>>(const std::vector<std::string>& names,
                                                             const std::function<Json(int task)>& compute)>;

// Throws Error on options that do not go together.
void check_options(const std::vector<World>& worlds, const ComparisonOptions& options) {
  if (options.episodes < 1) {
    throw Error({.what = "too few episodes", .expected = "at least 1", .got = std::to_string(options.episodes)});
  }
  if (options.price_s && options.score == Score::kSeen) {
    throw Error({.what = "the price of ignorance is that of nodes visited", .got = "the score seen"});
  }
  if (options.until_covered && ((options.reveal.all() && !options.counts_edges()) || options.budget)) {
    throw Error({.what = "until covered goes with maps that are not known, and without a budget"});
  }
  if (options.counts_edges() && options.budget && !options.budget->cost()) {
    throw Error({.what = "a multiple is of nodes, and edges count here",
                 .expected = "a budget in units of cost",
                 .got = in_quotes(options.budget->text())});
  }
  if (!options.believed.empty() && (options.reveal.all() || options.believed.size() != worlds.size())) {
    throw Error({.what = "old maps go with maps that are not known, one for each"});
  }
  if (options.all_starts && !options.start.empty()) {
    throw Error({.what = "both a start and all starts", .expected = "one of the two"});
  }
  if (options.price_s && options.reveal.all()) {
    throw Error({.what = "the price of ignorance is that of maps that are not known", .got = "a reveal of all"});
  }
  const auto one_way = [](const World& world) { return world.open().directed(); };
  if (options.until_covered && !options.counts_edges() && std::ranges::any_of(worlds, one_way)) {
    throw Error({.what = "costs until covered cannot be compared where edges lead one way",
                 .where = std::ranges::find_if(worlds, one_way)->name()});
  }
}

std::vector<NodeId> draw_starts(const World& world, const ComparisonOptions& options, std::size_t map) {
  const auto nodes = world.valid_nodes();
  if (options.all_starts) return {nodes.begin(), nodes.end()};
  const NodeId start = options.start.empty() ? world.given().start : parse_node(world, options.start, "start");
  if (start != kNoNode) return std::vector<NodeId>(options.episodes, start);
  Rng rng(derive_seed(options.seed, kStartSeeds, map));
  std::vector<NodeId> starts;
  starts.reserve(static_cast<std::size_t>(options.episodes));
  for (int i = 0; i < options.episodes; ++i) {
    starts.push_back(nodes[rng.below(static_cast<std::uint32_t>(nodes.size()))]);
  }
  return starts;
}

std::vector<Arena> make_arenas(const std::vector<World>& worlds, const ComparisonOptions& options) {
  std::vector<Arena> arenas;
  for (const World& world : worlds) {
    Asked asked{.budget = options.budget};
    if (options.until_covered) asked.budget = Budget(kNoLimit);
    if (!asked.budget && !world.given().budget) asked.budget = Budget(kPaperBudget);
    if (!options.end.empty()) asked.end = parse_end(world, options.end);
    const std::vector<NodeId> starts = draw_starts(world, options, arenas.size());
    asked.start = starts.front();
    Task task(world, asked);
    if (!task.ends_at_start()) {
      for (const NodeId start : starts) task.start_at(start);  // throws Error where the end is out of reach
    }
    arenas.push_back({.world = world, .task = task, .starts = starts});
  }
  return arenas;
}

// Episodes that one policy walks side by side, in order of start: a planner plans once for all that start at a node.
struct Block {
  int policy;
  int map;
  std::vector<int> episodes;
};

// Planners get their starts one by one, others as many together as pays.
std::vector<Block> make_blocks(const std::vector<Arena>& arenas, const std::vector<Contender>& contenders) {
  std::vector<Block> blocks;
  for (int policy = 0; policy < std::ssize(contenders); ++policy) {
    const bool plans = contenders[policy].plans;
    for (int map = 0; map < std::ssize(arenas); ++map) {
      const std::vector<NodeId>& starts = arenas[map].starts;
      std::vector<int> order(starts.size());
      std::iota(order.begin(), order.end(), 0);
      if (plans) std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return starts[a] < starts[b]; });
      const int most = block_size(arenas[map].world);
      bool open = false;
      for (std::size_t i = 0; i < order.size(); ++i) {
        const bool same_start = i > 0 && starts[order[i]] == starts[order[i - 1]];
        if (!open || std::ssize(blocks.back().episodes) == most || (plans && !same_start)) {
          blocks.push_back({.policy = policy, .map = map, .episodes = {}});
          open = true;
        }
        blocks.back().episodes.push_back(order[i]);
      }
    }
  }
  return blocks;
}

// Percents or costs, by policy, map and episode; an empty one where a policy's search is out of reach.
using Results = std::vector<std::vector<std::vector<double>>>;

// The values of a block's episodes; null where the policy's search is out of reach.
Json measure_block(const Block& block, const Arena& arena, const Contender& contender, const ComparisonOptions& options,
                   const Clock& clock) {
  const std::uint64_t map_seed = derive_seed(options.seed, kPolicySeeds, static_cast<std::uint64_t>(block.map));
  const std::uint64_t block_seed = derive_seed(map_seed, kBlockSeeds, static_cast<std::uint64_t>(block.episodes[0]));
  Json values = Json::array();
  if (options.counts_edges()) {
    for (const int episode : block.episodes) {
      Task task = arena.task;
      task.start_at(arena.starts[episode]);
      const std::uint64_t seed = derive_seed(map_seed, kBlockSeeds, static_cast<std::uint64_t>(episode));
      const auto [percent, cost] = options.cover_edges(arena.world, task, contender.label, seed);
      values.push_back(options.until_covered ? cost : percent);
    }
    return values;
  }
  const auto believed = options.believed.empty() ? nullptr : options.believed[block.map];
  const auto policy = contender.make(block_seed, believed);
  std::vector<NodeId> starts;
  for (const int episode : block.episodes) starts.push_back(arena.starts[episode]);
  try {
    const EpisodeOptions walks{
        .action_space = options.reveal.all() ? action_space_of(arena.world) : ActionSpace::kNeighbours,
        .reveal = options.reveal,
        .score = options.score,
        .believed = believed,
        .numbers_seed = map_seed};
    for (const auto& result :
         roll_out(Episode(arena.world, arena.task, walks), starts, *policy, clock, block.episodes)) {
      values.push_back(options.until_covered ? result.cost : arena.world.percent_of_all(result.prize));
    }
  } catch (const SearchOutOfReach&) {
    return nullptr;
  }
  return values;
}

// Nothing where results of other shares are lacking.
std::optional<Results> measure(std::vector<Arena>& arenas, const std::vector<Contender>& contenders,
                               const ComparisonOptions& options, const Tasks& do_tasks, const Clock& clock) {
  const std::vector<Block> blocks = make_blocks(arenas, contenders);
  std::vector<std::string> names;
  for (std::size_t map = 0; map < arenas.size(); ++map) names.push_back(fmt::format("known-{:05}", map));
  for (std::size_t b = 0; b < blocks.size(); ++b) names.push_back(fmt::format("episodes-{:06}", b));
  const auto results = do_tasks(names, [&](int task) {
    if (task < std::ssize(arenas)) return solve(arenas[task], options, clock);
    const Block& block = blocks[task - arenas.size()];
    return measure_block(block, arenas[block.map], contenders[block.policy], options, clock);
  });
  if (!results) return std::nullopt;
  for (std::size_t map = 0; map < arenas.size(); ++map) {
    const Json& solved = (*results)[map];
    if (solved.contains(kOptimumKey)) arenas[map].optimum = solved[kOptimumKey];
    if (solved.contains(kKnownKey)) arenas[map].known = solved[kKnownKey].get<std::vector<double>>();
  }
  Results measured(contenders.size(), std::vector<std::vector<double>>(arenas.size()));
  for (auto& of_policy : measured) {
    for (std::size_t map = 0; map < arenas.size(); ++map) of_policy[map].resize(arenas[map].starts.size());
  }
  std::vector<const Block*> lacking;
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    const Json& values = (*results)[arenas.size() + b];
    const Block& block = blocks[b];
    if (values.is_null()) lacking.push_back(&block);
    for (std::size_t i = 0; i < values.size(); ++i) measured[block.policy][block.map][block.episodes[i]] = values[i];
  }
  for (const Block* const block : lacking) measured[block->policy][block->map].clear();
  return measured;
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
  if (overall.maps > 0 && all_known) overall.ratio_to_optimum = optimum_sum > 0 ? sum / optimum_sum : 1;
  return overall;
}

// REQUIRES: rows are one policy's, as many as families.
std::vector<FamilyRow> summarise_families(std::span<const ComparisonRow> rows,
                                          const std::vector<std::string>& families) {
  std::vector<std::string> names;
  for (const std::string& family : families) {
    if (std::ranges::find(names, family) == names.end()) names.push_back(family);
  }
  std::vector<FamilyRow> summaries;
  for (const std::string& name : names) {
    std::vector<const ComparisonRow*> maps;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      if (families[i] == name && rows[i].coverage) maps.push_back(&rows[i]);
    }
    const auto over = [&](std::optional<Summary> ComparisonRow::*what) -> std::optional<Summary> {
      if (maps.empty() ||
          !std::ranges::all_of(maps, [&](const ComparisonRow* row) { return (row->*what).has_value(); })) {
        return std::nullopt;
      }
      if (maps.size() == 1) return maps.front()->*what;
      std::vector<double> means;
      means.reserve(maps.size());
      for (const ComparisonRow* const row : maps) means.push_back((row->*what)->mean);
      return summarise(means);
    };
    summaries.push_back({.family = name,
                         .policy = rows.front().policy,
                         .maps = static_cast<int>(maps.size()),
                         .coverage = over(&ComparisonRow::coverage),
                         .known = over(&ComparisonRow::known),
                         .price = over(&ComparisonRow::price)});
  }
  return summaries;
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

Plan plan_knowing_the_map(const Task& task, bool until_covered, double seconds, std::uint64_t seed,
                          const Clock& clock) {
  constexpr double kFirstSaving = 0.1;    // of the cost
  constexpr double kShare = 0.3;          // of the time left, for each try
  constexpr double kLeastSaving = 0.001;  // likewise: the search ends where it fails to save this
  const Clock until = clock.at_most(seconds);
  const auto planner = make_planner("search", seed);
  Plan best = planner->plan(task, until);
  double saving = kFirstSaving;
  while (until_covered && best.cost > 0 && saving >= kLeastSaving && !until.passed()) {
    const double budget = best.cost * (1 - saving);
    if (budget < task.cost_to_end(task.start())) break;
    const Task cheaper(task.view(), task.start(), budget, task.ends_anywhere() ? End::anywhere() : End::at(task.end()));
    Plan plan = planner->plan(cheaper, until.share(kShare));
    if (plan.visited >= best.visited) {
      best = std::move(plan);
    } else {
      saving /= 2;
    }
  }
  return best;
}

double price_of_ignorance(double known, double unknown, bool costs) {
  const double more = costs ? unknown : known;
  const double less = costs ? known : unknown;
  return less > 0 ? more / less : 1;
}

Comparison compare(const std::vector<World>& worlds, const ComparisonOptions& options, const Clock& clock) {
  return compare(worlds, options, {}, nullptr, clock).value();
}

std::optional<Comparison> compare(const std::vector<World>& worlds, const ComparisonOptions& options,
                                  const TaskWorkers& workers, const TaskFolder* folder, const Clock& clock) {
  check_options(worlds, options);
  const std::vector<Contender> contenders = make_contenders(options);
  std::vector<Arena> arenas = make_arenas(worlds, options);
  const auto do_tasks = [&](const auto& names, const auto& work) { return results_of(names, folder, workers, work); };
  const std::optional<Results> measured = measure(arenas, contenders, options, do_tasks, clock);
  if (!measured) return std::nullopt;
  const Results& results = *measured;
  Comparison comparison{.options = options, .rows = {}, .overall = {}, .families = {}};
  for (std::size_t policy = 0; policy < contenders.size(); ++policy) {
    const std::string& label = contenders[policy].label;
    for (std::size_t map = 0; map < arenas.size(); ++map) {
      const Arena& arena = arenas[map];
      const std::vector<double>& values = results[policy][map];
      comparison.rows.push_back({.map = arena.world.name(),
                                 .policy = label,
                                 .valid_nodes = arena.world.valid_count(),
                                 .has_prizes = arena.world.has_prizes(),
                                 .given = arena.world.given(),
                                 .budget = arena.task.budget(),
                                 .episodes = static_cast<int>(arena.starts.size()),
                                 .coverage = values.empty() ? std::nullopt : std::optional(summarise(values)),
                                 .optimum = arena.optimum,
                                 .paper = arena.task.ends_anywhere() && !options.counts_edges()
                                              ? paper_result(arena.world.name(), arena.task.budget())
                                              : std::nullopt,
                                 .known = {},
                                 .price = {}});
      if (arena.known.empty() || values.empty()) continue;
      std::vector<double> prices;
      for (std::size_t i = 0; i < values.size(); ++i) {
        prices.push_back(price_of_ignorance(arena.known[i], values[i], options.until_covered));
      }
      comparison.rows.back().known = summarise(arena.known);
      comparison.rows.back().price = summarise(prices);
    }
    const auto rows = std::span(std::as_const(comparison.rows)).last(arenas.size());
    comparison.overall.push_back(summarise_rows(label, rows));
    if (options.families.empty()) continue;
    const std::vector<FamilyRow> families = summarise_families(rows, options.families);
    comparison.families.insert(comparison.families.end(), families.begin(), families.end());
  }
  return comparison;
}

}  // namespace graphdrl
