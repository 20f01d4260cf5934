#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "graphdrl/base/error.h"
#include "graphdrl/env/episode.h"
#include "graphdrl/env/load_worlds.h"
#include "graphdrl/env/task.h"
#include "graphdrl/io/readers.h"
#include "graphdrl/planners/paper_policy.h"
#include "graphdrl/train/paper_replay_buffer.h"
#include "graphdrl/train/recipe.h"

namespace graphdrl {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kWorldsKey = "worlds";
constexpr const char* kWindowKey = "window";
constexpr std::int64_t kLogEvery = 10;  // episodes: the paper's figure 2

EpisodeOptions episode_options(const TrainOptions& options, const World& world) {
  return {.budget = Budget::parse(options.budget).cost_in(world),
          .action_space = ActionSpace::kDirections,
          .reward = options.reward == "coverage_gain" ? RewardKind::kCoverageGain : RewardKind::kVisitPenalty,
          .end_at_full_coverage = options.end_at_full_coverage,
          .punish_blocked_by_visits = options.punish_blocked_by_visits};
}

PaperLearnerOptions learner_options(const TrainOptions& options) {
  return {.double_dqn = options.algorithm == "double_dqn",
          .discount = options.discount,
          .learning_rate = options.learning_rate,
          .soft_update = options.soft_update,
          .dropout = options.dropout,
          .tf32 = options.precision == "tf32"};
}

// The worlds themselves. Throws Error where one does not fit the options.
std::vector<World> checked(std::vector<World> worlds, const TrainOptions& options) {
  for (const World& world : worlds) {
    const double budget = episode_options(options, world).budget;
    if (budget < 1 || budget > kMaxReplayBudget) {
      throw Error({.what = "budget out of range for training",
                   .expected = fmt::format("1 to {} steps", kMaxReplayBudget),
                   .got = fmt::format("{:g}", budget),
                   .where = world.name()});
    }
    if (options.start != kRandomStart) parse_node(world, options.start, "start");
  }
  return worlds;
}

// Sums over the episodes since the last line of metrics.
struct Window {
  std::int64_t episodes = 0;
  std::int64_t losses = 0;
  double loss = 0;
  double visited = 0;
  double coverage = 0;  // percent
  double reward = 0;

  // Not a number before learning starts.
  double mean_loss() const { return losses > 0 ? loss / static_cast<double>(losses) : NAN; }
  double mean(double sum) const { return sum / static_cast<double>(episodes); }

  // Calls field(key, value) for each: for saving and restoring.
  template <typename Field>
  void for_each(const Field& field) {
    field("episodes", episodes);
    field("losses", losses);
    field("loss", loss);
    field("visited", visited);
    field("coverage", coverage);
    field("reward", reward);
  }
};

class PaperRecipe final : public Recipe {
 public:
  PaperRecipe(const TrainOptions& options, Rng& rng, std::vector<World> worlds, const LearnerSource& learners)
      : options_(options),
        rng_(rng),
        worlds_(checked(std::move(worlds), options)),
        encoders_(worlds_.begin(), worlds_.end()),
        learner_(learners.make(options.device, learner_options(options), rng_)),
        replay_(static_cast<std::size_t>(options.replay_capacity),
                static_cast<std::size_t>(std::ranges::max_element(worlds_, {}, &World::node_count)->node_count())) {
    for (const World& world : worlds_) episodes_.emplace_back(world, episode_options(options_, world));
  }

  // The body of Algorithm 1's outer loop, which Trainer::run holds: for episode e = 1 … E
  bool run_unit(TrainingProgress& progress, const std::function<bool()>& stop) override {
    if (!in_episode_) begin_episode();  // construct the initial state s_0
    const Episode& episode = episodes_[world_];
    while (!episode.done()) {  // for step t = 1 … T
      if (stop()) {
        take_losses(progress.samples);
        return false;
      }
      const int action = choose_action(progress.done);  //   select a_t following an epsilon-strategy
      const NodeId from = episode.position();
      visits_before_ = episode.visits();
      const double reward = take(action);  //   receive r_t and move to s_{t+1}
      replay_.push({.world = world_,       //   store (s_t, a_t, r_t, s_{t+1}) in M
                    .position = from,
                    .action = action,
                    .next_position = episode.position(),
                    .reward = static_cast<float>(reward),
                    .terminal = episode.terminal()},
                   visits_before_);
      learn();  //   sample B, update θ, soft update θ'
      ++progress.samples;
      // A device would wait for them.
      if (options_.device == "cpu") take_losses(progress.samples);
    }
    take_losses(progress.samples);
    ++window_.episodes;
    window_.visited += episode.visited_count();
    window_.coverage += 100.0 * episode.coverage();
    window_.reward += episode_reward_;
    in_episode_ = false;
    return true;
  }

