// The table of docs/explorer.md: the explorer and the planners on worlds of the test split.
//   explorer_table [--policy FILE] [--quick]
// Every walk is walked through an Episode before it counts. Intervals are 95 % of the mean over worlds, a world's
// figure being the mean over its starts.
#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>
#include <string_view>

#include "graphdrl/base/parallel.h"
#include "graphdrl/env/load_worlds.h"
#include "graphdrl/env/walk.h"
#include "graphdrl/env/world_families.h"
#include "graphdrl/eval/rollout.h"
#include "graphdrl/eval/statistics.h"
#include "graphdrl/planners/beam.h"
#include "graphdrl/planners/bound.h"
#include "graphdrl/planners/exact.h"

namespace graphdrl {
namespace {

constexpr int kAllStarts = 0;

struct Case {
  std::string name;
  double budget;  // times the valid nodes and the mean cost, or steps where above 10
  int worlds;
  int starts;  // per world
  bool large = false;
  std::function<World(int)> world;
};

Case of_split(const WorldSpec& spec, double budget, int worlds, int starts, bool large = false) {
  return {spec.name(), budget, worlds,
          starts,      large,  [spec](int index) { return split_world(spec, Split::kTest, index); }};
}

// One policy's walks over all worlds of a case.
struct Column {
  std::string name;
  std::function<std::vector<NodeId>(const SearchStart&)> walk;
  std::vector<double> coverage{};  // by world, percent
  std::vector<double> times_s{};
  double visits = 0;
};

std::vector<NodeId> nearest_walk(const SearchStart& start) {
  NearestUnvisitedPolicy policy;
  const NodeId from = start.position;
  const EpisodeOptions options{.budget = start.budget_left, .action_space = action_space_of(*start.world)};
  return roll_out(*start.world, std::span(&from, 1), options, policy).front().walk;
}

std::string with_interval(const std::vector<double>& values) {
  const Summary summary = summarise(values);
  if (!summary.ci95) return fmt::format("{:.1f}", summary.mean);
  return fmt::format("{:.1f} ± {:.1f}", summary.mean, summary.mean - summary.ci95->low);
}

std::string difference(const Column& a, const Column& b) {
  std::vector<double> values;
  for (std::size_t i = 0; i < a.coverage.size(); ++i) values.push_back(a.coverage[i] - b.coverage[i]);
  return with_interval(values);
}

void print_case(const Case& one, const SharedExplorer& explorer) {
  // Policies keep what they know of a world, so each world has its own.
  std::vector<Column> columns = {
      {"nearest", nearest_walk},
      {"beam:50", [](const SearchStart& s) { return beam_plan(s, {.width = 50})->walk; }},
      {"beam:1000", [&](const SearchStart& s) { return beam_plan(s, {.width = one.large ? 1 : 1000})->walk; }},
      {"explorer", [&](const SearchStart& s) { return ExplorerPolicy(explorer).plan(s).walk; }},
      {"guided:16", [&](const SearchStart& s) { return BeamPolicy({.width = 16}, explorer).plan(s).walk; }},
      {"guided:50",
       [&](const SearchStart& s) { return BeamPolicy({.width = one.large ? 16 : 50}, explorer).plan(s).walk; }},
  };
  std::vector<double> bounds;
  double nodes = 0;
  bool optimum = one.name.starts_with("obstacles-5") || one.name.starts_with("paper");
  for (int index = 0; index < one.worlds; ++index) {
    const World world = one.world(index);
    const double n = world.valid_count();
    nodes += n / one.worlds;
    const double budget = one.budget > 10 ? one.budget : std::floor(one.budget * n + 1e-9) * world.open().mean_cost();
    std::vector<NodeId> starts(world.valid_nodes().begin(), world.valid_nodes().end());
    if (one.starts != kAllStarts) {
      Rng rng(derive_seed(1, 0, static_cast<std::uint64_t>(index)));
      starts.clear();
      for (int i = 0; i < one.starts; ++i) {
        starts.push_back(world.valid_nodes()[rng.below(static_cast<std::uint32_t>(world.valid_count()))]);
      }
    }
    const auto share = 100 / n / static_cast<double>(starts.size());
    for (Column& column : columns) column.coverage.push_back(0);
    bounds.push_back(0);
    for (const NodeId start : starts) {
      const SearchStart from = search_start(world, start, budget);
      const std::optional<int> best = optimum ? exact_gain(from) : std::nullopt;
      bounds.back() += share * (best ? *best + 1 : max_visited(from));
      for (Column& column : columns) {
        const auto begin = std::chrono::steady_clock::now();
        const std::vector<NodeId> walk = column.walk(from);
        column.times_s.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
        Episode check(world, {.budget = budget, .action_space = action_space_of(world)});
        follow_walk(check, walk);
        column.coverage.back() += share * check.visited_count();
        column.visits += check.visited_count() - 1;
      }
    }
  }
  std::string line = fmt::format("| {} | {:.0f} | {:g}{} |", one.name, nodes, one.budget, one.budget > 10 ? "" : "x");
  for (const Column& column : columns) line += fmt::format(" {} |", with_interval(column.coverage));
  line += fmt::format(" {:.1f}{} | {} | {} | {} |", summarise(bounds).mean, optimum ? " (optimum)" : "",
                      difference(columns[3], columns[0]), difference(columns[4], columns[1]),
                      difference(columns[5], columns[2]));
  for (const Column& column : columns) line += fmt::format(" {:.2g}", 1e3 * median(column.times_s));
  double total = 0;
  for (const double time_s : columns[3].times_s) total += time_s;
  line += fmt::format(" | {:.2f} |\n", 1e3 * total / columns[3].visits);
  std::fputs(line.c_str(), stdout);
  std::fflush(stdout);
}

int print_table(const SharedExplorer& explorer, bool quick) {
  std::vector<Case> cases;
  const int some = quick ? 10 : 100;
  const int few = quick ? 5 : 40;
  const std::vector<World> paper = load_worlds({"paper"});
  cases.push_back({"paper:a–j", 25, 10, kAllStarts, false, [&](int index) { return paper[index]; }});
  cases.push_back(of_split({"obstacles", 5}, 1.1, quick ? 30 : 300, kAllStarts));
  cases.push_back(of_split({"loop-maze", 11}, 1.0, some, 3));
  cases.push_back(of_split({"loop-maze", 11}, 1.25, some, 3));
  for (const char* const family : {"maze", "braided-maze", "rooms", "obstacles"}) {
    cases.push_back(of_split({family, 11}, 1.0, some, 3));
  }
  for (const char* const family : {"tree", "erdos-renyi", "barabasi-albert", "watts-strogatz", "geometric"}) {
    for (const int nodes : {50, 200}) {
      for (const bool weighted : {false, true}) {
        for (const bool directed : {false, true}) {
          if (directed && family == std::string_view("tree")) continue;
          cases.push_back(of_split({family, nodes, weighted, directed}, 1.0, nodes == 200 ? few / 2 : few, 2));
        }
      }
    }
  }
  for (const WorldSpec& spec : {WorldSpec{"obstacles", 60}, {"loop-maze", 61}, {"rooms", 60}}) {
    cases.push_back(of_split(spec, 1.0, quick ? 2 : 8, 1, /*large=*/true));
  }
  std::fputs(
      "| worlds | nodes | budget | nearest | beam:50 | beam:1000 | explorer | guided:16 | guided:50 | bound | explorer "
      "− "
      "nearest | guided:16 − beam:50 | guided:50 − beam:1000 | milliseconds a plan, in the order of the columns | a "
      "first visit of the explorer, ms "
      "|\n|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n",
      stdout);
  for (const Case& one : cases) print_case(one, explorer);
  return 0;
}

}  // namespace
}  // namespace graphdrl

int main(int argc, char** argv) {
  using namespace graphdrl;
  SharedExplorer explorer = builtin_explorer();
  bool quick = false;
  for (int i = 1; i < argc; ++i) {
    const std::string_view argument = argv[i];
    if (argument == "--quick") {
      quick = true;
    } else if (argument == "--policy" && i + 1 < argc) {
      explorer = read_explorer_file(argv[++i]);
    } else {
      std::fputs("usage: explorer_table [--policy FILE] [--quick]\n", stderr);
      return 2;
    }
  }
  return print_table(explorer, quick);
}
