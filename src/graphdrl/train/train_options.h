// Everything a training can be told, in one table: flags, config files, help and the run's config.json come from it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "graphdrl/env/budget.h"
#include "graphdrl/env/episode.h"

namespace graphdrl {

inline constexpr const char* kRandomStart = "random";

// The defaults are the preset `paper`: the paper's numbers (section 2.2), and its author's code where the paper is
// silent.
struct TrainOptions {
  std::string preset = "paper";
  std::vector<std::string> maps = {"paper:a"};
  std::int64_t episodes = 10'000;
  std::string budget = "25";
  std::string start = kRandomStart;
  std::uint64_t seed = 1;
  std::string reward = "visit_penalty";
  bool end_at_full_coverage = false;
  bool punish_blocked_by_visits = false;
  std::string algorithm = "dqn";
  std::int64_t batch_size = 32;
  std::int64_t replay_capacity = 100'000;
  double discount = 0.99;
  double learning_rate = 1e-3;
  double soft_update = 1e-3;
  double dropout = 0.5;
  std::int64_t checkpoint_every = 100;
  std::string device = "cpu";
};

// Calls field(key, member, help) for every option, in the order of the help.
template <typename Options, typename Field>
void for_each_field(Options& options, Field&& field) {
  field("preset", options.preset, "The explorer to train: paper");
  field("maps", options.maps, "Maps to train on, drawn anew for every episode: paper:a, a file, a folder");
  field("episodes", options.episodes, "Episodes; epsilon's schedule spans all of them");
  field("budget", options.budget, "Steps per episode, or a multiple of the valid nodes, as 1.1x");
  field("start", options.start, "Where episodes start: random, a node id, or row,col");
  field("seed", options.seed,
        "The same seed gives the same policy file, byte for byte (same build and machine, --device cpu)");
  field("reward", options.reward, "visit_penalty (paper, eq. 3) or coverage_gain (eq. 2)");
  field("end_at_full_coverage", options.end_at_full_coverage, "End an episode at full coverage, with a bonus of 1");
  field("punish_blocked_by_visits", options.punish_blocked_by_visits,
        "Punish a blocked move by a further 0.1 per visit of the node (with visit_penalty)");
  field("algorithm", options.algorithm, "dqn or double_dqn");
  field("batch_size", options.batch_size, "Transitions per learning step");
  field("replay_capacity", options.replay_capacity, "Transitions the replay buffer keeps");
  field("discount", options.discount, "Of the next state's value; the paper's alpha");
  field("learning_rate", options.learning_rate, "Adam's");
  field("soft_update", options.soft_update, "Share of the online weights in the target's, per step; the paper's beta");
  field("dropout", options.dropout, "Probability to drop a hidden value");
  field("checkpoint_every", options.checkpoint_every, "Episodes between checkpoints");
  field("device", options.device, "cpu or cuda; cuda needs a LibTorch that has it");
}

// Throws Error, naming the option, on a value out of range.
void validate(const TrainOptions& options);

EpisodeOptions episode_options(const TrainOptions& options, const World& world);

// config.json: every option, resolved.
void write_config(const std::filesystem::path& path, const TrainOptions& options);
// Throws Error on a missing, unknown or mistyped key.
TrainOptions read_config(const std::filesystem::path& path);

}  // namespace graphdrl