  std::string not_finite() const override { return learner_->state().online.first_not_finite(); }

  std::string status(const TrainingProgress& progress) const override {
    const double loss = window_.mean_loss();
    return fmt::format("coverage {:.1f} %  reward {:.2f}  loss {}  eps {:.3f}", window_.mean(window_.coverage),
                       window_.mean(window_.reward), std::isnan(loss) ? "-" : fmt::format("{:.4f}", loss),
                       paper_epsilon(progress.done - 1, options_.episodes));
  }

  std::vector<Metric> take_metrics(const TrainingProgress& progress) override {
    if (window_.episodes < kLogEvery && progress.done < options_.episodes) return {};
    const Window window = std::exchange(window_, {});
    return {{"steps", static_cast<double>(progress.samples), /*curve=*/false},
            {"epsilon", paper_epsilon(progress.done - 1, options_.episodes)},
            {"loss", window.mean_loss()},
            {"visited_nodes", window.mean(window.visited)},
            {"coverage", window.mean(window.coverage), /*curve=*/false},
            {"reward", window.mean(window.reward)}};
  }

  void save(CheckpointWriter& checkpoint) const override {
    PaperState learned = learner_->state();
    checkpoint.add("online.", std::move(learned.online));
    checkpoint.add("target.", std::move(learned.target));
    checkpoint.add(std::move(learned.adam));
    replay_.save(checkpoint);
    // An episode under way is stored as its start and its actions, and walked again when restored.
    std::vector<std::int32_t> episode;
    if (in_episode_) {
      episode = {world_, episodes_[world_].walk().front()};
      episode.insert(episode.end(), actions_.begin(), actions_.end());
    }
    checkpoint.add("episode", std::move(episode));
    Json window;
    Window(window_).for_each([&](const char* key, const auto& value) { window[key] = value; });
    checkpoint.add_json(kWindowKey, window);
    auto worlds = Json::array();
    for (const World& world : worlds_) {
      worlds.push_back({{"name", world.name()}, {"map", format_ascii_map(*world.map())}});
    }
    checkpoint.add_json(kWorldsKey, worlds);
  }

  void restore(const Checkpoint& checkpoint, const TrainingProgress& progress) override {
    const Json window = checkpoint.json(kWindowKey);
    window_.for_each([&](const char* key, auto& value) { checkpoint.read_number(window, key, value); });
    if (window_.episodes > progress.done) checkpoint.fail("the metrics under way are of more episodes than are done");
    learner_->set_state({.online = checkpoint.parameters<PaperParameters>("online."),
                         .target = checkpoint.parameters<PaperParameters>("target."),
                         .adam = checkpoint.adam(PaperParameters::trainable_count())});
    replay_.restore(checkpoint, [&](const Transition& t) {
      if (t.world < 0 || t.world >= std::ssize(worlds_)) return false;
      const auto inside = [&](NodeId node) { return node >= 0 && node < worlds_[t.world].node_count(); };
      return inside(t.position) && inside(t.next_position) && t.action >= 0 && t.action < kActionCount;
    });
    restore_episode(checkpoint);
  }

  void write_policy(const std::filesystem::path& path) const override {
    write_policy_file(path, learner_->state().online);
  }

 private:
  void begin_episode() {
    const auto below = [&](auto size) { return static_cast<int>(rng_.below(static_cast<std::uint32_t>(size))); };
    const int world = worlds_.size() == 1 ? 0 : below(worlds_.size());
    const auto nodes = worlds_[world].valid_nodes();
    begin_episode_at(world, options_.start == kRandomStart ? nodes[below(nodes.size())]
                                                           : parse_node(worlds_[world], options_.start, "start"));
  }

  void begin_episode_at(int world, NodeId start) {
    world_ = world;
    episodes_[world].reset(start);
    features_.resize(static_cast<std::size_t>(worlds_[world].node_count()) * kPaperFeatureCount);
    encoders_[world].begin(start, features_);
    actions_.clear();
    episode_reward_ = 0;
    in_episode_ = true;
  }

