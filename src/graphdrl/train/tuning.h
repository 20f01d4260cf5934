// A search for better hyper-parameters of the preset `paper`, by successive halving [Jamieson and Talwalkar 2016]: many
// settings by few seeds, then the best of them again, by more and fresh ones.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "graphdrl/eval/statistics.h"
#include "graphdrl/train/side_by_side.h"

namespace graphdrl {

struct TuneRound {
  int settings;
  int seeds;  // fresh ones
};

// "30x2,6x8": 30 settings by 2 seeds, then the best six, and the paper's where it is none of them, by 8 others. Throws
// Error, naming --rounds, on anything else and where settings become more.
std::vector<TuneRound> parse_rounds(const std::string& text);

struct TuneOptions {
  std::vector<TuneRound> rounds;
  std::int64_t episodes = 400;
  int train_maps = 64;       // of those settings that train on many
  int validation_maps = 30;  // none of them one of the paper's or one to train on
  std::uint64_t seed = 1;    // of the settings drawn and of the trainings
  std::string device = "cpu";
};

// What a setting changes of the preset, by the options' keys. The first one changes nothing: it is the paper's, and
// takes part in every round. "maps" is "many" or not there.
using Setting = nlohmann::ordered_json;

// How good a setting is: mean coverage of the validation maps over all starts, in percent.
struct SettingScore {
  std::size_t setting;
  std::vector<double> by_seed;
  Summary over_seeds;
  double over_paper;                        // the mean difference to the paper's setting, seed by seed
  std::optional<double> over_paper_errors;  // the same, in standard errors of that mean
};
using RoundScores = std::vector<SettingScore>;  // the best first

// How the settings of the first round that share a value do.
struct ValueEffect {
  std::string option;
  std::string value;
  Summary over_settings;
};

class Tuning {
 public:
  // Draws the settings and the maps, and writes FOLDER/tune.json and FOLDER/maps/. Goes on with a search that was told
  // the same. Throws Error where the folder holds another. Collective, as the next two: the first rank writes.
  static Tuning start(const TuneOptions& options, std::filesystem::path folder,
                      const LearnerSource& learners = kCpuLearners, Ranks& ranks = one_rank());
  static Tuning resume(std::filesystem::path folder, Ranks& ranks = one_rank());

  // All rounds, or until `stop` says so; gives whether it is finished. Of a share of the tasks, the runs of the first
  // round that lacks any: it is not finished then. The runs lie in FOLDER/round-R/setting-I/seed-S. Settings with a run
  // that failed too often take no part any more. Throws Error where that is the paper's.
  bool run(const std::function<bool()>& stop, const std::function<void(std::size_t round, const SideBySideNews&)>& tell,
           const LearnerSource& learners = kCpuLearners, const TaskWorkers& workers = {});

  const TuneOptions& options() const { return options_; }
  const std::vector<Setting>& settings() const { return settings_; }
  const std::vector<RoundScores>& scores() const { return scores_; }  // of the rounds that are done
  std::vector<ValueEffect> effects() const;                           // REQUIRES: the first round is done

 private:
  Tuning(TuneOptions options, std::vector<Setting> settings, std::filesystem::path folder);

  std::vector<std::size_t> settings_of(std::size_t round) const;
  std::vector<PlannedRun> runs_of(std::size_t round) const;
  // Nothing where `stop`, asked before each setting, says so. trainings: the round's.
  std::optional<RoundScores> score(std::size_t round, const SideBySide& trainings, const std::function<bool()>& stop,
                                   Ranks& ranks) const;
  std::vector<double> scores_by_seed(std::span<const PlannedRun> runs, const std::vector<World>& worlds) const;

  TuneOptions options_;
  std::vector<Setting> settings_;
  std::filesystem::path folder_;
  std::vector<RoundScores> scores_;
};

}  // namespace graphdrl
