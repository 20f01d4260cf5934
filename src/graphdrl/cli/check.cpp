#include <fmt/format.h>
#include <fmt/ranges.h>

#include <functional>
#include <memory>

#include "graphdrl/base/error.h"
#include "graphdrl/cli/commands.h"
#include "graphdrl/cli/program.h"
#include "graphdrl/env/load_worlds.h"
#include "graphdrl/report/plan_files.h"

namespace graphdrl {
namespace {

struct CheckOptions {
  std::string map;
  std::string walk;
  AskedText asked;
  CoverText cover = {.cover = ""};  // what the plan says
  MapOptions reading;
  std::vector<std::string> out;
  bool json = false;
};

void check(const CheckOptions& options) {
  for (const std::string& file : options.out) check_plan_file(file);
  const World world = load_one_world(options.map, options.reading);
  for (const std::string& file : options.out) check_plan_file(world, file);
  // Options first, then what the map says, then what the walk's file says.
  Asked asked = asked_of(world, options.asked);
  const GivenTask& given = world.given();
  if (!asked.budget && given.budget) asked.budget = Budget(*given.budget);
  if (!asked.end && given.end != kNoNode) asked.end = End::at(given.end);
  std::optional<Cover> cover;
  if (!options.cover.cover.empty()) cover = parse_cover(options.cover.cover);
  Answer answer =
      read_plan(world, options.walk, {.task = asked, .cover = cover, .reset_cost = options.cover.reset_cost});
  check_walk(answer, options.walk);
  judge(answer);
  std::vector<std::function<void()>> outputs;
  for (const std::string& file : options.out) outputs.emplace_back([&] { write_plan(answer, file); });
  outputs.emplace_back([&] {
    if (options.json) return print_json(plan_json(answer));
    print_text(fmt::format("{}: a walk of {} steps on {}\n{}\n", escaped(options.walk),
                           answer.edges ? answer.edges->walk.edges.size() : answer.plan.walk.size() - 1,
                           escaped(world.name()), fmt::join(plan_summary(answer), "\n")));
  });
  attempt_all(outputs);
}

}  // namespace

void add_check_command(CLI::App& app) {
  CLI::App& command =
      *app.add_subcommand("check", "Check a walk of any origin: what it visits, what it costs, how far from the bound");
  const auto options = std::make_shared<CheckOptions>();
  command.add_option("map", options->map, "paper:a to paper:j, or a file")->required()->type_name("MAP");
  command
      .add_option("walk", options->walk,
                  "The file: a node a line (CSV with a column node, id or label, or the first field), all nodes on one "
                  "line, or JSON as `plan` writes it")
      ->required()
      ->type_name("WALK");
  add_text_option(command, "--budget", options->asked.budget, "B",
                  "What it may cost, or a multiple of the valid nodes, as 1.1x. The default is the map's, else the "
                  "plan's, else what it costs");
  add_text_option(command, "--end", options->asked.end, "E",
                  "Where it must end: anywhere, start, or a node. The default is the map's, else the plan's, else "
                  "anywhere");
  add_cover_options(command, options->cover);
  add_text_option(
      command, "--out", options->out, "FILE",
      "Also write it to this file, in the format of its ending: " + plan_file_endings() + "; may be given again");
  command.add_flag("--json", options->json, "Print one JSON document, as `plan` does");
  add_map_options(command, options->reading);
  command.callback([options] { check(*options); });
}

}  // namespace graphdrl
