// The table of docs/explorer.md: the explorer and the planners on worlds of the test split, or, to choose among
// variants, of the validation split.
//   explorer_table [--policy FILE] [--validation] [--quick] [--alone] [--only TEXT] [--threads N]
// --quick: few worlds; --alone: the explorer and nearest only; --only: worlds whose name holds the text; --threads: for
// each plan, 1 unless told.
// Every walk is walked through an Episode before it counts. Intervals are 95 % of the mean over worlds, a world's
// figure being the mean over its starts.
#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>
#include <memory>
#include <string_view>

#include "graphdrl/base/parallel.h"
#include "graphdrl/env/episode.h"
#include "graphdrl/env/load_worlds.h"
#include "graphdrl/env/world_families.h"
#include "graphdrl/eval/statistics.h"
#include "graphdrl/planners/baselines.h"
#include "graphdrl/planners/beam.h"
#include "graphdrl/planners/bound.h"
#include "graphdrl/planners/exact.h"
#include "graphdrl/planners/registry.h"

namespace graphdrl {
namespace {

constexpr int kAllStarts = 0;

struct Case {
  std::string name;
  double budget;  // times the valid nodes and the mean cost, or steps where above 10
  int worlds;
  int starts;   // per world
  bool wide;    // with the wide beams
  bool solved;  // with the optimum instead of the bound
  std::function<World(int)> world;
};

Split split_shown = Split::kTest;
bool alone_only = false;
std::string_view only;

Case of_split(const WorldSpec& spec, double budget, int worlds, int starts, bool wide = false, bool solved = false) {
  return {spec.name(),
          budget,
          worlds,
          starts,
          wide,
          solved,
          [spec](int index) { return split_world(spec, split_shown, index); }};
}

// One policy's walks over all worlds of a case.
struct Column {
  std::string name;
  std::function<Plan(const Task&)> plan;
  bool wide = false;
  std::vector<double> coverage{};  // by world, percent
  std::vector<double> times_ms{};  // by walk
  double visits = 0;
};

std::string with_interval(const std::vector<double>& values) {
  const Summary summary = summarise(values);
  if (!summary.ci95) return fmt::format("{:.1f}", summary.mean);
  return fmt::format("{:.1f} ± {:.1f}", summary.mean, summary.mean - summary.ci95->low);
}

std::string difference(const Column& a, const Column& b) {
  if (a.coverage.empty() || b.coverage.empty()) return "";
  std::vector<double> values;
  for (std::size_t i = 0; i < a.coverage.size(); ++i) values.push_back(a.coverage[i] - b.coverage[i]);
  return with_interval(values);
}

bool is_shown(const Case& one, const Column& column) {
  if (alone_only) return column.name == "nearest" || column.name == "explorer";
  return one.wide || !column.wide;
}

enum { kNearest, kBeam16, kBeam50, kBeam1000, kExplorer, kGuided16, kGuided50 };

std::vector<Column> make_columns(const SharedExplorer& explorer) {
  const auto beam = [](int width) { return [width](const Task& task) { return beam_plan(task, {.width = width}); }; };
  const auto scorer = std::make_shared<ExplorerScorer>(explorer);
  const auto guided = [scorer](int width) {
    return [scorer, width](const Task& task) { return BeamPlanner({.width = width}, scorer).plan(task); };
  };
  const auto alone = [scorer](const Task& task) { return ExplorerPlanner(scorer).plan(task); };
  const auto nearest = [](const Task& task) { return NearestPlanner().plan(task); };
  return {{"nearest", nearest}, {"beam:16", beam(16)},     {"beam:50", beam(50)},    {"beam:1000", beam(1000), true},
          {"explorer", alone},  {"guided:16", guided(16)}, {"guided:50", guided(50)}};
}

void print_case(const Case& one, const SharedExplorer& explorer) {
  std::vector<Column> columns = make_columns(explorer);
  std::vector<double> bounds;
  double nodes = 0;
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
    for (Column& column : columns) {
      if (is_shown(one, column)) column.coverage.push_back(0);
    }
    bounds.push_back(0);
    for (const NodeId start : starts) {
      const Task task(world, start, budget);
      const std::optional<double> best = one.solved ? exact_prize(task) : std::nullopt;
      bounds.back() += share * (best ? *best : max_prize(task));
      for (Column& column : columns) {
        if (!is_shown(one, column)) continue;
        const auto begin = std::chrono::steady_clock::now();
        const Plan plan = column.plan(task);
        const std::chrono::duration<double, std::milli> time = std::chrono::steady_clock::now() - begin;
        column.times_ms.push_back(time.count());
        Episode check(world, task, {.action_space = action_space_of(world)});
        follow_walk(check, plan.walk);
        column.coverage.back() += share * check.visited_count();
        column.visits += check.visited_count() - 1;
      }
    }
  }
  std::string line = fmt::format("| {} | {:.0f} | {:g}{} |", one.name, nodes, one.budget, one.budget > 10 ? "" : "x");
  for (const Column& column : columns) {
    line += fmt::format(" {} |", column.coverage.empty() ? "" : with_interval(column.coverage));
  }
  line +=
      fmt::format(" {:.1f}{} | {} | {} | {} | {} |", summarise(bounds).mean, one.solved ? " (optimum)" : "",
                  difference(columns[kExplorer], columns[kNearest]), difference(columns[kGuided16], columns[kBeam16]),
                  difference(columns[kGuided50], columns[kBeam50]), difference(columns[kGuided50], columns[kBeam1000]));
  for (const int column : {kBeam50, kBeam1000, kExplorer, kGuided16, kGuided50}) {
    const std::vector<double>& times = columns[column].times_ms;
    line += times.empty() ? " |" : fmt::format(" {:.2g} |", median(times));
  }
  double total_ms = 0;
  for (const double time_ms : columns[kExplorer].times_ms) total_ms += time_ms;
  line += fmt::format(" {:.2f} |\n", total_ms / columns[kExplorer].visits);
  std::fputs(line.c_str(), stdout);
  std::fflush(stdout);
}

int print_table(const SharedExplorer& explorer, bool quick) {
  std::vector<Case> cases;
  const int many = quick ? 30 : 300;
  const int some = quick ? 10 : 100;
  const std::vector<World> paper = load_worlds({"paper"});
  cases.push_back({"paper:a–j", 25, 10, kAllStarts, true, true, [&](int index) { return paper[index]; }});
  cases.push_back(of_split({"obstacles", 5}, 1.1, many, kAllStarts, true, true));
  cases.push_back(of_split({"loop-maze", 11}, 1.0, some, 1, true));
  for (const double budget : {1.25, 1.5, 2.0}) cases.push_back(of_split({"loop-maze", 11}, budget, some, 1, true));
  for (const char* const family :
       {"maze", "braided-maze", "rooms", "obstacles", "open", "caves", "houses", "streets"}) {
    cases.push_back(of_split({family, 11}, 1.0, some, 1, true));
  }
  for (const double budget : {1.5, 2.0}) cases.push_back(of_split({"obstacles", 11}, budget, some, 1, true));
  for (const char* const family : {"tree", "erdos-renyi", "barabasi-albert", "watts-strogatz", "geometric"}) {
    for (const int nodes : {50, 200}) {
      for (const bool weighted : {false, true}) {
        for (const bool directed : {false, true}) {
          if (directed && family == std::string_view("tree")) continue;
          cases.push_back(of_split({family, nodes, weighted, directed}, 1.0, nodes == 50 ? 4 * some : 2 * some, 1));
        }
      }
    }
  }
  for (const WorldSpec& spec : {WorldSpec{"obstacles", 60},
                                {"loop-maze", 61},
                                {"rooms", 60},
                                {"open", 60},
                                {"caves", 60},
                                {"houses", 60},
                                {"streets", 60}}) {
    cases.push_back(of_split(spec, 1.0, quick ? 2 : 48, 1));
  }
  std::erase_if(cases, [](const Case& one) { return one.name.find(only) == std::string::npos; });
  if (cases.empty()) {
    std::fprintf(stderr, "explorer_table: no world's name holds '%s'\n", std::string(only).c_str());
    return 2;
  }
  std::string header = "| worlds | nodes | budget |";
  for (const Column& column : make_columns(explorer)) header += fmt::format(" {} |", column.name);
  header +=
      " bound | explorer − nearest | guided:16 − beam:16 | guided:50 − beam:50 | guided:50 − beam:1000 | ms: beam:50 | "
      "beam:1000 | explorer | guided:16 | guided:50 | a first visit of the explorer |\n|---|";
  for (int i = 0; i < 20; ++i) header += "---|";
  std::fputs((header + '\n').c_str(), stdout);
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
    } else if (argument == "--alone") {
      alone_only = true;
    } else if (argument == "--validation") {
      split_shown = Split::kValidation;
    } else if (argument == "--only" && i + 1 < argc) {
      only = argv[++i];
    } else if (argument == "--threads" && i + 1 < argc && std::atoi(argv[i + 1]) > 0) {
      set_threads(std::atoi(argv[++i]));
    } else if (argument == "--policy" && i + 1 < argc) {
      explorer = std::get<SharedExplorer>(read_policy(argv[++i]));
    } else {
      std::fputs(
          "usage: explorer_table [--policy FILE] [--validation] [--quick] [--alone] [--only TEXT] [--threads N]\n",
          stderr);
      return 2;
    }
  }
  return print_table(explorer, quick);
}
