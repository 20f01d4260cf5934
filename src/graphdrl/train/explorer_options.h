// Everything the training of the explorer can be told, in one table, as in train_options.h.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "graphdrl/env/world_families.h"

namespace graphdrl {

// The defaults train for half an hour on two cores.
struct ExplorerOptions {
  std::string preset = "explorer";
  std::uint64_t seed = 1;
  std::int64_t rounds = 210;
  std::int64_t largest = 20;
  std::string teacher = "search";
  std::int64_t teacher_width = 24;
  double ranking = 1;
  double lead = 0.6;
  std::int64_t walks = 512;
  std::int64_t updates = 400;
  std::int64_t batch_size = 64;
  std::int64_t replay_capacity = 200'000;
  double learning_rate = 2e-3;
  std::int64_t checkpoint_every = 20;
};

template <typename Options, typename Field>
void for_each_explorer_field(Options& options, Field&& field) {
  field("preset", options.preset,
        "What to train: explorer, on random worlds of every kind, or paper (also chosen by its own options)");
  field("seed", options.seed,
        "The same seed gives the same policy file, byte for byte (same build and machine; on the CPU)");
  field("rounds", options.rounds, "Rounds of walks and updates; the learning rate falls over all of them");
  field("largest", options.largest,
        "Largest side of training grids (4 to 11, 13, 15, 16, 20); graphs have up to seven times as many nodes");
  field("teacher", options.teacher,
        "Where values come from: search, or double_dqn, bootstrapped from the network's own");
  field("teacher_width", options.teacher_width, "Width of the beam that values a first visit");
  field("ranking", options.ranking, "Weight of the loss on which first visit is best, beside that on values");
  field("lead", options.lead, "Share of walks that the network leads");
  field("walks", options.walks, "Random walks per round");
  field("updates", options.updates, "Learning steps per round");
  field("batch_size", options.batch_size, "States or transitions per learning step");
  field("replay_capacity", options.replay_capacity, "States or transitions remembered");
  field("learning_rate", options.learning_rate, "Adam's; that of the explorer falls to a fiftieth");
  field("checkpoint_every", options.checkpoint_every, "Rounds or episodes between checkpoints");
}

// Throws Error, naming the option, on a value out of range.
void validate(const ExplorerOptions& options);

// The worlds trained on, each as likely as any other.
std::vector<WorldSpec> training_worlds(const ExplorerOptions& options);

void write_config(const std::filesystem::path& path, const ExplorerOptions& options);
// Throws Error on a missing, unknown or mistyped key.
ExplorerOptions read_explorer_config(const std::filesystem::path& path);

}  // namespace graphdrl
