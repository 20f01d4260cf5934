#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <memory>

#include "graphdrl/base/error.h"
#include "graphdrl/cli/commands.h"
#include "graphdrl/cli/program.h"
#include "graphdrl/env/budget.h"
#include "graphdrl/env/load_worlds.h"
#include "graphdrl/io/text.h"
#include "graphdrl/planners/registry.h"
#include "graphdrl/report/plan_files.h"
#include "graphdrl/report/progress.h"
#include "graphdrl/report/terminal_picture.h"

namespace graphdrl {
namespace {

constexpr double kProgressAfterS = 1;

struct PlanOptions {
  std::string map;
  MapOptions reading;
  std::string budget;
  std::string start;
  std::string end;
  PlanRequest request;
  std::optional<std::int64_t> iterations;
  std::vector<std::string> out;
  bool walk = false;
  bool json = false;
};

double seconds_since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

// A bar on standard error once a plan takes a while.
class PlanDisplay {
 public:
  explicit PlanDisplay(const World& world) : valid_count_(world.valid_count()), display_(stderr, "visited", 0) {}
  ~PlanDisplay() { display_.finish(); }

  void show(const PlanProgress& progress) {
    const double elapsed_s = seconds_since(begin_);
    if (elapsed_s < kProgressAfterS) return;
    const std::string bound = progress.bound <= valid_count_ ? fmt::format(", bound {:.0f}", progress.bound) : "";
    display_.show_line(fmt::format("{} of {} nodes{}  {:.0f} s", progress.visited, valid_count_, bound, elapsed_s),
                       static_cast<double>(progress.visited) / valid_count_);
  }

