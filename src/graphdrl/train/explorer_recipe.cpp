#include <optional>

#include "graphdrl/train/explorer_learner.h"
#include "graphdrl/train/explorer_replay.h"
#include "graphdrl/train/minibatch.h"
#include "graphdrl/train/round_recipe.h"

namespace graphdrl {
namespace {

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

class ExplorerRecipe final : public RoundRecipe {
 public:
  ExplorerRecipe(const TrainOptions& options, Rng& rng, Ranks& ranks)
      : RoundRecipe(options, ranks),
        rng_(rng),
        lesson_options_(lesson_options(options)),
        learner_(options.ranking, rng_, ranks),
        replay_(static_cast<std::size_t>(options.replay_capacity)) {}

  void save(CheckpointWriter& checkpoint) const override {
    checkpoint.add("online.", learner_.parameters());
    checkpoint.add(learner_.adam());
    replay_.save(checkpoint);
    save_round(checkpoint);
  }

  std::string not_finite() const override { return learner_.parameters().first_not_finite(); }

  void restore(const Checkpoint& checkpoint, const TrainingProgress& progress) override {
    learner_.set_state(checkpoint.parameters<ExplorerParameters>("online."),
                       checkpoint.adam(trainable_count(ExplorerParameters::specs())));
    replay_.restore(checkpoint, lesson_options_);
    restore_round(checkpoint, static_cast<std::int64_t>(replay_.size()), progress);
  }

  void write_policy(const std::filesystem::path& path) const override {
    write_policy_file(path, learner_.parameters());
  }

 private:
  // The lessons of a round's walks, which the network leads as it is now.
  std::optional<std::int64_t> draw(std::int64_t round, const std::function<bool()>& stop) override {
    auto drawn = draw_walks<Lesson>(
        round, stop, lesson_options_.worlds,
        [&](std::uint64_t seed) { return draw_lessons(lesson_options_, learner_.parameters(), seed); },
        [&] { return LessonBytes(lesson_options_); });
    if (!drawn) return std::nullopt;
    const std::int64_t count = std::ssize(*drawn);
    for (Lesson& lesson : *drawn) replay_.push(std::move(lesson));
    return count;
  }

  std::optional<LearningStep> learn(double rate) override {
    if (replay_.size() == 0) return std::nullopt;
    std::vector<const Lesson*> picked(static_cast<std::size_t>(options().batch_size));
    for (const Lesson*& lesson : picked) {
      lesson = &replay_.lesson(rng_.below(static_cast<std::uint32_t>(replay_.size())));
    }
    balance_shards(picked,
                   [](const Lesson* lesson) { return std::min(lesson->scope, lesson->at->world.valid_count()); });
    const double loss = learner_.learn(picked, rate);
    return LearningStep{.loss = loss, .regret = learner_.regret()};
  }

  Rng& rng_;
  LessonOptions lesson_options_;
  ExplorerLearner learner_;
  ExplorerReplay replay_;
};

}  // namespace

std::unique_ptr<Recipe> make_explorer_recipe(const TrainOptions& options, Rng& rng, Ranks& ranks) {
  return std::make_unique<ExplorerRecipe>(options, rng, ranks);
}

}  // namespace graphdrl
