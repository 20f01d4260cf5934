#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "graphdrl/base/parallel.h"
#include "graphdrl/train/explorer_learner.h"
#include "graphdrl/train/explorer_replay.h"
#include "graphdrl/train/recipe.h"

namespace graphdrl {
namespace {

constexpr std::uint64_t kWalkPurpose = 1;  // of derive_seed
constexpr double kLastRate = 0.02;         // of the first learning rate, as in docs/explorer.md, "Training"

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

  bool run_unit(TrainingProgress& progress, const std::function<bool()>& /*stop*/) override {
    for (std::vector<Lesson>& of_walk : draw(progress.done)) {
      progress.samples += std::ssize(of_walk);
      for (Lesson& lesson : of_walk) replay_.push(std::move(lesson));
    }
    learn(progress.done);
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
  }

  void restore(const Checkpoint& checkpoint, const TrainingProgress& progress) override {
    learner_.set_state(checkpoint.parameters<ExplorerParameters>("online."),
                       checkpoint.adam(trainable_count(ExplorerParameters::specs())));
    replay_.restore(checkpoint, lesson_options_);
    if (static_cast<std::int64_t>(replay_.size()) != std::min(progress.samples, options_.replay_capacity)) {
      checkpoint.fail("the checkpoint remembers another number of lessons than it has drawn");
    }
  }

  void write_policy(const std::filesystem::path& path) const override {
    write_policy_file(path, learner_.parameters());
  }

 private:
  // The lessons of a round's walks, which the network leads as it is now. The same for any number of threads.
  std::vector<std::vector<Lesson>> draw(std::int64_t round) const {
    std::vector<std::vector<Lesson>> by_walk(static_cast<std::size_t>(options_.walks));
    parallel_for(static_cast<int>(options_.walks), [&](int walk) {
      const auto index = static_cast<std::uint64_t>(round * options_.walks + walk);
      by_walk[walk] =
          draw_lessons(lesson_options_, learner_.parameters(), derive_seed(options_.seed, kWalkPurpose, index));
    });
    return by_walk;
  }

  // Takes a round's learning steps. The learning rate falls by a cosine from 1 to kLastRate of the first one over the
  // whole training [Loshchilov and Hutter 2017].
  void learn(std::int64_t round) {
    loss_ = regret_ = 0;
    std::vector<const Lesson*> picked(static_cast<std::size_t>(options_.batch_size));
    const auto updates = static_cast<double>(options_.updates);
    for (std::int64_t update = 0; update < options_.updates && replay_.size() > 0; ++update) {
      for (const Lesson*& lesson : picked) {
        lesson = &replay_.lesson(rng_.below(static_cast<std::uint32_t>(replay_.size())));
      }
      const double done =
          (static_cast<double>(round) + static_cast<double>(update) / updates) / static_cast<double>(options_.rounds);
      const double rate_share = kLastRate + (1 - kLastRate) * (1 + std::cos(std::numbers::pi * done)) / 2;
      const double loss = learner_.learn(picked, options_.learning_rate * rate_share);
      if (!std::isfinite(loss)) {
        throw std::runtime_error(
            fmt::format("the loss is not finite in round {}: try a smaller --learning-rate", round));
      }
      loss_ += loss / updates;
      regret_ += learner_.regret() / updates;
    }
  }

  TrainOptions options_;
  Rng& rng_;
  LessonOptions lesson_options_;
  ExplorerLearner learner_;
  ExplorerReplay replay_;
  // Of the last round.
  double loss_ = 0;
  double regret_ = 0;
};

}  // namespace

std::unique_ptr<Recipe> make_explorer_recipe(const TrainOptions& options, Rng& rng) {
  return std::make_unique<ExplorerRecipe>(options, rng);
}

}  // namespace graphdrl
