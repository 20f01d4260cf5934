// graphdrl-train: `graphdrl train` with LibTorch, for other devices than the CPU. `graphdrl train --device cuda`
// becomes it.
#include "graphdrl/cli/train_command.h"
#include "graphdrl/train/torch/paper_device_learner.h"
#include "graphdrl/train/torch/paper_stack.h"

int main(int argc, char** argv) {
  return graphdrl::run_train_command({argv + 1, argv + argc}, graphdrl::make_paper_device_learner,
                                     graphdrl::make_paper_stack);
}
