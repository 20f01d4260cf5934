#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>

#include "graphdrl/base/parallel.h"
#include "graphdrl/train/explorer_learner.h"
#include "graphdrl/train/explorer_replay.h"
#include "graphdrl/train/recipe.h"

namespace graphdrl {
namespace {

constexpr std::uint64_t kWalkPurpose = 1;  // of derive_seed
constexpr const char* kRoundKey = "round";
constexpr double kLastRate = 0.02;  // of the first learning rate, as in docs/explorer.md, "Training"

// Most are small: there the search's values are nearly exact, and several lessons cost as much as one of a large world.
// Larger ones are worth 0.7 points on graphs of 200 nodes and cost grids up to 2 (docs/explorer.md, "What pays").
constexpr int kSides[] = {4, 5, 6, 7, 8, 9, 10, 11, 13, 15, 16, 20, 26};
constexpr int kNodes[] = {16, 33, 55, 77, 110, 140};
constexpr int kNodesPerSide = 7;

// Drawn more often, by so many entries in the list: the paper's size, and mazes that are hard but not large.
constexpr int kPaperSide = 5;
constexpr int kPaperSideCopies = 5;
constexpr int kLeastHardMaze = 7;
constexpr int kMostHardMaze = 11;
constexpr int kHardMazeCopies = 3;

// The larger a graph with one way edges, the more of it is lost after a few steps.
constexpr int kMostDirected = 77;
constexpr int kMostDirectedWeighted = 33;

void add(std::vector<WorldSpec>& worlds, int copies, const WorldSpec& spec) {
  worlds.insert(worlds.end(), static_cast<std::size_t>(copies), spec);
}

// The worlds that the explorer is trained on, each as likely as any other. Grids up to `largest` cells a side, graphs
// up to seven times as many nodes.
std::vector<WorldSpec> training_worlds(int largest) {
  std::vector<WorldSpec> worlds;
  for (const int side : kSides) {
    if (side > largest) break;
    add(worlds, side == kPaperSide ? kPaperSideCopies : 1, {"obstacles", side});
    for (const char* const family : {"rooms", "open", "caves", "houses", "streets"}) add(worlds, 1, {family, side});
    if (side % 2 == 0) continue;  // mazes have an odd number of cells a side
    const bool hard = side >= kLeastHardMaze && side <= kMostHardMaze;
    for (const char* const family : {"maze", "loop-maze", "braided-maze"}) {
      add(worlds, hard ? kHardMazeCopies : 1, {family, side});
    }
  }
  for (const std::string family : {"tree", "erdos-renyi", "barabasi-albert", "watts-strogatz", "geometric"}) {
    for (const int nodes : kNodes) {
      if (nodes > kNodesPerSide * largest) break;
      add(worlds, 1, {family, nodes});
      add(worlds, 1, {family, nodes, /*weighted=*/true});
      if (family == "tree" || nodes > kMostDirected) continue;  // one way only, a tree is soon left for good
      add(worlds, 1, {family, nodes, /*weighted=*/false, /*directed=*/true});
      if (nodes <= kMostDirectedWeighted) add(worlds, 1, {family, nodes, /*weighted=*/true, /*directed=*/true});
    }
  }
  return worlds;
}

LessonOptions lesson_options(const TrainOptions& options) {
  LessonOptions lessons;
  lessons.worlds = training_worlds(static_cast<int>(options.largest));
  lessons.teacher_steps = static_cast<int>(options.teacher_steps);
  lessons.lead = options.lead;
  return lessons;
}

class ExplorerRecipe final : public Recipe {
 public:
  ExplorerRecipe(const TrainOptions& options, Rng& rng)
      : options_(options),
        rng_(rng),
        lesson_options_(lesson_options(options)),
        learner_(options.ranking, rng_),
        replay_(static_cast<std::size_t>(options.replay_capacity)) {}

  bool run_unit(TrainingProgress& progress, const std::function<bool()>& stop) override {
    if (!updates_) {
      auto drawn = draw(progress.done, stop);
      if (!drawn) return false;
      for (std::vector<Lesson>& of_walk : *drawn) {
        progress.samples += std::ssize(of_walk);
        for (Lesson& lesson : of_walk) replay_.push(std::move(lesson));
      }
      updates_ = 0;
      loss_ = regret_ = 0;
    }
    if (!learn(progress.done, stop)) return false;
    updates_.reset();
    return true;
  }

