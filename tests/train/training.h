// Short trainings, for tests of what all of them share.
#pragma once

#include <cstdio>
#include <filesystem>
#include <functional>
#include <ostream>
#include <string>

#include "graphdrl/io/file.h"
#include "graphdrl/train/trainer.h"
#include "safetensors_support.h"
#include "support.h"

namespace graphdrl {

// What a test is listed as.
inline void PrintTo(const TrainOptions& options, std::ostream* out) {
  *out << options.preset;
  *out << ' ' << (options.preset == kPaperPreset ? options.algorithm : options.reveal);
}

// Steps of `short_paper`. It asks whether to stop before each, and after each episode.
inline constexpr int kShortPaperSteps = 40;

// Of four episodes.
inline TrainOptions short_paper() {
  TrainOptions options = default_options(kPaperPreset);
  options.maps = {"paper:a", "paper:h"};
  options.episodes = 4;
  options.budget = std::to_string(kShortPaperSteps / options.episodes);
  options.batch_size = 8;
  options.replay_capacity = 24;  // wraps around
  options.checkpoint_every = 2;
  return options;
}

// Of four rounds.
inline TrainOptions short_explorer() {
  TrainOptions options = default_options(kExplorerPreset);
  options.rounds = 4;
  options.largest = 5;
  options.walks = 24;
  options.updates = 6;
  options.batch_size = 8;
  options.replay_capacity = 50;  // wraps around
  options.teacher_steps = 1;
  options.checkpoint_every = 1;
  return options;
}

// The same of maps that are not known.
inline TrainOptions short_online() {
  TrainOptions options = short_explorer();
  options.reveal = "edges";
  options.teacher_steps = TrainOptions().teacher_steps;
  return options;
}

// Trains without a word until `stop` says so; gives whether the training is finished.
inline bool train(
    Trainer& trainer, const std::function<bool()>& stop = [] { return false; }) {
  return trainer.run(stop, [](const TrainingNews&) {});
}

// What must not depend on threads or interruptions.
struct Bytes {
  std::string policy;
  std::string metrics;

  friend bool operator==(const Bytes&, const Bytes&) = default;
};

inline Bytes bytes_of(const RunDirectory& run) {
  return {read_file(run.policy()), read_file(run.metrics())};
}

// A whole training in a new folder.
inline Bytes train_in(const std::filesystem::path& path, const TrainOptions& options) {
  const RunDirectory run(path);
  EXPECT_TRUE(train(*Trainer::start(options, run)));
  return bytes_of(run);
}

// Overwrites an element of an array of a safetensors file's content.
template <typename T>
std::string with_element(std::string content, const std::string& name, std::size_t index, T value) {
  const Safetensors file = Safetensors::parse(content, "whole");
  const std::size_t data = content.size() - file.entries().back().end;
  for (const Safetensors::Entry& entry : file.entries()) {
    if (entry.name == name)
      content.replace(data + entry.begin + index * sizeof value, sizeof value, reinterpret_cast<const char*>(&value),
                      sizeof value);
  }
  return content;
}

}  // namespace graphdrl
