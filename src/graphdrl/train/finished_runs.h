// Trainings that are done, read back: what they were told, how they went, where their policies are.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "graphdrl/graph/point.h"
#include "graphdrl/train/options.h"
#include "graphdrl/train/run_directory.h"

namespace graphdrl {

struct FinishedRun {
  RunDirectory directory;
  TrainOptions options;
  std::vector<nlohmann::ordered_json> metrics;  // the lines of metrics.jsonl
  std::vector<std::string> maps;                // names of the worlds trained on; none of an explorer's
};

// Run directories, and folders of many seeds. Throws Error where a run is not finished, where they differ in more than
// their seeds, or where a seed is there twice.
std::vector<FinishedRun> read_finished_runs(const std::vector<std::string>& paths);

// A metric over episodes or rounds; without the lines where it has no value yet. Throws Error where no line has it.
std::vector<Point> curve_of(const FinishedRun& run, const std::string& metric);

}  // namespace graphdrl
