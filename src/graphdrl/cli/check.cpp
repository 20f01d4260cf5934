#include <fmt/format.h>

#include <memory>

#include "graphdrl/base/error.h"
#include "graphdrl/cli/commands.h"
#include "graphdrl/cli/program.h"
#include "graphdrl/env/load_worlds.h"
#include "graphdrl/planners/bound.h"
#include "graphdrl/report/plan_files.h"

namespace graphdrl {
namespace {

struct CheckOptions {
  std::string map;
  std::string walk;
  std::string budget;
  std::string end;
  MapOptions reading;
  std::vector<std::string> out;
  bool json = false;
};

Answer check(const World& world, const CheckOptions& options) {
  // Options first, then what the map says, then what the walk's file says.
  Asked asked = asked_of(world, {.budget = options.budget, .end = options.end});
  const GivenTask& given = world.given();
  if (!asked.budget && given.budget) asked.budget = Budget(*given.budget);
  if (!asked.end && given.end != kNoNode) asked.end = End::at(given.end);
  Answer report = read_plan(world, options.walk, asked);
  check_walk(report, options.walk);
  report.plan.bound = kNoLimit;
  report.plan.optimal = false;
  report.plan.settle(max_prize(report.task));
  return report;
}

void run_check(const CheckOptions& options) {
  const World world = load_one_world(options.map, options.reading);
  for (const std::string& file : options.out) check_plan_file(world, file);
  const Answer report = check(world, options);
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
          "The file: a node a line (CSV with a column node, id or label, or the first field), all nodes on one line, "
          "or JSON as `plan` writes it")
      ->required()
      ->type_name("WALK");
  command
      ->add_option("--budget", options->budget,
                   "What it may cost, or a multiple of the valid nodes, as 1.1x. The default is the map's, else the "
                   "plan's, else what it costs")
      ->check(not_empty())
      ->type_name("B");
  command
      ->add_option(
          "--end", options->end,
          "Where it must end: anywhere, start, or a node. The default is the map's, else the plan's, else anywhere")
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
