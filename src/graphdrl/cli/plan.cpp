#include <fmt/format.h>
#include <fmt/ranges.h>

#include <chrono>
#include <memory>

#include "graphdrl/base/error.h"
#include "graphdrl/cli/commands.h"
#include "graphdrl/cli/program.h"
#include "graphdrl/env/budget.h"
#include "graphdrl/env/load_worlds.h"
#include "graphdrl/env/walk.h"
#include "graphdrl/eval/rollout.h"
#include "graphdrl/graph/search.h"
#include "graphdrl/planners/bound.h"
#include "graphdrl/planners/registry.h"
#include "graphdrl/report/map_drawing.h"

namespace graphdrl {
namespace {

constexpr std::int64_t kMaxPlanSteps = 10'000'000;  // a plan is printed step by step

struct PlanOptions {
  std::string map;
  std::string budget;
  std::string start;
  std::string policy = "explorer";
  std::optional<double> time_limit_s;
  std::uint64_t seed = 1;
  bool json = false;
};

struct PlannedWalk {
  std::vector<NodeId> walk;  // up to its last first visit
  int visited;
  double cost;
  int most;  // visited nodes of any walk, at most
  bool optimal;
  int unreachable;  // valid nodes that no walk can reach
  double elapsed_s;
};

// Drops what comes after the last first visit: nothing is left that the policy could have had.
void cut_after_last_visit(const World& world, std::vector<NodeId>& walk) {
  std::vector<bool> seen(world.graph().node_count());
  std::size_t length = 0;
  for (std::size_t i = 0; i < walk.size(); ++i) {
    if (seen[walk[i]]) continue;
    seen[walk[i]] = true;
    length = i + 1;
  }
  walk.resize(length);
}

PlannedWalk make_plan(const World& world, NodeId start, double budget, const PlanOptions& options) {
  const auto begin = std::chrono::steady_clock::now();
  TimeLimit limit;
  if (options.time_limit_s) limit = std::chrono::duration<double>(*options.time_limit_s);
  const auto policy = make_policy(options.policy, options.seed, limit);
  const SearchStart from = search_start(world, start, budget);
  const EpisodeOptions episode{.budget = budget, .action_space = action_space_of(world)};
  PlannedWalk result{};
  result.most = max_visited(from);
  if (auto* const planner = dynamic_cast<PlanPolicy*>(policy.get())) {
    Plan plan = planner->plan(from);
    result.walk = std::move(plan.walk);
    result.optimal = plan.optimal;
  } else {
    result.walk = roll_out(world, std::span(&start, 1), episode, *policy).front().walk;
    cut_after_last_visit(world, result.walk);
  }
  // Nothing is believed that cannot be walked.
  Episode check(world, episode);
  follow_walk(check, result.walk);
  result.visited = check.visited_count();
  result.cost = check.spent();
  result.optimal = result.optimal || result.visited >= result.most;
  if (result.optimal) result.most = result.visited;

  int reached = 1;
  NearestFirst(world.open()).run(start, std::numeric_limits<double>::infinity(), [&](NodeId, double) {
    ++reached;
    return NearestFirst::Next::kThrough;
  });
  result.unreachable = world.valid_count() - reached;
  result.elapsed_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return result;
}

std::string name_of(const World& world, NodeId node) {
  if (!world.labels().empty()) return fmt::format("{} (node {})", escaped(world.labels()[node]), node);
  if (!world.is_grid()) return fmt::format("node {}", node);
  const Cell cell = world.map()->cell(node);
  return fmt::format("node {} (row {}, column {})", node, cell.row, cell.col);
}

Json to_json(const World& world, const PlanOptions& options, double budget, const PlannedWalk& plan) {
  const double percent = 100.0 / world.valid_count();
  Json json;
  json["map"] = world.name();
  json["policy"] = policy_label(options.policy);
  json["start"] = plan.walk.front();
  json["budget"] = budget;
  json["walk"] = plan.walk;
  if (world.is_grid()) {
    json["walk_cells"] = Json::array();
    for (const NodeId node : plan.walk) {
      const Cell cell = world.map()->cell(node);
      json["walk_cells"].push_back({cell.row, cell.col});
    }
  }
  if (!world.labels().empty()) {
    json["walk_labels"] = Json::array();
    for (const NodeId node : plan.walk) json["walk_labels"].push_back(world.labels()[node]);
  }
  json["visited"] = plan.visited;
  json["coverage"] = percent * plan.visited;
  json["cost"] = plan.cost;
  json["upper_bound"] = percent * plan.most;
  json["gap"] = percent * (plan.most - plan.visited);
  json["optimal"] = plan.optimal;
  json["unreachable"] = plan.unreachable;
  json["elapsed_s"] = plan.elapsed_s;
  return json;
}

std::string format_plan(const World& world, const PlanOptions& options, double budget, const PlannedWalk& plan) {
  const double percent = 100.0 / world.valid_count();
  std::string text = fmt::format("{}, {} from {}, budget {:g}\n", world.name(), policy_label(options.policy),
                                 name_of(world, plan.walk.front()), budget);
  text += fmt::format("visited  {} of {} nodes, {:.1f} %, for {:g}\n", plan.visited, world.valid_count(),
                      percent * plan.visited, plan.cost);
  text += plan.optimal ? "optimal  no walk visits more\n"
                       : fmt::format("bound    no walk visits more than {} nodes, {:.1f} %: the gap is {:.1f} points\n",
                                     plan.most, percent * plan.most, percent * (plan.most - plan.visited));
  if (plan.unreachable > 0) {
    text += fmt::format("         {} node{} cannot be reached from there\n", plan.unreachable,
                        plan.unreachable == 1 ? "" : "s");
  }
  std::vector<std::string> names;
  for (const NodeId node : plan.walk) {
    names.push_back(world.labels().empty() ? std::to_string(node) : escaped(world.labels()[node]));
  }
  text += fmt::format("walk     {}\n", fmt::join(names, " "));
  if (world.is_grid()) text += "\n" + draw_map_text(world, plan.walk);
  return text;
}

void plan(const PlanOptions& options) {
  const World world = load_one_world(options.map);
  const NodeId start = options.start.empty() ? world.valid_nodes().front() : parse_start(world, options.start);
  const double budget = Budget::parse(options.budget).cost_in(world);
  if (budget > kMaxPlanSteps * world.open().mean_cost()) {
    throw Error({.what = "the budget is too large to plan for",
                 .expected = fmt::format("at most {:g}", kMaxPlanSteps * world.open().mean_cost()),
                 .got = options.budget});
  }
  if (options.time_limit_s && !(*options.time_limit_s >= 0 && *options.time_limit_s <= 1e6)) {
    throw Error({.what = "bad time limit",
                 .expected = "0 to 1000000 seconds",
                 .got = fmt::format("{}", *options.time_limit_s),
                 .where = "--time-limit"});
  }
  const PlannedWalk result = make_plan(world, start, budget, options);
  if (options.json) {
    print_json(to_json(world, options, budget, result));
  } else {
    print_text(format_plan(world, options, budget, result));
  }
}

}  // namespace

void add_plan_command(CLI::App& app) {
  CLI::App* const command =
      app.add_subcommand("plan", "Plan one walk, and say how far from the optimum it may be at most");
  const auto options = std::make_shared<PlanOptions>();
  command->add_option("map", options->map, "paper:a to paper:j, or a file: an ASCII map, or a graph as node-link JSON")
      ->required()
      ->type_name("MAP");
  command->add_option("--budget", options->budget, "What the walk may cost, or a multiple of the valid nodes, as 1.1x")
      ->required()
      ->type_name("B");
  command->add_option("--start", options->start, "A node id, a label, or row,col; the default is the first valid node")
      ->check(not_empty())
      ->type_name("S");
  CLI::Option* const policy =
      command->add_option("--policy", options->policy, policy_names() + "; guided with a time limit")
          ->type_name("P")
          ->capture_default_str();
  command
      ->add_option("--time-limit", options->time_limit_s,
                   "Seconds for a better plan: wider and wider beams, or an exact search with a beam to fall back on")
      ->type_name("S");
  command->add_option("--seed", options->seed, "For random policies")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command->add_flag("--json", options->json, "Print one JSON document");
  add_threads_option(*command);
  command->callback([options, policy] {
    if (options->time_limit_s && policy->count() == 0) options->policy = "guided";
    plan(*options);
  });
}

}  // namespace graphdrl
