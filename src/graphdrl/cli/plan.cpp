#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <functional>
#include <memory>

#include "graphdrl/base/error.h"
#include "graphdrl/cli/commands.h"
#include "graphdrl/cli/live.h"
#include "graphdrl/cli/machine.h"
#include "graphdrl/cli/plan_folder.h"
#include "graphdrl/cli/program.h"
#include "graphdrl/cli/stop_signals.h"
#include "graphdrl/env/load_worlds.h"
#include "graphdrl/io/text.h"
#include "graphdrl/live/edge_exploration.h"
#include "graphdrl/planners/registry.h"
#include "graphdrl/report/plan_files.h"
#include "graphdrl/report/progress.h"
#include "graphdrl/report/terminal_picture.h"

namespace graphdrl {
namespace {

constexpr double kProgressAfterS = 1;

// What `plan` and `explore` share, and what `explore` has beside it.
struct PlanOptions {
  std::string map;
  MapOptions reading;
  AskedText asked;
  PlanRequest request;
  std::optional<double> time_limit_s;
  std::string reveal = "all";
  std::string score = "visited";
  std::string until;
  CoverText cover;
  std::string believed;
  std::optional<double> think_time_s;
  std::vector<std::string> out;
  bool walk = false;
  ShareText share;
  bool json = false;
  LiveArguments live;
};

std::string name_of(const World& world, NodeId node) {
  if (!world.labels().empty()) return fmt::format("{} (node {})", escaped(world.labels()[node]), node);
  if (!world.has_cells()) return fmt::format("node {}", node);
  const Cell cell = world.map()->cell(node);
  return fmt::format("node {} (row {}, column {})", node, cell.row, cell.col);
}

std::string as_comments(std::string_view text) {
  std::string commented;
  for (Lines lines(text); lines.next();) commented += fmt::format("# {}\n", lines.line());
  return commented;
}

std::string format_plan(const Answer& answer, const PlanOptions& options) {
  const World& world = answer.world;
  const std::vector<NodeId>& walk = answer.edges ? answer.edges->walk.nodes : answer.plan.walk;  // with loops
  std::string text = fmt::format("{}, {} from {}", world.name(), answer.policy, name_of(world, walk.front()));
  if (!answer.task.ends_anywhere()) text += fmt::format(" to {}", name_of(world, answer.task.end()));
  for (const std::string& line : plan_summary(answer)) text += '\n' + line;
  text += '\n';
  const std::string length = fmt::format("walk of {} steps", walk.size() - 1);
  if (options.walk) return as_comments(text + length + '\n') + format_walk(world, walk);
  Screen screen = screen_of(stdout);
  if (!world.has_cells() && std::ssize(walk) <= screen.columns) {
    std::vector<std::string> names(walk.size());
    std::ranges::transform(walk, names.begin(), [&](NodeId node) { return escaped(node_name(world, node)); });
    const std::string line = fmt::format("{}: {}", length, fmt::join(names, ", "));
    if (std::ssize(line) <= screen.columns) return text + line + '\n';
  }
  text += fmt::format("{} to {}; --walk prints them\n", length, name_of(world, walk.back()));
  if (!world.has_cells()) return text;
  // The picture and the text above it fit the screen, with a line for the prompt.
  screen.lines -= static_cast<int>(std::count(text.begin(), text.end(), '\n')) + 2;
  text += '\n' + draw_walk(world, walk, screen, Fog(answer));
  return text;
}

// A world of the options' kind, and what is asked of it.
struct Question {
  World world;
  Task task;
  PlanRequest request;
};

Question question_of(const PlanOptions& options, const std::string& map) {
  World world = load_one_world(map, options.reading);
  Asked asked = asked_of(world, options.asked);
  const bool until_covered = !options.until.empty();
  const bool edges = parse_cover(options.cover.cover) == Cover::kEdges;
  if (edges && asked.budget && !asked.budget->cost()) {
    throw Error({.what = "a multiple is of nodes, and edges count here",
                 .expected = "a budget in units of cost, or none",
                 .got = in_quotes(options.asked.budget),
                 .where = "--budget"});
  }
  if (until_covered || (edges && !asked.budget && !world.given().budget)) asked.budget = Budget(kNoLimit);
  Task task(world, asked);
  PlanRequest request = options.request;
  request.reveal = Reveal::parse(options.reveal);
  request.score = parse_score(options.score);
  request.until_covered = until_covered;
  if (edges) request.cover = Cover::kEdges;
  request.reset_cost = options.cover.reset_cost;
  if (!options.believed.empty()) {
    request.believed = believe(load_one_world(options.believed, options.reading), world);
  }
  if (options.think_time_s) request.think_s = *options.think_time_s;
  return {std::move(world), std::move(task), std::move(request)};
}

void plan_one(const PlanOptions& options) {
  for (const std::string& file : options.out) check_plan_file(file);
  const auto [world, task, request] = question_of(options, options.map);
  for (const std::string& file : options.out) check_plan_file(world, file);
  catch_stop_signals();  // the best walk so far is printed
  ProgressDisplay display("visited", /*first=*/0, kProgressAfterS);
  const Stopwatch watch;
  const int valid = world.valid_count();
  const ProgressListener listener = [&](const Progress& progress) {
    const std::string bound = progress.bound <= valid ? fmt::format(", bound {:.0f}", progress.bound) : "";
    display.show_line(fmt::format("{} of {} nodes{}  {:.0f} s", progress.visited, valid, bound, watch.seconds()),
                      static_cast<double>(progress.visited) / valid);
  };
  const Clock clock(options.time_limit_s, &stop_flag(), &listener);
  const Answer answer = answer_task(world, task, request, clock);
  display.finish();
  std::vector<std::function<void()>> outputs;
  for (const std::string& file : options.out) outputs.emplace_back([&] { write_plan(answer, file); });
  outputs.emplace_back([&] {
    if (options.json) return print_json(plan_json(answer));
    print_text(format_plan(answer, options));
  });
  attempt_all(outputs);
  if (stop_signal() != 0) throw CLI::RuntimeError(128 + stop_signal());
}

void plan(const PlanOptions& options, const CLI::App& command, Ranks& ranks) {
  const bool many = options.out.size() == 1 && asks_for_folder(options.map, options.out.front());
  ranks.require_same("maps", many ? "a folder" : "one");
  if (!many) {
    if (!options.share.share().all()) {
      throw Error({.what = "one plan has no shares", .expected = "a folder of maps and --out FOLDER"});
    }
    return ranks.on_first([&] { plan_one(options); });
  }
  std::vector<std::string> files = {options.request.policy};
  if (!options.believed.empty()) files.push_back(options.believed);
  const FolderOfPlans plans{.maps = options.map,
                            .folder = options.out.front(),
                            .files = files,
                            .workers = {.ranks = ranks, .share = options.share.share()},
                            .json = options.json};
  plan_folder(plans, command, [&](const std::string& map) {
    const auto [world, task, request] = question_of(options, map);
    return answer_task(world, task, request, Clock(options.time_limit_s, &stop_flag()));
  });
}

// Those of both commands.
void add_shared_options(CLI::App& command, PlanOptions& options) {
  command
      .add_option("map", options.map,
                  "paper:a to paper:j, or a file in any format of `graphdrl maps convert --help`; a folder of them, or "
                  "paper, with --out FOLDER")
      ->required()
      ->type_name("MAP");
  add_text_option(command, "--budget", options.asked.budget, "B",
                  "What the walk may cost, or a multiple of the valid nodes, as 1.1x. The default is the file's");
  add_text_option(
      command, "--start", options.asked.start, "S",
      "A node id, or row,col on a grid; in a graph with labels a label, or #N for node id N. The default is "
      "the file's, else the first valid node");
  add_text_option(command, "--end", options.asked.end, "E",
                  "Where the walk must end: anywhere, start, or a node as for --start. The default is the file's, else "
                  "anywhere");
}

void add_shared_outputs(CLI::App& command, PlanOptions& options) {
  add_text_option(
      command, "--out", options.out, "FILE",
      "Also write the plan to this file, in the format of its ending: " + plan_file_endings() +
          "; may be given again. Of a folder of maps: a folder, for a plan of each, NAME.json, and a table of all, "
          "summary.csv; the same command again plans what is missing");
  CLI::Option* const json = command.add_flag("--json", options.json, "Print one JSON document");
  add_share_options(command, options.share);
  command.add_flag("--walk", options.walk, "Print the walk instead of a picture, a node a line, as `check` reads it")
      ->excludes(json);
  add_map_options(command, options.reading);
  add_threads_option(command);
  add_memory_limit_option(command);
}

// `explore --live`, which has no map.
void explore_live_with(const PlanOptions& options, const CLI::App& command) {
  constexpr std::array kShared = {"--cover",  "--reset-cost", "--budget",       "--end",
                                  "--policy", "--score",      "--connectivity", "--seed",
                                  "--out",    "--think-time", "--threads",      "--memory-limit"};
  for (const CLI::Option* const option : command.get_options()) {
    const bool goes_with = option->get_group() == kWithLive || option->get_name() == "--live" ||
                           std::ranges::find(kShared, option->get_name()) != kShared.end();
    if (option->count() > 0 && !goes_with) throw CLI::ExcludesError("--live", option->get_name());
  }
  const auto given = [&](const char* option) { return command.get_option(option)->count() > 0; };
  explore_live(options.live, {.cover = options.cover,
                              .budget = options.asked.budget,
                              .end = options.asked.end,
                              .score = given("--score") ? options.score : "",
                              .connectivity = given("--connectivity") && !options.reading.diagonals ? 4 : 8,
                              .policy = options.request.policy,
                              .think_s = options.think_time_s,
                              .seed = options.request.seed,
                              .out = options.out});
}

}  // namespace

void add_plan_command(CLI::App& app, Ranks& ranks) {
  CLI::App& command = *app.add_subcommand("plan", "Plan one walk, and say how far from the optimum it may be at most");
  const auto options = std::make_shared<PlanOptions>();
  add_shared_options(command, *options);
  options->request.policy = kPlanPolicy;
  command.add_option("--policy", options->request.policy, policy_names())->type_name("P")->capture_default_str();
  add_cover_options(command, options->cover);
  command
      .add_option("--iterations", options->request.iterations,
                  "Of search: how many steps to take in all; the default depends on the size of the world")
      ->type_name("N");
  command
      .add_option("--time-limit", options->time_limit_s,
                  "Seconds for a plan, the bound included: search goes on until then, beams search wider and wider, "
                  "others stop with what they have")
      ->type_name("S");
  add_seed_option(command, options->request.seed, "For search and for random policies");
  add_shared_outputs(command, *options);
  command.callback([options, &command, &ranks] { plan(*options, command, ranks); });
}

void add_explore_command(CLI::App& app) {
  CLI::App& command = *app.add_subcommand(
      "explore", "Explore a map that is not known beforehand, and say what knowing it would have brought");
  const auto options = std::make_shared<PlanOptions>();
  options->reveal = "edges";
  add_shared_options(command, *options);
  add_text_option(
      command, "--policy", options->request.policy, "P",
      fmt::format("{}. The default is {} with --believed, {} with --score seen on cells within a radius or in sight, "
                  "else {}",
                  policy_names(), kBelievingPolicy, kSeeingPolicy, kOnlinePolicy));
  add_text_option(
      command, "--reveal", options->reveal, "R",
      "What a visit shows: edges, those of the node; radius:R, all within that cost; sight:R on grids, what "
      "straight lines of that length meet; all, the whole map")
      ->capture_default_str();
  command.add_option("--score", options->score, "What counts: nodes visited, or nodes seen")
      ->check(CLI::IsMember({"visited", "seen"}))
      ->capture_default_str();
  add_cover_options(command, options->cover);
  add_text_option(command, "--believed", options->believed, "OLD",
                  "An old map, of which some may have changed: cells are the same by place, other nodes by name");
  CLI::Option* const until =
      command
          .add_option("--until", options->until, "Instead of a budget: covered, until nothing is left that is known")
          ->check(CLI::IsMember({"covered"}));
  until->excludes(command.get_option("--budget"));
  command
      .add_option("--price", options->request.price_s,
                  "The price of ignorance, too: seconds that search has for a walk that knows the map")
      ->check(CLI::PositiveNumber)
      ->type_name("S");
  command.add_option("--think-time", options->think_time_s, "Seconds for each choice, of policies that plan")
      ->check(CLI::PositiveNumber)
      ->type_name("S");
  command.add_option("--time-limit", options->time_limit_s, "Seconds in all; then straight to where the walk must end")
      ->type_name("S");
  command.get_option("--price")->excludes(command.get_option("--time-limit"));
  add_seed_option(command, options->request.seed,
                  "For search, for random policies, and for the numbers by which unknown nodes are known");
  add_shared_outputs(command, *options);
  add_live_options(command, options->live);
  command.get_option("map")->required(false);
  command.callback([options, &command] {
    if (options->live.live) return explore_live_with(*options, command);
    if (options->map.empty()) throw CLI::RequiredError("map");
    plan(*options, command, one_rank());
  });
}

}  // namespace graphdrl
