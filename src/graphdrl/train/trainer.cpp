#include "graphdrl/train/trainer.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "graphdrl/base/error.h"
#include "graphdrl/env/load_worlds.h"
#include "graphdrl/planners/paper_policy.h"
#include "graphdrl/train/epsilon_schedule.h"

namespace graphdrl {
namespace {

// Throws Error where a world does not fit the options.
void check_worlds(const std::vector<World>& worlds, const TrainOptions& options) {
  for (const World& world : worlds) {
    const double budget = episode_options(options, world).budget;
    if (budget < 1 || budget > kMaxReplayBudget) {
      throw Error({.what = "budget out of range for training",
                   .expected = fmt::format("1 to {} steps", kMaxReplayBudget),
                   .got = fmt::format("{:g}", budget),
                   .where = world.name()});
    }
    if (options.start != kRandomStart) parse_start(world, options.start);
  }
}

std::size_t largest(const std::vector<World>& worlds) {
  NodeId nodes = 0;
  for (const World& world : worlds) nodes = std::max(nodes, world.graph().node_count());
  return static_cast<std::size_t>(nodes);
}

LearnerOptions learner_options(const TrainOptions& options) {
  return {.double_dqn = options.algorithm == "double_dqn",
          .discount = options.discount,
          .learning_rate = options.learning_rate,
          .soft_update = options.soft_update,
          .dropout = options.dropout};
}

}  // namespace

Trainer::Trainer(const TrainOptions& options, RunDirectory run, std::vector<World> worlds)
    : options_(options),
      run_(std::move(run)),
      worlds_(std::move(worlds)),
      encoders_(worlds_.begin(), worlds_.end()),
      rng_(options.seed),
      learner_(make_learner(options.device, learner_options(options), rng_)),
      replay_(static_cast<std::size_t>(options.replay_capacity), largest(worlds_)) {
  for (const World& world : worlds_) episodes_.emplace_back(world, episode_options(options_, world));
}

std::unique_ptr<Trainer> Trainer::start(const TrainOptions& options, const RunDirectory& run) {
  validate(options);
  std::vector<World> worlds = load_worlds(options.maps);
  check_worlds(worlds, options);
  std::unique_ptr<Trainer> trainer(new Trainer(options, run, std::move(worlds)));
  run.create();
  write_config(run.config(), options);
  trainer->save();
  return trainer;
}

std::unique_ptr<Trainer> Trainer::resume(const RunDirectory& run) {
  const TrainOptions options = read_config(run.config());
  const Safetensors checkpoint = Safetensors::read(run.checkpoint());
  std::vector<World> worlds = unpack_worlds(checkpoint);
  check_worlds(worlds, options);
  std::unique_ptr<Trainer> trainer(new Trainer(options, run, std::move(worlds)));
  trainer->restore(checkpoint);
  return trainer;
}

bool Trainer::run(const std::function<bool()>& stop, ProgressDisplay& display) {
  const std::int64_t steps_before = progress_.steps;
  const double elapsed_before_s = progress_.elapsed_s;
  const auto start = std::chrono::steady_clock::now();
  const auto update_clock = [&] {
    const std::chrono::duration<double> session = std::chrono::steady_clock::now() - start;
    progress_.elapsed_s = elapsed_before_s + session.count();
  };
  MetricsFile metrics(run_.metrics(), "episode", progress_.episode);
  EventWriter events(run_.path(), progress_.episode + 1);
  while (progress_.episode < options_.episodes) {  // for episode e = 1 … E
    if (!in_episode_) begin_episode();             //   construct the initial state s_0
    Episode& episode = episodes_[world_];
    while (!episode.done() && !stop()) {   //   for step t = 1 … T
      const int action = choose_action();  //     select a_t following an epsilon-strategy
      const NodeId from = episode.position();
      visits_before_ = episode.visits();
      const StepResult step = episode.step(action);  //     receive r_t and move to s_{t+1}
      remember(action, step, from);                  //     store (s_t, a_t, r_t, s_{t+1}) in M
      learn();                                       //     sample B, update θ, soft update θ'
    }
    if (!episode.done()) break;
    end_episode();
    const bool last = progress_.episode == options_.episodes;
    const MetricsLine line = window_means();
    const double session_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    display.show(progress_.episode, options_.episodes,
                 fmt::format("coverage {:.1f} %  reward {:.2f}  loss {}  eps {:.3f}  {:.0f} steps/s", line.coverage,
                             line.reward, std::isnan(line.loss) ? "-" : fmt::format("{:.4f}", line.loss), line.epsilon,
                             static_cast<double>(progress_.steps - steps_before) / std::max(session_s, 1e-9)),
                 last);
    if (progress_.window_episodes == kLogEvery || last) log(line, metrics, events);
    if (progress_.episode % options_.checkpoint_every == 0 && !last) {
      update_clock();
      save();
    }
  }
  display.finish();
  update_clock();
  save();
  return progress_.episode == options_.episodes;
}

void Trainer::begin_episode() {
  const int world = worlds_.size() == 1 ? 0 : static_cast<int>(rng_.below(static_cast<std::uint32_t>(worlds_.size())));
  if (options_.start != kRandomStart) {
    begin_episode_at(world, parse_start(worlds_[world], options_.start));
    return;
  }
  const auto nodes = worlds_[world].valid_nodes();
  begin_episode_at(world, nodes[rng_.below(static_cast<std::uint32_t>(nodes.size()))]);
}

void Trainer::begin_episode_at(int world, NodeId start) {
  world_ = world;
  episodes_[world].reset(start);
  features_.resize(static_cast<std::size_t>(worlds_[world].graph().node_count()) * kPaperFeatureCount);
  encoders_[world].begin(start, features_);
  actions_.clear();
  episode_reward_ = 0;
  in_episode_ = true;
}

int Trainer::choose_action() {
  if (rng_.uniform() < epsilon_at(progress_.episode, options_.episodes)) {
    return static_cast<int>(rng_.below(kActionCount));
  }
  std::array<float, kActionCount> q{};
  single_.clear();
  single_.add(worlds_[world_].graph());
  learner_->q_values(single_, features_, q);
  return argmax(q);
}

void Trainer::remember(int action, const StepResult& step, NodeId from) {
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
  ++progress_.steps;
}

void Trainer::learn() {
  if (replay_.size() <= static_cast<std::size_t>(options_.batch_size)) return;
  sample_minibatch(replay_, encoders_, options_.batch_size, rng_, minibatch_);
  const double loss = learner_->learn(minibatch_, rng_);
  if (!std::isfinite(loss)) {
    throw std::runtime_error(
        fmt::format("the loss is not finite at step {}: try a smaller --learning-rate", progress_.steps));
  }
  progress_.window_loss += loss;
  ++progress_.window_losses;
}

void Trainer::end_episode() {
  const Episode& episode = episodes_[world_];
  ++progress_.episode;
  ++progress_.window_episodes;
  progress_.window_visited += episode.visited_count();
  progress_.window_coverage += 100.0 * episode.coverage();
  progress_.window_reward += episode_reward_;
  in_episode_ = false;
}

MetricsLine Trainer::window_means() const {
  const auto episodes = static_cast<double>(progress_.window_episodes);
  return {
      .episode = progress_.episode,
      .steps = progress_.steps,
      .epsilon = epsilon_at(progress_.episode - 1, options_.episodes),
      .loss = progress_.window_losses > 0 ? progress_.window_loss / static_cast<double>(progress_.window_losses) : NAN,
      .visited_nodes = progress_.window_visited / episodes,
      .coverage = progress_.window_coverage / episodes,
      .reward = progress_.window_reward / episodes};
}

void Trainer::log(const MetricsLine& line, MetricsFile& metrics, EventWriter& events) {
  metrics.write(line.episode, std::vector<Scalar>{{"steps", static_cast<double>(line.steps)},
                                                  {"epsilon", line.epsilon},
                                                  {"loss", line.loss},
                                                  {"visited_nodes", line.visited_nodes},
                                                  {"coverage", line.coverage},
                                                  {"reward", line.reward}});
  std::vector<Scalar> scalars = {
      {"epsilon", line.epsilon}, {"visited_nodes", line.visited_nodes}, {"reward", line.reward}};
  if (!std::isnan(line.loss)) scalars.push_back({"loss", line.loss});
  events.write(line.episode, scalars);
  progress_.window_episodes = 0;
  progress_.window_losses = 0;
  progress_.window_loss = progress_.window_visited = progress_.window_coverage = progress_.window_reward = 0;
}

}  // namespace graphdrl