 private:
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
  int valid_count_;
  ProgressDisplay display_;
};

std::string name_of(const World& world, NodeId node) {
  if (!world.labels().empty()) return fmt::format("{} (node {})", escaped(world.labels()[node]), node);
  if (!world.has_cells()) return fmt::format("node {}", node);
  const Cell cell = world.map()->cell(node);
  return fmt::format("node {} (row {}, column {})", node, cell.row, cell.col);
}

std::string format_bound(const World& world, const PlanReport& answer) {
  const Plan& plan = answer.plan;
  const char* const what = world.has_prizes() ? "is worth more" : "visits more";
  if (plan.optimal) return fmt::format("optimal  no walk {}\n", what);
  const std::string most =
      world.has_prizes() ? fmt::format("{:g}", plan.bound) : fmt::format("{} nodes", answer.max_visited);
  return fmt::format("bound    no walk {} than {}, {:.1f} %: the gap is {:.1f} points\n", what, most,
                     world.percent_of_all(plan.bound), world.percent_of_all(plan.bound - plan.prize));
}

std::string as_comments(std::string_view text) {
  std::string commented;
  for (Lines lines(text); lines.next();) commented += fmt::format("# {}\n", lines.line());
  return commented;
}

std::string format_plan(const World& world, const Task& task, const PlanOptions& options, const PlanReport& answer) {
  const Plan& plan = answer.plan;
  std::string text = fmt::format("{}, {} from {}", world.name(), policy_label(options.request.policy),
                                 name_of(world, plan.walk.front()));
  if (!task.ends_anywhere()) text += fmt::format(" to {}", name_of(world, task.end));
  text += fmt::format(", budget {:g}\n", task.budget);
  text += fmt::format("visited  {} of {} nodes, {:.1f} %, for {:g}\n", plan.visited, world.valid_count(),
                      100.0 * plan.visited / world.valid_count(), plan.cost);
  if (world.has_prizes()) {
    text += fmt::format("prize    {:g} of {:g}, {:.1f} %\n", plan.prize, world.total_prize(),
                        world.percent_of_all(plan.prize));
  }
  text += format_bound(world, answer);
  if (answer.unreachable > 0) {
    text += fmt::format("         {} node{} cannot be reached from there\n", answer.unreachable,
                        answer.unreachable == 1 ? "" : "s");
  }
  text += fmt::format("walk     {} steps", plan.walk.size() - 1);
  if (options.walk) return as_comments(text + '\n') + format_walk(world, plan.walk);
  text += fmt::format(" to {}; --walk prints them\n", name_of(world, plan.walk.back()));
  if (!world.has_cells()) return text;
  // The picture and the text above it fit the screen, with a line for the prompt.
  Screen screen = screen_of(stdout);
  screen.lines -= static_cast<int>(std::count(text.begin(), text.end(), '\n')) + 2;
  text += '\n' + draw_walk(world, plan.walk, screen);
  return text;
}

volatile std::sig_atomic_t plan_signal = 0;

extern "C" void remember_plan_signal(int signal) {
  plan_signal = signal;
  stop_planning();
}

// The first signal ends the planning, and the best walk so far is printed; the second one ends the program.
void stop_planning_on_signals() {
  struct sigaction action {};
  action.sa_handler = remember_plan_signal;
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

// The policy's name, with the iterations asked for.
std::string policy_of(const PlanOptions& options) {
  if (!options.iterations) return options.request.policy;
  if (options.request.policy == "search") return fmt::format("search:{}", *options.iterations);
  throw Error({.what = "--iterations goes with the policy search", .got = in_quotes(options.request.policy, 200)});
}

// The task of the options; of the file if they do not say.
Task task_of(const World& world, const PlanOptions& options) {
  const GivenTask& given = world.given();
  NodeId start = given.start == kNoNode ? world.valid_nodes().front() : given.start;
  if (!options.start.empty()) start = parse_node(world, options.start, "start");
  if (options.budget.empty() && !given.budget) {
    throw Error({.what = "no budget is given", .expected = "--budget B", .where = world.name()});
  }
  return {.view = world,
          .start = start,
          .budget = options.budget.empty() ? checked_budget(world, *given.budget)
                                           : Budget::parse(options.budget).cost_in(world),
          .end = options.end.empty() ? given.end : parse_end(world, options.end).of(start)};
}

void plan(PlanOptions options) {
  options.request.policy = policy_of(options);
  const World world = load_one_world(options.map, options.reading);
  const Task task = task_of(world, options);
  for (const std::string& file : options.out) check_plan_file(world, file);
  stop_planning_on_signals();
  PlanDisplay display(world);
  const Report report = [&](const PlanProgress& progress) { display.show(progress); };
  const PlanReport answer = make_plan(world, task, options.request, report);
  for (const std::string& file : options.out) write_plan(answer, file);
  if (options.json) {
    print_json(plan_json(answer));
  } else {
    print_text(format_plan(world, task, options, answer));
  }
  if (plan_signal != 0) throw CLI::RuntimeError(128 + plan_signal);
}

}  // namespace

void add_plan_command(CLI::App& app) {
  CLI::App* const command =
      app.add_subcommand("plan", "Plan one walk, and say how far from the optimum it may be at most");
  const auto options = std::make_shared<PlanOptions>();
  command
      ->add_option("map", options->map, "paper:a to paper:j, or a file in any format of `graphdrl maps convert --help`")
      ->required()
      ->type_name("MAP");
  command
      ->add_option("--budget", options->budget,
                   "What the walk may cost, or a multiple of the valid nodes, as 1.1x. The default is the file's")
      ->check(not_empty())
      ->type_name("B");
  command
      ->add_option(
          "--start", options->start,
          "A node id, or row,col on a grid; in a graph with labels a label, or #N for node id N. The default is the "
          "file's, else the first valid node")
      ->check(not_empty())
      ->type_name("S");
  command
      ->add_option("--end", options->end,
                   "Where the walk must end: anywhere, start, or a node as for --start. The default is the file's, "
                   "else anywhere")
      ->check(not_empty())
      ->type_name("E");
  command->add_option("--policy", options->request.policy, policy_names())->type_name("P")->capture_default_str();
  command
      ->add_option("--iterations", options->iterations,
                   "Of search: how many steps to take in all; the default depends on the size of the world")
      ->type_name("N");
  command
      ->add_option("--time-limit", options->request.time_limit_s,
                   "Seconds for a plan, the bound included: search goes on until then, beams search wider and wider, "
                   "others stop "
                   "with what they have")
      ->type_name("S");
  command
      ->add_option("--out", options->out,
                   "Also write the plan to this file, in the format of its ending: " + plan_file_endings() +
                       "; may be given again")
      ->check(not_empty())
      ->type_name("FILE");
  add_seed_option(*command, options->request.seed, "For search and for random policies");
  auto* const json = command->add_flag("--json", options->json, "Print one JSON document");
  command->add_flag("--walk", options->walk, "Print the walk instead of a picture, a node a line, as `check` reads it")
      ->excludes(json);
  add_map_options(*command, options->reading);
  add_threads_option(*command);
  command->callback([options] { plan(*options); });
}

}  // namespace graphdrl
