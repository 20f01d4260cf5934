#include "graphdrl/train/explorer_recipe.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

#include "graphdrl/base/parallel.h"
#include "graphdrl/train/explorer_worlds.h"

namespace graphdrl {
namespace {

constexpr std::uint64_t kWalkPurpose = 1;  // of derive_seed
constexpr double kLastRate = 0.02;         // of the first learning rate, as in docs/explorer.md, "Training"

// A cosine from 1 to kLastRate over the whole training [Loshchilov and Hutter 2017].
double rate_share(double done) {
  return kLastRate + (1 - kLastRate) * (1 + std::cos(std::numbers::pi * done)) / 2;
}

std::uint64_t walk_seed(const TrainOptions& options, std::int64_t walk) {
  return derive_seed(options.seed, kWalkPurpose, static_cast<std::uint64_t>(walk));
}

LessonOptions lesson_options(const TrainOptions& options) {
  LessonOptions lessons;
  lessons.worlds = training_worlds(static_cast<int>(options.largest));
  lessons.teacher_steps = static_cast<int>(options.teacher_steps);
  lessons.lead = options.lead;
  return lessons;
}

}  // namespace

ExplorerRecipe::ExplorerRecipe(const TrainOptions& options, Rng& rng)
    : options_(options),
      rng_(rng),
      lesson_options_(lesson_options(options)),
      learner_(options.ranking, rng_),
      replay_(static_cast<std::size_t>(options.replay_capacity)) {}

bool ExplorerRecipe::run_unit(TrainingProgress& progress, const std::function<bool()>& /*stop*/) {
  std::vector<Lesson> lessons = draw(progress.done);
  progress.samples += std::ssize(lessons);
  learn(progress.done, std::move(lessons));
  return true;
}

std::vector<Lesson> ExplorerRecipe::draw(std::int64_t round) const {
  const int walks = static_cast<int>(options_.walks);
  std::vector<std::vector<Lesson>> by_walk(static_cast<std::size_t>(walks));
  parallel_for(walks, [&](int walk) {
    by_walk[walk] = draw_lessons(lesson_options_, learner_.parameters(), walk_seed(options_, round * walks + walk));
  });
  std::vector<Lesson> lessons;
  for (std::vector<Lesson>& of_walk : by_walk) std::move(of_walk.begin(), of_walk.end(), std::back_inserter(lessons));
  return lessons;
}

void ExplorerRecipe::learn(std::int64_t round, std::vector<Lesson> lessons) {
  for (Lesson& lesson : lessons) replay_.push(std::move(lesson));
  loss_ = regret_ = 0;
  std::vector<const Lesson*> picked(static_cast<std::size_t>(options_.batch_size));
  const auto updates = static_cast<double>(options_.updates);
  for (std::int64_t update = 0; update < options_.updates && replay_.size() > 0; ++update) {
    for (const Lesson*& lesson : picked) {
      lesson = &replay_.lesson(rng_.below(static_cast<std::uint32_t>(replay_.size())));
    }
    const double done =
        (static_cast<double>(round) + static_cast<double>(update) / updates) / static_cast<double>(options_.rounds);
    const double loss = learner_.learn(picked, options_.learning_rate * rate_share(done));
    if (!std::isfinite(loss)) {
      throw std::runtime_error(fmt::format("the loss is not finite in round {}: try a smaller --learning-rate", round));
    }
    loss_ += loss / updates;
    regret_ += learner_.regret() / updates;
  }
}

std::string ExplorerRecipe::status(const TrainingProgress& progress) const {
  return fmt::format("{} states  loss {:.4f}  regret {:.4f}", progress.samples, loss_, regret_);
}

std::vector<Metric> ExplorerRecipe::take_metrics(const TrainingProgress& progress) {
  return {{"states", static_cast<double>(progress.samples)}, {"loss", loss_}, {"regret", regret_}};
}

void ExplorerRecipe::save(CheckpointWriter& checkpoint) const {
  checkpoint.add("online.", learner_.parameters());
  checkpoint.add(learner_.adam());
  replay_.save(checkpoint);
}

void ExplorerRecipe::restore(const Checkpoint& checkpoint, const TrainingProgress& progress) {
  learner_.set_state(checkpoint.parameters<ExplorerParameters>("online."),
                     checkpoint.adam(trainable_count(ExplorerParameters::specs())));
  replay_.restore(checkpoint, lesson_options_);
  if (static_cast<std::int64_t>(replay_.size()) != std::min(progress.samples, options_.replay_capacity)) {
    checkpoint.fail("the checkpoint remembers another number of lessons than it has drawn");
  }
}

void ExplorerRecipe::write_policy(const std::filesystem::path& path) const {
  write_policy_file(path, learner_.parameters());
}

}  // namespace graphdrl
