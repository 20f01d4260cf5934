#include "graphdrl/train/round_recipe.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <numeric>

namespace graphdrl {
namespace {

constexpr std::uint64_t kWalkPurpose = 1;  // of derive_seed
constexpr const char* kRoundKey = "round";
constexpr std::int64_t kStepsPerQuestion = 16;  // of many ranks, whether to stop: asking each other takes time
constexpr double kLastRate = 0.02;              // of the first learning rate, as in docs/explorer.md, "Training"

}  // namespace

bool RoundRecipe::run_unit(TrainingProgress& progress, const std::function<bool()>& stop) {
  if (!updates_) {
    const auto drawn = draw(progress.done, stop);
    if (!drawn) return false;
    progress.samples += *drawn;
    updates_ = 0;
    loss_ = regret_ = 0;
  }
  if (!take_steps(progress.done, stop)) return false;
  updates_.reset();
  return true;
}

std::string RoundRecipe::status(const TrainingProgress& progress) const {
  return fmt::format("{} states  loss {:.4f}  regret {:.4f}", progress.samples, loss_, regret_);
}

std::vector<Metric> RoundRecipe::take_metrics(const TrainingProgress& progress) {
  return {{"states", static_cast<double>(progress.samples)}, {"loss", loss_}, {"regret", regret_}};
}

void RoundRecipe::save_round(CheckpointWriter& checkpoint) const {
  if (updates_) checkpoint.add_json(kRoundKey, {{"updates", *updates_}, {"loss", loss_}, {"regret", regret_}});
}

void RoundRecipe::restore_round(const Checkpoint& checkpoint, std::int64_t remembered,
                                const TrainingProgress& progress) {
  if (remembered != std::min(progress.samples, options_.replay_capacity)) {
    checkpoint.fail("the checkpoint remembers another number of lessons than it has drawn");
  }
  if (!checkpoint.has_json(kRoundKey)) return;
  const nlohmann::ordered_json round = checkpoint.json(kRoundKey);
  checkpoint.read_number(round, "updates", updates_.emplace());
  checkpoint.read_number(round, "loss", loss_);
  checkpoint.read_number(round, "regret", regret_);
}

std::uint64_t RoundRecipe::seed_of(std::int64_t round, int walk) const {
  return derive_seed(options_.seed, kWalkPurpose, static_cast<std::uint64_t>(round * options_.walks + walk));
}

// A round's walks: at its end all wait for the last one, which should be short.
std::vector<int> RoundRecipe::largest_first(std::int64_t round, const std::vector<WorldSpec>& worlds) const {
  std::vector<int> order(static_cast<std::size_t>(options_.walks));
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, std::ranges::greater(),
                           [&](int walk) { return worlds[seed_of(round, walk) % worlds.size()].most_nodes(); });
  return order;
}

// Takes a round's learning steps that are left, unless `stop` says so. The learning rate falls by a cosine from 1 to
// kLastRate of the first one over the whole training [Loshchilov and Hutter 2017].
bool RoundRecipe::take_steps(std::int64_t round, const std::function<bool()>& stop) {
  const auto updates = static_cast<double>(options_.updates);
  for (; *updates_ < options_.updates; ++*updates_) {
    const bool asks = ranks_.alone() || *updates_ % kStepsPerQuestion == 0;
    if (asks && ranks_.any(stop())) return false;
    const double done =
        (static_cast<double>(round) + static_cast<double>(*updates_) / updates) / static_cast<double>(options_.rounds);
    const double rate_share = kLastRate + (1 - kLastRate) * (1 + std::cos(std::numbers::pi * done)) / 2;
    const auto step = learn(options_.learning_rate * rate_share);
    if (!step) break;
    if (!std::isfinite(step->loss)) {
      throw NotFinite(
          {.what = fmt::format("the loss is {} at step {} of round {}", step->loss, *updates_ + 1, round + 1)});
    }
    loss_ += step->loss / updates;
    regret_ += step->regret / updates;
  }
  return true;
}

}  // namespace graphdrl