  std::string status(const TrainingProgress& progress) const override {
    return fmt::format("{} states  loss {:.4f}  regret {:.4f}", progress.samples, loss_, regret_);
  }

  std::vector<Metric> take_metrics(const TrainingProgress& progress) override {
    return {{"states", static_cast<double>(progress.samples)}, {"loss", loss_}, {"regret", regret_}};
  }

  void save(CheckpointWriter& checkpoint) const override {
    checkpoint.add("online.", learner_.parameters());
    checkpoint.add(learner_.adam());
    replay_.save(checkpoint);
    if (updates_) checkpoint.add_json(kRoundKey, {{"updates", *updates_}, {"loss", loss_}, {"regret", regret_}});
  }

  std::string not_finite() const override { return learner_.parameters().first_not_finite(); }

  void restore(const Checkpoint& checkpoint, const TrainingProgress& progress) override {
    learner_.set_state(checkpoint.parameters<ExplorerParameters>("online."),
                       checkpoint.adam(trainable_count(ExplorerParameters::specs())));
    replay_.restore(checkpoint, lesson_options_);
    if (static_cast<std::int64_t>(replay_.size()) != std::min(progress.samples, options_.replay_capacity)) {
      checkpoint.fail("the checkpoint remembers another number of lessons than it has drawn");
    }
    if (!checkpoint.has_json(kRoundKey)) return;
    const nlohmann::ordered_json round = checkpoint.json(kRoundKey);
    checkpoint.read_number(round, "updates", updates_.emplace());
    checkpoint.read_number(round, "loss", loss_);
    checkpoint.read_number(round, "regret", regret_);
  }

  void write_policy(const std::filesystem::path& path) const override {
    write_policy_file(path, learner_.parameters());
  }

 private:
  // The lessons of a round's walks, which the network leads as it is now. The same for any number of threads. None
  // where `stop` said so before the last.
  std::optional<std::vector<std::vector<Lesson>>> draw(std::int64_t round, const std::function<bool()>& stop) const {
    std::vector<std::vector<Lesson>> by_walk(static_cast<std::size_t>(options_.walks));
    std::atomic<bool> stopped = false;
    parallel_for(static_cast<int>(options_.walks), [&](int walk) {
      if (stopped || stop()) {
        stopped = true;
        return;
      }
      const auto index = static_cast<std::uint64_t>(round * options_.walks + walk);
      by_walk[walk] =
          draw_lessons(lesson_options_, learner_.parameters(), derive_seed(options_.seed, kWalkPurpose, index));
    });
    if (stopped) return std::nullopt;
    return by_walk;
  }

  // Takes a round's learning steps that are left, unless `stop` says so. The learning rate falls by a cosine from 1 to
  // kLastRate of the first one over the whole training [Loshchilov and Hutter 2017].
  bool learn(std::int64_t round, const std::function<bool()>& stop) {
    std::vector<const Lesson*> picked(static_cast<std::size_t>(options_.batch_size));
    const auto updates = static_cast<double>(options_.updates);
    for (; *updates_ < options_.updates && replay_.size() > 0; ++*updates_) {
      if (stop()) return false;
      for (const Lesson*& lesson : picked) {
        lesson = &replay_.lesson(rng_.below(static_cast<std::uint32_t>(replay_.size())));
      }
      const double done = (static_cast<double>(round) + static_cast<double>(*updates_) / updates) /
                          static_cast<double>(options_.rounds);
      const double rate_share = kLastRate + (1 - kLastRate) * (1 + std::cos(std::numbers::pi * done)) / 2;
      const double loss = learner_.learn(picked, options_.learning_rate * rate_share);
      if (!std::isfinite(loss)) {
        throw NotFinite({.what = fmt::format("the loss is {} at step {} of round {}", loss, *updates_ + 1, round + 1)});
      }
      loss_ += loss / updates;
      regret_ += learner_.regret() / updates;
    }
    return true;
  }

  TrainOptions options_;
  Rng& rng_;
  LessonOptions lesson_options_;
  ExplorerLearner learner_;
  ExplorerReplay replay_;
  std::optional<std::int64_t> updates_;  // learning steps of the round under way; none before its walks are drawn
  // Of the round under way, or the last one.
  double loss_ = 0;
  double regret_ = 0;
};

}  // namespace

std::unique_ptr<Recipe> make_explorer_recipe(const TrainOptions& options, Rng& rng) {
  return std::make_unique<ExplorerRecipe>(options, rng);
}

}  // namespace graphdrl
