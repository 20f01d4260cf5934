// `plan` of a folder of maps: a plan of each, and a table of all.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "graphdrl/answer/answer.h"
#include "graphdrl/cli/program.h"

namespace graphdrl {

// Whether these are many maps and a folder for their plans: one that is there, or a name without an ending.
bool asks_for_folder(const std::string& maps, const std::filesystem::path& out);

struct FolderOfPlans {
  std::string maps;                // a folder, or paper
  std::filesystem::path folder;    // of NAME.json, summary.csv and .plans.json, which says what they come from
  std::vector<std::string> files;  // others that plans come from, as the policy
  TaskWorkers workers;
  bool json;  // prints one document
};

// Plans what is missing, sums up all, and prints what was done. answer(map) plans one; once a signal has come its plan
// is dropped, which may be worse than it should be. command: whose options the plans come from, too. Throws Error as
// TaskFolder::run(), and where the folder's plans come from something else. Collective.
void plan_folder(const FolderOfPlans& plans, const CLI::App& command,
                 const std::function<Answer(const std::string& map)>& answer);

}  // namespace graphdrl
