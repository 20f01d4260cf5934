// graphdrl-train: `graphdrl train` and `graphdrl tune` with LibTorch, for other devices than the CPU. With
// `--device cuda` they become it.
#include <string_view>

#include "graphdrl/cli/commands.h"
#include "graphdrl/cli/program.h"
#include "graphdrl/train/torch/paper_stack.h"

// NOLINTNEXTLINE(bugprone-exception-escape): before the arguments are read only memory can run out
int main(int argc, char** argv) {
  using namespace graphdrl;
  const DeviceLearners learners;
  if (argc < 2 || std::string_view(argv[1]) != "tune") return run_train_command({argv + 1, argv + argc}, learners);
  CLI::App app{"Training of GraphDRL on a GPU", "graphdrl"};
  add_tune_command(app, learners);
  return run_program(app, argc, argv);
}
