#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <vector>

#include "graphdrl/base/error.h"
#include "graphdrl/cli/commands.h"
#include "graphdrl/cli/program.h"
#include "graphdrl/cli/train_command.h"

namespace graphdrl {
namespace {

constexpr const char* kTorchProgram = "graphdrl-train";

// Becomes graphdrl-train, which has LibTorch and stands beside this program, installed or not. Signals and the exit
// status are its own from then on.
[[noreturn]] void become_torch_program(const std::string& device, const std::vector<std::string>& arguments) {
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe").parent_path() / kTorchProgram;
  std::vector<char*> argv = {const_cast<char*>(kTorchProgram)};
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  execv(program.c_str(), argv.data());
  throw Error({.what = "training on " + device + " needs graphdrl-train beside graphdrl (" + std::strerror(errno) + ")",
               .expected = "a build with LibTorch (scripts/build --torch), or --device cpu",
               .where = program.string()});
}

}  // namespace

void add_train_command(CLI::App& app) {
  CLI::App* const command =
      app.add_subcommand("train", "Train a policy, and write a run directory (train --help has the options)");
  // It has a parser of its own: CLI11 reads configuration files for whole programs only.
  command->prefix_command();
  command->set_help_flag();
  command->callback([command] {
    const std::vector<std::string> arguments = command->remaining();
    const int status =
        run_train_command(arguments, [&](const std::string& device, const PaperLearnerOptions& options, Rng& rng) {
          if (device != "cpu") become_torch_program(device, arguments);  // nothing is written yet
          return make_paper_cpu_learner(device, options, rng);
        });
    if (status != kExitDone) throw CLI::RuntimeError(status);
  });
}

}  // namespace graphdrl
