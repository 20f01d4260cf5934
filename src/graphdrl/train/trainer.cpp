#include "graphdrl/train/trainer.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>

#include "graphdrl/base/error.h"
#include "graphdrl/io/map_source.h"
#include "graphdrl/planners/network_policy.h"
#include "graphdrl/train/epsilon_schedule.h"

namespace graphdrl {
namespace {

constexpr const char* kProgressKey = "progress";

// The one table of TrainingProgress, for saving and restoring.
template <typename Progress, typename Field>
void for_each_progress_field(Progress& progress, const Field& field) {
  field("episode", progress.episode);
  field("steps", progress.steps);
  field("elapsed_s", progress.elapsed_s);
  field("window_episodes", progress.window_episodes);
  field("window_losses", progress.window_losses);
  field("window_loss", progress.window_loss);
  field("window_visited", progress.window_visited);
  field("window_coverage", progress.window_coverage);
  field("window_reward", progress.window_reward);
}

std::vector<World> load_worlds(const TrainOptions& options) {
  validate(options);
  std::vector<World> worlds;
  for (const std::string& source : options.maps) {
    for (const NamedMap& named : load_maps(source)) worlds.emplace_back(named.name, named.map);
  }
  for (const World& world : worlds) {
    const double budget = episode_options(options, world).budget;
    if (budget < 1 || budget > kMaxReplayBudget) {
      throw Error({.what = "budget out of range for training",
                   .expected = fmt::format("1 to {:.0f} steps", kMaxReplayBudget),
                   .got = fmt::format("{:g}", budget),
                   .where = world.name()});
    }
  }
  return worlds;
}

std::size_t largest(const std::vector<World>& worlds) {
  NodeId nodes = 0;
  for (const World& world : worlds) nodes = std::max(nodes, world.graph().node_count());
  return static_cast<std::size_t>(nodes);
}

LearnerOptions learner_options(const TrainOptions& options) {
  return {.double_dqn = options.algorithm == "double-dqn",
          .discount = options.discount,
          .learning_rate = options.learning_rate,
          .soft_update = options.soft_update,
          .dropout = options.dropout};
}

}  // namespace

Trainer::Trainer(const TrainOptions& options, RunDirectory run)
    : options_(options),
      run_(std::move(run)),
      worlds_(load_worlds(options)),
      encoders_(worlds_.begin(), worlds_.end()),
      rng_(options.seed),
      learner_(learner_options(options), rng_),
      replay_(static_cast<std::size_t>(options.replay_capacity), largest(worlds_)) {
  for (const World& world : worlds_) episodes_.emplace_back(world, episode_options(options_, world));
}

std::unique_ptr<Trainer> Trainer::start(const TrainOptions& options, const RunDirectory& run) {
  std::unique_ptr<Trainer> trainer(new Trainer(options, run));
  run.create();
  write_config(run.config(), options);
  trainer->save();
  return trainer;
}

std::unique_ptr<Trainer> Trainer::resume(const RunDirectory& run) {
  std::unique_ptr<Trainer> trainer(new Trainer(read_config(run.config()), run));
  trainer->restore();
  return trainer;
}

bool Trainer::run(const std::function<bool()>& stop, ProgressDisplay& display) {
  steps_before_session_ = progress_.steps;
  const double elapsed_before_s = progress_.elapsed_s;
  const auto start = std::chrono::steady_clock::now();
  const auto update_clock = [&] {
    const std::chrono::duration<double> session = std::chrono::steady_clock::now() - start;
    progress_.elapsed_s = elapsed_before_s + session.count();
  };
  MetricsFile metrics(run_.metrics(), progress_.episode);
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
    if (progress_.window_episodes == kLogEvery || last) log(metrics, events);
    show(display, last);
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
  world_ = worlds_.size() == 1 ? 0 : static_cast<int>(rng_.below(static_cast<std::uint32_t>(worlds_.size())));
  const auto nodes = worlds_[world_].valid_nodes();
  const NodeId start = nodes[rng_.below(static_cast<std::uint32_t>(nodes.size()))];
  episodes_[world_].reset(start);
  features_.resize(static_cast<std::size_t>(worlds_[world_].graph().node_count()) * kFeatureCount);
  encoders_[world_].begin(start, features_);
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
  learner_.online().q_values(single_, features_, q);
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
  Minibatch& batch = minibatch_;
  batch.graphs.clear();
  batch.x.clear();
  batch.next_x.clear();
  batch.actions.clear();
  batch.rewards.clear();
  batch.terminal.clear();
  for (std::int64_t i = 0; i < options_.batch_size; ++i) {
    const std::size_t index = rng_.below(static_cast<std::uint32_t>(replay_.size()));
    const Transition& t = replay_.transition(index);
    const Graph& graph = worlds_[t.world].graph();
    const std::size_t row = batch.x.size();
    const std::size_t values = static_cast<std::size_t>(graph.node_count()) * kFeatureCount;
    batch.graphs.add(graph);
    batch.x.resize(row + values);
    batch.next_x.resize(row + values);
    const auto visits = replay_.visits(index).first(graph.node_count());
    encoders_[t.world].encode(t.position, visits, std::span(batch.x).subspan(row));
    next_visits_.assign(visits.begin(), visits.end());
    ++next_visits_[t.next_position];
    encoders_[t.world].encode(t.next_position, std::span<const std::uint16_t>(next_visits_),
                              std::span(batch.next_x).subspan(row));
    batch.actions.push_back(t.action);
    batch.rewards.push_back(t.reward);
    batch.terminal.push_back(t.terminal);
  }
  const double loss = learner_.learn(batch, rng_);
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

void Trainer::log(MetricsFile& metrics, EventWriter& events) {
  const auto episodes = static_cast<double>(progress_.window_episodes);
  const MetricsLine line{
      .episode = progress_.episode,
      .steps = progress_.steps,
      .epsilon = epsilon_at(progress_.episode - 1, options_.episodes),
      .loss = progress_.window_losses > 0 ? progress_.window_loss / static_cast<double>(progress_.window_losses) : NAN,
      .visited_nodes = progress_.window_visited / episodes,
      .coverage = progress_.window_coverage / episodes,
      .reward = progress_.window_reward / episodes};
  metrics.write(line);
  std::vector<Scalar> scalars = {
      {"epsilon", line.epsilon}, {"nodes_visited", line.visited_nodes}, {"reward", line.reward}};
  if (!std::isnan(line.loss)) scalars.push_back({"loss", line.loss});
  events.write(line.episode, scalars);
  last_line_ = line;
  progress_.window_episodes = 0;
  progress_.window_losses = 0;
  progress_.window_loss = progress_.window_visited = progress_.window_coverage = progress_.window_reward = 0;
}

void Trainer::show(ProgressDisplay& display, bool always) {
  display.show({.episode = progress_.episode,
                .episodes = options_.episodes,
                .coverage = last_line_.coverage,
                .reward = last_line_.reward,
                .loss = last_line_.loss,
                .epsilon = epsilon_at(progress_.episode - 1, options_.episodes),
                .steps_this_session = progress_.steps - steps_before_session_},
               always);
}

void Trainer::save() {
  std::vector<TensorView> tensors;
  Learner::Packed learner;
  ReplayBuffer::Packed replay;
  learner_.save(learner, tensors);
  replay_.save(replay, tensors);
  const Rng::State random = rng_.state();
  tensors.emplace_back("random.state", Shape{4}, std::span<const std::uint64_t>(random));
  // An episode under way is stored as its start and its actions, and walked again when restored.
  std::vector<std::int32_t> episode;
  if (in_episode_) {
    episode = {world_, episodes_[world_].walk().front()};
    episode.insert(episode.end(), actions_.begin(), actions_.end());
  }
  tensors.emplace_back("episode", Shape{std::ssize(episode)}, std::span<const std::int32_t>(episode));
  nlohmann::ordered_json json;
  for_each_progress_field(progress_, [&](const char* key, const auto& value) { json[key] = value; });
  write_safetensors(run_.checkpoint(), tensors, {{kProgressKey, json.dump()}});
  write_policy_file(run_.policy(), learner_.online().parameters());
}

void Trainer::restore() {
  const Safetensors file = Safetensors::read(run_.checkpoint());
  const auto fail = [&](const std::string& what) { throw Error({.what = what, .where = file.source()}); };
  const auto text = file.metadata().find(kProgressKey);
  if (text == file.metadata().end()) fail("not a checkpoint: it does not say where the training stands");
  const auto json = nlohmann::json::parse(text->second, nullptr, /*allow_exceptions=*/false);
  for_each_progress_field(progress_, [&](const char* key, auto& value) {
    if (!json.is_object() || !json.contains(key) || !json[key].is_number())
      fail("not a checkpoint: no " + in_quotes(key));
    json[key].get_to(value);
  });
  learner_.restore(file);
  replay_.restore(file);
  const auto random = file.get<std::uint64_t>("random.state", {4});
  Rng::State state{};
  std::copy(random.begin(), random.end(), state.begin());
  rng_ = Rng(state);
  restore_episode(file);
}

void Trainer::restore_episode(const Safetensors& file) {
  const auto entry = std::find_if(file.entries().begin(), file.entries().end(),
                                  [](const Safetensors::Entry& candidate) { return candidate.name == "episode"; });
  const auto stored = file.get<std::int32_t>("episode", entry == file.entries().end() ? Shape{0} : entry->shape);
  if (stored.empty()) return;
  const auto fail = [&] { throw Error({.what = "the episode under way cannot be walked", .where = file.source()}); };
  if (stored.size() < 2 || stored[0] < 0 || stored[0] >= std::ssize(worlds_)) fail();
  world_ = stored[0];
  Episode& episode = episodes_[world_];
  episode.reset(stored[1]);
  features_.resize(static_cast<std::size_t>(worlds_[world_].graph().node_count()) * kFeatureCount);
  encoders_[world_].begin(stored[1], features_);
  for (const std::int32_t action : std::span(stored).subspan(2)) {
    if (action < 0 || action >= kActionCount || episode.done()) fail();
    const NodeId from = episode.position();
    const StepResult step = episode.step(action);
    encoders_[world_].update(from, episode.position(), step, features_);
    actions_.push_back(action);
    episode_reward_ += step.reward;
  }
  in_episode_ = true;
}

}  // namespace graphdrl
