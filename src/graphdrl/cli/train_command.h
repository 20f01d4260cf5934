// `graphdrl train`, as both programs run it.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "graphdrl/train/paper_learner.h"

namespace CLI {
class App;
}

namespace graphdrl {

// Trains as the arguments after `train` say; gives the exit status. `make_learner`: for the devices that the program
// knows.
int run_train_command(const std::vector<std::string>& arguments, const MakePaperLearner& make_learner,
                      const MakePaperLearnerGroup& make_group = {});

// Makes learners on the CPU. Asked for another device, the program becomes graphdrl-train, called with `arguments`,
// which has LibTorch and stands beside it, installed or not: signals and the exit status are that program's from then
// on. REQUIRES: nothing is written yet. The learner throws Error where graphdrl-train is not there.
MakePaperLearner learner_or_torch_program(std::vector<std::string> arguments);

// Catches SIGINT, SIGTERM and SIGHUP from now on. training_signal() gives the last one caught, 0 if none.
void catch_training_signals();
int training_signal();

// Shows the table of its options, for manuals and completions.
void visit_train_options(const std::function<void(const CLI::App&)>& visit);

}  // namespace graphdrl
