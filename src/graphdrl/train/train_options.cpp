#include "graphdrl/train/train_options.h"

#include "graphdrl/train/option_table.h"

namespace graphdrl {
void validate(const TrainOptions& options) {
  constexpr std::int64_t kMany = 1'000'000'000;
  check_choice("--preset", options.preset, {"paper"});
  check_choice("--reward", options.reward, {"visit_penalty", "coverage_gain"});
  check_choice("--algorithm", options.algorithm, {"dqn", "double_dqn"});
  check_choice("--device", options.device, {"cpu", "cuda"});
  check_range<std::int64_t>("--episodes", options.episodes, 1, kMany);
  check_range<std::int64_t>("--batch-size", options.batch_size, 1, 65'536);
  check_range<std::int64_t>("--replay-capacity", options.replay_capacity, options.batch_size + 1, kMany);
  check_range<std::int64_t>("--checkpoint-every", options.checkpoint_every, 1, kMany);
  check_range("--discount", options.discount, 0.0, 1.0);
  check_range("--learning-rate", options.learning_rate, 0.0, 1e3);
  check_range("--soft-update", options.soft_update, 0.0, 1.0);
  check_range("--dropout", options.dropout, 0.0, 0.99);
  Budget::parse(options.budget);
  if (options.punish_blocked_by_visits && options.reward != "visit_penalty") {
    throw Error({.what = "only the reward visit_penalty punishes anything", .where = "--punish-blocked-by-visits"});
  }
  if (options.maps.empty()) throw Error({.what = "no maps to train on", .where = "--maps"});
}

EpisodeOptions episode_options(const TrainOptions& options, const World& world) {
  return {.budget = Budget::parse(options.budget).cost_in(world),
          .action_space = ActionSpace::kDirections,
          .reward = options.reward == "coverage_gain" ? RewardKind::kCoverageGain : RewardKind::kVisitPenalty,
          .end_at_full_coverage = options.end_at_full_coverage,
          .punish_blocked_by_visits = options.punish_blocked_by_visits};
}

void write_config(const std::filesystem::path& path, const TrainOptions& options) {
  OptionWriter writer;
  for_each_field(options, writer);
  writer.write(path);
}

TrainOptions read_config(const std::filesystem::path& path) {
  OptionReader reader(path);
  TrainOptions options;
  for_each_field(options, reader);
  reader.finish();
  validate(options);
  return options;
}

}  // namespace graphdrl