  int choose_action(std::int64_t episode) {
    if (rng_.uniform() < paper_epsilon(episode, options_.episodes)) return static_cast<int>(rng_.below(kActionCount));
    std::array<float, kActionCount> q{};
    single_.clear();
    single_.add(worlds_[world_].graph());
    learner_->q_values(single_, features_, q);
    return argmax(q);
  }

  // Takes an action in the episode under way; gives the reward.
  double take(int action) {
    Episode& episode = episodes_[world_];
    const NodeId from = episode.position();
    const StepResult step = episode.step(action);
    encoders_[world_].update(from, episode.position(), step, features_);
    actions_.push_back(action);
    episode_reward_ += step.reward;
    return step.reward;
  }

  void learn() {
    if (replay_.size() <= static_cast<std::size_t>(options_.batch_size)) return;
    sample_minibatch(replay_, encoders_, options_.batch_size, rng_, minibatch_);
    learner_->learn(minibatch_, rng_);
  }

  // Adds the losses since the last call to the window. last_step: the number of the last of them.
  void take_losses(std::int64_t last_step) {
    const std::vector<double> losses = learner_->take_losses();
    for (std::size_t i = 0; i < losses.size(); ++i) {
      if (!std::isfinite(losses[i])) {
        const std::int64_t step = last_step - std::ssize(losses) + 1 + static_cast<std::int64_t>(i);
        throw NotFinite({.what = fmt::format("the loss is {} at step {}", losses[i], step)});
      }
      window_.loss += losses[i];
      ++window_.losses;
    }
  }

  void restore_episode(const Checkpoint& checkpoint) {
    const auto stored = checkpoint.get<std::int32_t>("episode");
    if (stored.empty()) return;
    const auto fail = [&] { checkpoint.fail("the episode under way cannot be walked"); };
    if (stored.size() < 2 || stored[0] < 0 || stored[0] >= std::ssize(worlds_)) fail();
    begin_episode_at(stored[0], stored[1]);
    for (const std::int32_t action : std::span(stored).subspan(2)) {
      if (action < 0 || action >= kActionCount || episodes_[world_].done()) fail();
      take(action);
    }
  }

  TrainOptions options_;
  Rng& rng_;
  std::vector<World> worlds_;
  std::vector<PaperFeatureEncoder> encoders_;  // of the worlds
  std::vector<Episode> episodes_;              // one per world, reset again and again
  std::unique_ptr<PaperLearner> learner_;
  PaperReplayBuffer replay_;
  Window window_;

  // The episode under way.
  bool in_episode_ = false;
  int world_ = 0;
  std::vector<std::int32_t> actions_;  // so far
  double episode_reward_ = 0;

  std::vector<float> features_;               // of the current state, kept up to date: [N, F]
  std::vector<std::uint32_t> visits_before_;  // the step under way
  GraphBatch single_;
  PaperMinibatch minibatch_;
};

}  // namespace

double paper_epsilon(std::int64_t episode, std::int64_t episodes) {
  constexpr double kFirst = 0.1;
  constexpr double kLast = 3.0;
  if (episodes == 1) return std::exp(-kFirst);
  return std::exp(-(kFirst + (kLast - kFirst) * static_cast<double>(episode) / static_cast<double>(episodes - 1)));
}

std::unique_ptr<Recipe> make_paper_recipe(const TrainOptions& options, Rng& rng, std::vector<World> worlds,
                                          const LearnerSource& learners) {
  return std::make_unique<PaperRecipe>(options, rng, std::move(worlds), learners);
}

std::vector<World> worlds_of(const Checkpoint& checkpoint) {
  const auto require = [&](bool good) {
    if (!good) checkpoint.fail("the checkpoint holds no maps");
  };
  const Json json = checkpoint.json(kWorldsKey);
  require(json.is_array() && !json.empty());
  std::vector<World> worlds;
  for (const Json& item : json) {
    for (const char* const key : {"name", "map"})
      require(item.is_object() && item.contains(key) && item[key].is_string());
    worlds.emplace_back(item["name"].get<std::string>(),
                        parse_ascii_map(item["map"].get<std::string>(), checkpoint.source()));
  }
  return worlds;
}

}  // namespace graphdrl
