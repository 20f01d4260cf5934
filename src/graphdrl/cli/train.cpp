#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <memory>
#include <vector>

#include "graphdrl/base/error.h"
#include "graphdrl/cli/commands.h"

namespace graphdrl {
namespace {

constexpr const char* kTrainProgram = "graphdrl-train";

// Becomes graphdrl-train, which links LibTorch; it stands beside this program. Signals and the exit status are its own.
[[noreturn]] void become_trainer(const std::vector<std::string>& arguments) {
  const std::filesystem::path program = trainer_program();
  std::vector<char*> argv = {const_cast<char*>(kTrainProgram)};
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  execv(program.c_str(), argv.data());
  throw Error({.what = std::string("cannot start the trainer (") + std::strerror(errno) + ")",
               .expected = "graphdrl-train beside graphdrl, which needs a build with LibTorch",
               .where = program.string()});
}

}  // namespace

std::filesystem::path trainer_program() {
  return std::filesystem::read_symlink("/proc/self/exe").parent_path() / kTrainProgram;
}

void add_train_command(CLI::App& app) {
  CLI::App* const command =
      app.add_subcommand("train", "Train a policy (runs graphdrl-train; its --help has the options)");
  command->prefix_command();
  command->set_help_flag();
  command->callback([command] { become_trainer(command->remaining()); });
}

}  // namespace graphdrl
