#include "graphdrl/train/paper_recipe.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "graphdrl/base/error.h"
#include "graphdrl/env/budget.h"
#include "graphdrl/env/load_worlds.h"
#include "graphdrl/io/readers.h"
#include "graphdrl/planners/paper_policy.h"
#include "graphdrl/train/paper_epsilon.h"

namespace graphdrl {
namespace {

constexpr const char* kWorldsKey = "worlds";
constexpr const char* kWindowKey = "window";

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

std::size_t largest(const std::vector<World>& worlds) {
  NodeId nodes = 0;
  for (const World& world : worlds) nodes = std::max(nodes, world.node_count());
  return static_cast<std::size_t>(nodes);
}

}  // namespace

PaperRecipe::PaperRecipe(const TrainOptions& options, Rng& rng, std::vector<World> worlds,
                         const LearnerSource& learners)
    : options_(options),
      rng_(rng),
      worlds_(checked(std::move(worlds), options)),
      encoders_(worlds_.begin(), worlds_.end()),
      learner_(learners.make(options.device, learner_options(options), rng_)),
      replay_(static_cast<std::size_t>(options.replay_capacity), largest(worlds_)) {
  for (const World& world : worlds_) episodes_.emplace_back(world, episode_options(options_, world));
}

// The body of Algorithm 1's outer loop, which Trainer::run holds: for episode e = 1 … E
bool PaperRecipe::run_unit(TrainingProgress& progress, const std::function<bool()>& stop) {
  if (!in_episode_) begin_episode();  // construct the initial state s_0
  Episode& episode = episodes_[world_];
  while (!episode.done()) {  // for step t = 1 … T
    if (stop()) {
      take_losses(progress.samples);
      return false;
    }
    const int action = choose_action(progress.done);  //   select a_t following an epsilon-strategy
    const NodeId from = episode.position();
    visits_before_ = episode.visits();
    const StepResult step = episode.step(action);  //   receive r_t and move to s_{t+1}
    remember(action, step, from);                  //   store (s_t, a_t, r_t, s_{t+1}) in M
    learn();                                       //   sample B, update θ, soft update θ'
    ++progress.samples;
  }
  take_losses(progress.samples);
  end_episode();
  return true;
}

void PaperRecipe::begin_episode() {
  const int world = worlds_.size() == 1 ? 0 : static_cast<int>(rng_.below(static_cast<std::uint32_t>(worlds_.size())));
  if (options_.start != kRandomStart) {
    begin_episode_at(world, parse_node(worlds_[world], options_.start, "start"));
    return;
  }
  const auto nodes = worlds_[world].valid_nodes();
  begin_episode_at(world, nodes[rng_.below(static_cast<std::uint32_t>(nodes.size()))]);
}

void PaperRecipe::begin_episode_at(int world, NodeId start) {
  world_ = world;
  episodes_[world].reset(start);
  features_.resize(static_cast<std::size_t>(worlds_[world].node_count()) * kPaperFeatureCount);
  encoders_[world].begin(start, features_);
  actions_.clear();
  episode_reward_ = 0;
  in_episode_ = true;
}

int PaperRecipe::choose_action(std::int64_t episode) {
  if (rng_.uniform() < paper_epsilon(episode, options_.episodes)) {
    return static_cast<int>(rng_.below(kActionCount));
  }
  std::array<float, kActionCount> q{};
  single_.clear();
  single_.add(worlds_[world_].graph());
  learner_->q_values(single_, features_, q);
  return argmax(q);
}

void PaperRecipe::remember(int action, const StepResult& step, NodeId from) {
  const Episode& episode = episodes_[world_];
  replay_.push({.world = world_,
                .position = from,
                .action = action,
                .next_position = episode.position(),
                .reward = static_cast<float>(step.reward),
                .terminal = episode.terminal()},
               visits_before_);
  encoders_[world_].update(from, episode.position(), step, features_);
  actions_.push_back(action);
  episode_reward_ += step.reward;
}

void PaperRecipe::learn() {
  if (replay_.size() <= static_cast<std::size_t>(options_.batch_size)) return;
  sample_minibatch(replay_, encoders_, options_.batch_size, rng_, minibatch_);
  learner_->learn(minibatch_, rng_);
}

// Adds the losses since the last call to the window. last_step: the number of the last of them.
void PaperRecipe::take_losses(std::int64_t last_step) {
  const std::vector<double> losses = learner_->take_losses();
  for (std::size_t i = 0; i < losses.size(); ++i) {
    if (!std::isfinite(losses[i])) {
      throw std::runtime_error(fmt::format("the loss is not finite at step {}: try a smaller --learning-rate",
                                           last_step - std::ssize(losses) + 1 + static_cast<std::int64_t>(i)));
    }
    window_.loss += losses[i];
    ++window_.losses;
  }
}

void PaperRecipe::end_episode() {
  const Episode& episode = episodes_[world_];
  ++window_.episodes;
  window_.visited += episode.visited_count();
  window_.coverage += 100.0 * episode.coverage();
  window_.reward += episode_reward_;
  in_episode_ = false;
}

double PaperRecipe::Window::mean_loss() const {
  return losses > 0 ? loss / static_cast<double>(losses) : NAN;
}

std::string PaperRecipe::status(const TrainingProgress& progress) const {
  const double loss = window_.mean_loss();
  return fmt::format("coverage {:.1f} %  reward {:.2f}  loss {}  eps {:.3f}", window_.mean(window_.coverage),
                     window_.mean(window_.reward), std::isnan(loss) ? "-" : fmt::format("{:.4f}", loss),
                     paper_epsilon(progress.done - 1, options_.episodes));
}

std::vector<Metric> PaperRecipe::take_metrics(const TrainingProgress& progress) {
  if (window_.episodes < kLogEvery && progress.done < options_.episodes) return {};
  const Window window = window_;
  window_ = {};
  return {{"steps", static_cast<double>(progress.samples), /*curve=*/false},
          {"epsilon", paper_epsilon(progress.done - 1, options_.episodes)},
          {"loss", window.mean_loss()},
          {"visited_nodes", window.mean(window.visited)},
          {"coverage", window.mean(window.coverage), /*curve=*/false},
          {"reward", window.mean(window.reward)}};
}

// For saving and restoring.
template <typename AnyWindow, typename Field>
void PaperRecipe::for_each_window_field(AnyWindow& window, const Field& field) {
  field("episodes", window.episodes);
  field("losses", window.losses);
  field("loss", window.loss);
  field("visited", window.visited);
  field("coverage", window.coverage);
  field("reward", window.reward);
}

void PaperRecipe::save(CheckpointWriter& checkpoint) const {
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
  nlohmann::ordered_json window;
  for_each_window_field(window_, [&](const char* key, const auto& value) { window[key] = value; });
  checkpoint.add_json(kWindowKey, window);
  auto worlds = nlohmann::ordered_json::array();
  for (const World& world : worlds_)
    worlds.push_back({{"name", world.name()}, {"map", format_ascii_map(*world.map())}});
  checkpoint.add_json(kWorldsKey, worlds);
}

std::vector<World> worlds_of(const Checkpoint& checkpoint) {
  const auto json = checkpoint.json(kWorldsKey);
  if (!json.is_array() || json.empty()) checkpoint.fail("the checkpoint holds no maps");
  std::vector<World> worlds;
  for (const auto& item : json) {
    if (!item.is_object() || !item.contains("name") || !item["name"].is_string() || !item.contains("map") ||
        !item["map"].is_string()) {
      checkpoint.fail("the checkpoint holds no maps");
    }
    worlds.emplace_back(item["name"].get<std::string>(),
                        parse_ascii_map(item["map"].get<std::string>(), checkpoint.source()));
  }
  return worlds;
}

void PaperRecipe::restore(const Checkpoint& checkpoint, const TrainingProgress& progress) {
  const auto window = checkpoint.json(kWindowKey);
  for_each_window_field(window_, [&](const char* key, auto& value) { checkpoint.read_number(window, key, value); });
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

void PaperRecipe::restore_episode(const Checkpoint& checkpoint) {
  const auto stored = checkpoint.get<std::int32_t>("episode");
  if (stored.empty()) return;
  const auto fail = [&] { checkpoint.fail("the episode under way cannot be walked"); };
  if (stored.size() < 2 || stored[0] < 0 || stored[0] >= std::ssize(worlds_)) fail();
  begin_episode_at(stored[0], stored[1]);
  Episode& episode = episodes_[world_];
  for (const std::int32_t action : std::span(stored).subspan(2)) {
    if (action < 0 || action >= kActionCount || episode.done()) fail();
    const NodeId from = episode.position();
    const StepResult step = episode.step(action);
    encoders_[world_].update(from, episode.position(), step, features_);
    actions_.push_back(action);
    episode_reward_ += step.reward;
  }
}

void PaperRecipe::write_policy(const std::filesystem::path& path) const {
  write_policy_file(path, learner_->state().online);
}

}  // namespace graphdrl
