#include <fmt/format.h>
#include <fmt/ranges.h>

#include <atomic>
#include <csignal>
#include <memory>

#include "graphdrl/base/error.h"
#include "graphdrl/cli/commands.h"
#include "graphdrl/cli/program.h"
#include "graphdrl/env/load_worlds.h"
#include "graphdrl/planners/registry.h"
#include "graphdrl/report/map_drawing.h"
#include "graphdrl/report/plan_files.h"
#include "graphdrl/report/progress.h"

namespace graphdrl {
namespace {

constexpr double kProgressAfterS = 1;
constexpr std::size_t kLongestWalkPrinted = 2000;  // nodes
constexpr std::size_t kWidestDrawing = 240;        // characters

struct PlanOptions {
  std::string map;
  MapOptions reading;
  AskedText asked;
  PlanRequest request;
  std::optional<double> time_limit_s;
  std::vector<std::string> out;
  bool json = false;
};

// A bar on standard error once a plan takes a while.
class PlanDisplay {
 public:
  explicit PlanDisplay(const World& world) : valid_count_(world.valid_count()), display_(stderr, "visited", 0) {}
  ~PlanDisplay() { display_.finish(); }

  void show(const Progress& progress) {
    const double elapsed_s = watch_.seconds();
    if (elapsed_s < kProgressAfterS) return;
    const std::string bound = progress.bound <= valid_count_ ? fmt::format(", bound {:.0f}", progress.bound) : "";
    display_.show_line(fmt::format("{} of {} nodes{}  {:.0f} s", progress.visited, valid_count_, bound, elapsed_s),
                       static_cast<double>(progress.visited) / valid_count_);
  }

 private:
  Stopwatch watch_;
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
  const std::string most = world.has_prizes() ? decimal(plan.bound) : fmt::format("{} nodes", answer.max_visited());
  return fmt::format("bound    no walk {} than {}, {:.1f} %: the gap is {:.1f} points\n", what, most,
                     world.percent_of_all(plan.bound),
                     world.percent_of_all(plan.bound) - world.percent_of_all(plan.prize));
}

std::string format_plan(const PlanReport& answer) {
  const World& world = answer.world;
  const Task& task = answer.task;
  const Plan& plan = answer.plan;
  std::string text = fmt::format("{}, {} from {}", world.name(), answer.policy, name_of(world, plan.walk.front()));
  if (!task.ends_anywhere()) text += fmt::format(" to {}", name_of(world, task.end()));
  text += fmt::format(", budget {}\n", decimal(task.budget()));
  text += fmt::format("visited  {} of {} nodes, {:.1f} %, for {}\n", plan.visited, world.valid_count(),
                      100.0 * plan.visited / world.valid_count(), decimal(plan.cost));
  if (world.has_prizes()) {
    text += fmt::format("prize    {} of {}, {:.1f} %\n", decimal(plan.prize), decimal(world.total_prize()),
                        world.percent_of_all(plan.prize));
  }
  text += format_bound(world, answer);
  if (answer.unreachable > 0) {
    text += fmt::format("         {} node{} cannot be reached from there\n", answer.unreachable,
                        answer.unreachable == 1 ? "" : "s");
  }
  std::vector<std::string> names;
  if (plan.walk.size() > kLongestWalkPrinted) {
    text += fmt::format("walk     {} steps; --out FILE or --json gives them\n", plan.walk.size() - 1);
    return text;
  }
  for (const NodeId node : plan.walk) {
    names.push_back(world.labels().empty() ? std::to_string(node) : escaped(world.labels()[node]));
  }
  text += fmt::format("walk     {}\n", fmt::join(names, " "));
  const std::size_t digits = std::to_string(plan.walk.size()).size() + 1;
  if (world.has_cells() && world.map()->cols * digits <= kWidestDrawing) text += "\n" + draw_map_text(world, plan.walk);
  return text;
}

volatile std::sig_atomic_t plan_signal = 0;
std::atomic<bool> plan_stopped = false;
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler writes it");

extern "C" void remember_plan_signal(int signal) {
  plan_signal = signal;
  plan_stopped = true;
}

// The first signal ends the planning, and the best walk so far is printed; the second one ends the program.
void stop_planning_on_signals() {
  struct sigaction action {};
  action.sa_handler = remember_plan_signal;
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

void plan(const PlanOptions& options) {
  const World world = load_one_world(options.map, options.reading);
  const Task task(world, asked_of(world, options.asked));
  for (const std::string& file : options.out) check_plan_file(world, file);
  stop_planning_on_signals();
  PlanDisplay display(world);
  const ProgressListener listener = [&](const Progress& progress) { display.show(progress); };
  const PlanReport answer =
      make_plan(world, task, options.request, Clock(options.time_limit_s, &plan_stopped, &listener));
  for (const std::string& file : options.out) write_plan(answer, file);
  if (options.json) {
    print_json(plan_json(answer));
  } else {
    print_text(format_plan(answer));
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
      ->add_option("--budget", options->asked.budget,
                   "What the walk may cost, or a multiple of the valid nodes, as 1.1x. The default is the file's")
      ->check(not_empty())
      ->type_name("B");
  command
      ->add_option(
          "--start", options->asked.start,
          "A node id, or row,col on a grid; in a graph with labels a label, or #N for node id N. The default is the "
          "file's, else the first valid node")
      ->check(not_empty())
      ->type_name("S");
  command
      ->add_option("--end", options->asked.end,
                   "Where the walk must end: anywhere, start, or a node as for --start. The default is the file's, "
                   "else anywhere")
      ->check(not_empty())
      ->type_name("E");
  command->add_option("--policy", options->request.policy, policy_names())->type_name("P")->capture_default_str();
  command
      ->add_option("--iterations", options->request.iterations,
                   "Of search: how many steps to take in all; the default depends on the size of the world")
      ->type_name("N");
  command
      ->add_option("--time-limit", options->time_limit_s,
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
  command->add_flag("--json", options->json, "Print one JSON document");
  add_map_options(*command, options->reading);
  add_threads_option(*command);
  command->callback([options] { plan(*options); });
}

}  // namespace graphdrl
