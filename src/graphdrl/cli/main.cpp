#include "graphdrl/cli/commands.h"
#include "graphdrl/cli/program.h"

// NOLINTNEXTLINE(bugprone-exception-escape): before the arguments are read only memory can run out
int main(int argc, char** argv) {
  CLI::App app{"GraphDRL learns to explore graphs: to visit as many nodes as it can before a budget runs out.",
               "graphdrl"};
  app.set_version_flag("--version", GRAPHDRL_VERSION);
  app.require_subcommand(1);
  const graphdrl::CpuOrTorchProgram learners({argv + 1, argv + argc});
  graphdrl::add_train_command(app, learners);
  graphdrl::add_tune_command(app, learners);
  graphdrl::add_evaluate_command(app);
  graphdrl::add_explore_command(app);
  graphdrl::add_serve_command(app);
  graphdrl::add_plan_command(app);
  graphdrl::add_check_command(app);
  graphdrl::add_report_command(app);
  graphdrl::add_results_command(app);
  graphdrl::add_inspect_command(app);
  graphdrl::add_export_command(app);
  graphdrl::add_maps_command(app);
  graphdrl::add_bench_command(app);
  graphdrl::add_completion_command(app);
  return graphdrl::run_program(app, argc, argv);
}
