// `graphdrl train`, as both programs run it.
#pragma once

#include <string>
#include <vector>

#include "graphdrl/train/paper_learner.h"

namespace graphdrl {

// Trains as the arguments after `train` say; gives the exit status. `make_learner`: for the devices that the program
// knows.
int run_train_command(const std::vector<std::string>& arguments, const MakePaperLearner& make_learner);

}  // namespace graphdrl
