#include <fmt/format.h>

#include <memory>

#include "graphdrl/base/error.h"
#include "graphdrl/cli/commands.h"
#include "graphdrl/cli/program.h"
#include "graphdrl/env/budget.h"
#include "graphdrl/env/load_worlds.h"
#include "graphdrl/planners/bound.h"
#include "graphdrl/report/plan_files.h"

namespace graphdrl {
namespace {

constexpr double kSumRounding = 1e-9;  // of sums of prizes

struct CheckOptions {
  std::string map;
  std::string walk;
  std::string budget;
  std::string end;
  MapOptions reading;
  std::vector<std::string> out;
  bool json = false;
};

// Throws Error where a step of the walk follows no edge.
void check_steps(const World& world, const std::vector<NodeId>& walk, const std::string& file) {
  const auto name = [&](NodeId node) {
    return world.labels().empty() ? fmt::format("node {}", node) : in_quotes(world.labels()[node]);
  };
  for (std::size_t i = 1; i < walk.size(); ++i) {
    const bool stays = walk[i] == walk[i - 1] && world.is_grid();  // a blocked move
    if (stays || world.open().index_of(walk[i - 1], walk[i]) >= 0) continue;
    throw Error(
        {.what = fmt::format("not a walk: no edge leads from {} to {}, step {}", name(walk[i - 1]), name(walk[i]), i),
         .where = file});
  }
}

PlanReport check(const World& world, const CheckOptions& options) {
  const std::vector<NodeId> walk = read_walk(world, options.walk);
  check_steps(world, walk, options.walk);
  Task task{.view = world, .start = walk.front(), .budget = 0, .end = kNoNode};
  const double cost = plan_of_walk(task, walk).cost;
  const GivenTask& given = world.given();
  task.budget = !options.budget.empty() ? Budget::parse(options.budget).cost_in(world) : given.budget.value_or(cost);
  task.end = options.end.empty() ? given.end : parse_end(world, options.end).of(task.start);
  if (cost > task.limit()) {
    throw Error({.what = "the walk costs more than the budget",
                 .expected = fmt::format("at most {:g}", task.budget),
                 .got = fmt::format("{:g}", cost),
                 .where = options.walk});
  }
  if (!task.ends_anywhere() && walk.back() != task.end) {
    throw Error({.what = "the walk ends elsewhere",
                 .expected = fmt::format("node {}", task.end),
                 .got = fmt::format("node {}", walk.back()),
                 .where = options.walk});
  }
  PlanReport report{.world = world, .task = task, .policy = options.walk, .plan = plan_of_walk(task, walk)};
  report.plan.bound = max_prize(task);
  report.plan.optimal = report.plan.prize >= report.plan.bound * (1 - kSumRounding);
  if (report.plan.optimal) report.plan.bound = report.plan.prize;
  if (!world.has_prizes()) report.max_visited = static_cast<int>(report.plan.bound);
  return report;
}

void run_check(const CheckOptions& options) {
  const World world = load_one_world(options.map, options.reading);
  for (const std::string& file : options.out) check_plan_file(world, file);
  const PlanReport report = check(world, options);
  for (const std::string& file : options.out) write_plan(report, file);
  if (options.json) {
    print_json(plan_json(report));
    return;
  }
  std::string text = fmt::format("{}: a walk of {} steps on {}\n", escaped(options.walk), report.plan.walk.size() - 1,
                                 escaped(world.name()));
  for (const std::string& line : plan_summary(report)) text += line + '\n';
  print_text(text);
}

}  // namespace

void add_check_command(CLI::App& app) {
  CLI::App* const command =
      app.add_subcommand("check", "Check a walk of any origin: what it visits, what it costs, how far from the bound");
  const auto options = std::make_shared<CheckOptions>();
  command->add_option("map", options->map, "paper:a to paper:j, or a file")->required()->type_name("MAP");
  command
      ->add_option(
          "walk", options->walk,
          "The file: a node a line (CSV with a column node, id or label, or the first field), or JSON as `plan` "
          "writes it")
      ->required()
      ->type_name("WALK");
  command
      ->add_option(
          "--budget", options->budget,
          "What it may cost, or a multiple of the valid nodes, as 1.1x. The default is the file's, else what it "
          "costs")
      ->check(not_empty())
      ->type_name("B");
  command
      ->add_option("--end", options->end,
                   "Where it must end: anywhere, start, or a node. The default is the map's, else anywhere")
      ->check(not_empty())
      ->type_name("E");
  command
      ->add_option(
          "--out", options->out,
          "Also write it to this file, in the format of its ending: " + plan_file_endings() + "; may be given again")
      ->check(not_empty())
      ->type_name("FILE");
  command->add_flag("--json", options->json, "Print one JSON document, as `plan` does");
  add_map_options(*command, options->reading);
  command->callback([options] { run_check(*options); });
}

}  // namespace graphdrl
