#include "graphdrl/train/finished_runs.h"

#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "graphdrl/base/error.h"
#include "graphdrl/io/file.h"
#include "graphdrl/io/json.h"
#include "graphdrl/train/recipe.h"
#include "graphdrl/train/seed_runs.h"

namespace graphdrl {
namespace {

using Json = nlohmann::ordered_json;

void require_finished(const RunDirectory& run) {
  if (!run.holds_a_run()) throw Error({.what = "there is no run", .where = run.path().string()});
  const RunState state = state_of(run);
  if (state.finished()) return;
  throw Error({.what = state.faults.empty() ? "the run is not finished" : state.faults.front(),
               .expected = "a finished run; to go on: graphdrl train --resume " + run.path().string(),
               .where = run.path().string()});
}

FinishedRun read_finished_run(const RunDirectory& directory) {
  require_finished(directory);
  FinishedRun run{.directory = directory, .options = read_config(directory.config()), .metrics = {}, .maps = {}};
  const std::string source = directory.metrics().string();
  const std::string text = read_file(source);
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    require_shallow_json(line, source);
    run.metrics.push_back(Json::parse(line, nullptr, /*allow_exceptions=*/false));
    if (run.metrics.back().is_object()) continue;
    throw Error({.what = "a line that is no JSON object", .got = in_quotes(line, 80), .where = source});
  }
  const Checkpoint checkpoint = Checkpoint::read(directory.checkpoint());
  checkpoint.require_preset(run.options.preset);
  if (run.options.preset == kPaperPreset) {
    for (const World& world : worlds_of(checkpoint)) run.maps.push_back(world.name());
  }
  return run;
}

}  // namespace

std::vector<FinishedRun> read_finished_runs(const std::vector<std::string>& paths) {
  std::vector<FinishedRun> runs;
  for (const std::string& path : paths) {
    if (!SeedRuns::are_in(path)) {
      runs.push_back(read_finished_run(RunDirectory(path)));
      continue;
    }
    for (const std::uint64_t seed : read_seeds(path).seeds) {
      runs.push_back(read_finished_run(SeedRuns::run_directory_in(path, seed)));
    }
  }
  std::set<std::uint64_t> seeds;
  for (const FinishedRun& run : runs) {
    if (!seeds.insert(run.options.seed).second) {
      throw Error({.what = "two runs of seed " + std::to_string(run.options.seed),
                   .expected = "each seed once",
                   .where = run.directory.path().string()});
    }
    TrainOptions same = run.options;
    same.seed = runs.front().options.seed;
    if (config_json(same) == config_json(runs.front().options)) continue;
    throw Error({.what = "runs of different options",
                 .expected = "runs that differ in their seeds alone",
                 .where = run.directory.path().string()});
  }
  return runs;
}

std::vector<Point> curve_of(const FinishedRun& run, const std::string& metric) {
  std::vector<Point> curve;
  const std::string counter = units_of(run.options).name;
  for (const Json& line : run.metrics) {
    if (!line.contains(counter) || !line[counter].is_number() || !line.contains(metric)) continue;
    if (line[metric].is_number()) curve.push_back({line[counter].get<double>(), line[metric].get<double>()});
  }
  if (curve.empty()) throw Error({.what = "no value of " + metric, .where = run.directory.metrics().string()});
  return curve;
}

}  // namespace graphdrl
