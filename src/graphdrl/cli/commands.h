// The subcommands of `graphdrl`, one per source file beside this one. `learners` must outlive the app.
#pragma once

#include "graphdrl/train/paper_learner.h"

namespace CLI {
class App;
}

namespace graphdrl {

void add_bench_command(CLI::App& app);
void add_check_command(CLI::App& app);
void add_completion_command(CLI::App& app);
void add_evaluate_command(CLI::App& app);
void add_export_command(CLI::App& app);
void add_inspect_command(CLI::App& app);
void add_maps_command(CLI::App& app);
void add_plan_command(CLI::App& app);
void add_report_command(CLI::App& app);
void add_results_command(CLI::App& app);
void add_train_command(CLI::App& app, const LearnerSource& learners);
void add_tune_command(CLI::App& app, const LearnerSource& learners);  // of graphdrl-train, too

}  // namespace graphdrl
