#include "graphdrl/cli/commands.h"
#include "graphdrl/cli/program.h"
#include "graphdrl/cli/train_command.h"

namespace graphdrl {

void add_train_command(CLI::App& app, const LearnerSource& learners) {
  CLI::App* const command =
      app.add_subcommand("train", "Train a policy, and write a run directory (train --help has the options)");
  // It has a parser of its own: CLI11 reads configuration files for whole programs only.
  command->prefix_command();
  command->set_help_flag();
  command->callback([command, &learners] {
    const int status = run_train_command(command->remaining(), learners);
    if (status != kExitDone) throw CLI::RuntimeError(status);
  });
}

}  // namespace graphdrl
