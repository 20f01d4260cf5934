// `graphdrl train`, as both programs run it.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <vector>

#include "graphdrl/train/paper_learner.h"

namespace graphdrl {

// Trains as the arguments after `train` say; gives the exit status. `make_learner` knows the devices of the program.
int run_train_command(const std::vector<std::string>& arguments, const MakePaperLearner& make_learner,
                      const MakePaperLearnerGroup& make_group = {});

// Makes learners on the CPU. Asked for another device, it replaces the process by graphdrl-train with `arguments`: the
// program beside this one that has LibTorch. Signals and the exit status are that program's from then on. REQUIRES:
// nothing is written yet. Throws Error if graphdrl-train is missing.
MakePaperLearner learner_or_torch_program(std::vector<std::string> arguments);

// Catches SIGINT, SIGTERM and SIGHUP from now on. training_signal() gives the last one caught, 0 if none.
void catch_training_signals();
int training_signal();

// Shows the table of its options, for manuals and completions.
void visit_train_options(const std::function<void(const CLI::App&)>& visit);

}  // namespace graphdrl
