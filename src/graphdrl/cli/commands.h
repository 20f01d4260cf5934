// The subcommands of `graphdrl`, one per source file beside this one, and `train` as all programs run it. `learners`
// and `ranks` must outlive the app.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "graphdrl/base/ranks.h"
#include "graphdrl/train/paper_learner.h"

namespace CLI {
class App;
}

namespace graphdrl {

void add_bench_command(CLI::App& app);
void add_check_command(CLI::App& app);
void add_completion_command(CLI::App& app);
void add_evaluate_command(CLI::App& app, Ranks& ranks = one_rank());
void add_explore_command(CLI::App& app);
void add_export_command(CLI::App& app);
void add_inspect_command(CLI::App& app);
void add_maps_command(CLI::App& app);
void add_plan_command(CLI::App& app, Ranks& ranks = one_rank());
void add_report_command(CLI::App& app);
void add_results_command(CLI::App& app);
void add_serve_command(CLI::App& app);
void add_train_command(CLI::App& app, const LearnerSource& learners, Ranks& ranks = one_rank());
void add_tune_command(CLI::App& app, const LearnerSource& learners,
                      Ranks& ranks = one_rank());  // of graphdrl-train, too

// Trains as the arguments after `train` say; gives the exit status.
int run_train_command(const std::vector<std::string>& arguments, const LearnerSource& learners,
                      Ranks& ranks = one_rank());

// Makes learners on the CPU. Asked for another device, the program becomes graphdrl-train, called with the program's
// `arguments`, which has LibTorch and stands beside it, installed or not: signals and the exit status are that
// program's from then on. REQUIRES: nothing is written yet. Throws Error where graphdrl-train is not there.
class CpuOrTorchProgram final : public LearnerSource {
 public:
  explicit CpuOrTorchProgram(std::vector<std::string> arguments) : arguments_(std::move(arguments)) {}
  void prepare(const std::string& device) const override;
  std::unique_ptr<PaperLearner> make(const std::string& device, const PaperLearnerOptions& options,
                                     Rng& rng) const override;
  std::vector<std::unique_ptr<LearnerSource>> make_together(const std::string& device, int trainings) const override;

 private:
  std::vector<std::string> arguments_;
};

// Shows the table of its options, for manuals and completions.
void visit_train_options(const std::function<void(const CLI::App&)>& visit);

}  // namespace graphdrl
