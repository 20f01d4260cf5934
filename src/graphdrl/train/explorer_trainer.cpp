#include "graphdrl/train/explorer_trainer.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>

#include "graphdrl/base/error.h"
#include "graphdrl/base/parallel.h"
#include "graphdrl/report/event_writer.h"
#include "graphdrl/report/metrics_file.h"
#include "graphdrl/train/option_table.h"

namespace graphdrl {
namespace {

constexpr std::uint64_t kWalkPurpose = 1;  // of derive_seed
constexpr double kLastRate = 0.02;         // of the first learning rate
constexpr const char* kProgressKey = "progress";

// A cosine from 1 to kLastRate over the whole training [Loshchilov and Hutter 2017].
double rate_share(double done) {
  return kLastRate + (1 - kLastRate) * (1 + std::cos(std::numbers::pi * done)) / 2;
}

std::uint64_t walk_seed(const ExplorerOptions& options, std::int64_t walk) {
  return derive_seed(options.seed, kWalkPurpose, static_cast<std::uint64_t>(walk));
}

}  // namespace

ExplorerTrainer::ExplorerTrainer(const ExplorerOptions& options, RunDirectory run)
    : options_(options),
      run_(std::move(run)),
      rng_(options.seed),
      learner_({.bootstrap = options.teacher == "double_dqn", .ranking = options.ranking}, rng_) {
  lesson_options_.worlds = training_worlds(options);
  lesson_options_.lead = options.lead;
  lesson_options_.teacher_width = options.teacher == "search" ? static_cast<int>(options.teacher_width) : 0;
}

std::unique_ptr<ExplorerTrainer> ExplorerTrainer::start(const ExplorerOptions& options, const RunDirectory& run) {
  validate(options);
  std::unique_ptr<ExplorerTrainer> trainer(new ExplorerTrainer(options, run));
  run.create();
  write_config(run.config(), options);
  trainer->save();
  return trainer;
}

std::unique_ptr<ExplorerTrainer> ExplorerTrainer::resume(const RunDirectory& run) {
  const ExplorerOptions options = read_explorer_config(run.config());
  std::unique_ptr<ExplorerTrainer> trainer(new ExplorerTrainer(options, run));
  trainer->restore(Safetensors::read(run.checkpoint()));
  return trainer;
}

bool ExplorerTrainer::run(const std::function<bool()>& stop, ProgressDisplay& display) {
  const double elapsed_before_s = progress_.elapsed_s;
  const auto start = std::chrono::steady_clock::now();
  MetricsFile metrics(run_.metrics(), "round", progress_.round);
  EventWriter events(run_.path(), progress_.round + 1);
  bool stopped = false;
  while (progress_.round < options_.rounds && !stopped) {
    draw_lessons_of_round();
    learn_round();
    ++progress_.round;
    stopped = stop();
    const std::chrono::duration<double> session = std::chrono::steady_clock::now() - start;
    progress_.elapsed_s = elapsed_before_s + session.count();
    const bool last = progress_.round == options_.rounds;
    display.show(progress_.round, options_.rounds,
                 fmt::format("{} states  loss {:.4f}  regret {:.4f}", progress_.states, round_loss_, round_regret_),
                 last);
    const std::vector<Scalar> scalars = {
        {"states", static_cast<double>(progress_.states)}, {"loss", round_loss_}, {"regret", round_regret_}};
    metrics.write(progress_.round, scalars);
    events.write(progress_.round, scalars);
    if (!last && !stopped && progress_.round % options_.checkpoint_every == 0) save();
  }
  save();
  display.finish();
  return progress_.round == options_.rounds;
}

void ExplorerTrainer::draw_lessons_of_round() {
  const int walks = static_cast<int>(options_.walks);
  std::vector<std::vector<Lesson>> drawn(static_cast<std::size_t>(walks));
  parallel_for(walks, [&](int walk) {
    drawn[walk] =
        draw_lessons(lesson_options_, learner_.online(), walk_seed(options_, progress_.round * options_.walks + walk));
  });
  for (std::vector<Lesson>& lessons : drawn) {
    for (Lesson& lesson : lessons) {
      const auto capacity = static_cast<std::size_t>(options_.replay_capacity);
      if (memory_.size() < capacity) {
        memory_.push_back(std::move(lesson));
      } else {
        memory_[static_cast<std::size_t>(progress_.states) % capacity] = std::move(lesson);
      }
      ++progress_.states;
    }
  }
}

void ExplorerTrainer::learn_round() {
  round_loss_ = round_regret_ = 0;
  std::vector<const Lesson*> picked(static_cast<std::size_t>(options_.batch_size));
  const auto updates = static_cast<double>(options_.updates);
  for (std::int64_t update = 0; update < options_.updates && !memory_.empty(); ++update) {
    for (const Lesson*& lesson : picked) lesson = &memory_[rng_.below(static_cast<std::uint32_t>(memory_.size()))];
    const double done = (static_cast<double>(progress_.round) + static_cast<double>(update) / updates) /
                        static_cast<double>(options_.rounds);
    const double loss = learner_.learn(picked, options_.learning_rate * rate_share(done));
    if (!std::isfinite(loss)) {
      throw std::runtime_error(
          fmt::format("the loss is not finite in round {}: try a smaller --learning-rate", progress_.round));
    }
    round_loss_ += loss / updates;
    round_regret_ += learner_.regret() / updates;
  }
}

void ExplorerTrainer::save() {
  std::vector<TensorView> tensors = learner_.online().views("online.");
  for (const TensorView& view : learner_.target().views("target.")) tensors.push_back(view);
  const Adam& adam = learner_.adam();
  const auto count = std::ssize(adam.first());
  tensors.emplace_back("adam.first", Shape{count}, std::span<const float>(adam.first()));
  tensors.emplace_back("adam.second", Shape{count}, std::span<const float>(adam.second()));
  const std::vector<std::int64_t> adam_steps = {adam.steps()};
  tensors.emplace_back("adam.steps", Shape{1}, std::span<const std::int64_t>(adam_steps));
  const Rng::State random = rng_.state();
  tensors.emplace_back("random.state", Shape{4}, std::span<const std::uint64_t>(random));
  // Worlds are drawn again from their seeds.
  std::vector<std::uint64_t> seeds;
  std::vector<std::int64_t> positions;
  std::vector<std::int64_t> choices;
  std::vector<std::int64_t> scopes;
  std::vector<double> spendable;
  std::vector<std::uint64_t> visited;
  std::vector<std::int64_t> label_counts;
  std::vector<float> labels;
  for (const Lesson& lesson : memory_) {
    seeds.push_back(lesson.at->seed);
    positions.push_back(lesson.position);
    choices.push_back(lesson.choice);
    scopes.push_back(lesson.scope);
    spendable.push_back(lesson.spendable);
    visited.insert(visited.end(), lesson.visited.begin(), lesson.visited.end());
    label_counts.push_back(std::ssize(lesson.shortfall));
    labels.insert(labels.end(), lesson.shortfall.begin(), lesson.shortfall.end());
  }
  const auto add = [&]<typename T>(const char* name, const std::vector<T>& values) {
    tensors.emplace_back(name, Shape{std::ssize(values)}, std::span<const T>(values));
  };
  add("memory.seed", seeds);
  add("memory.position", positions);
  add("memory.choice", choices);
  add("memory.scope", scopes);
  add("memory.spendable", spendable);
  add("memory.visited", visited);
  add("memory.label_count", label_counts);
  add("memory.label", labels);
  const nlohmann::ordered_json progress = {
      {"round", progress_.round}, {"states", progress_.states}, {"elapsed_s", progress_.elapsed_s}};
  write_safetensors(run_.checkpoint(), tensors, {{kProgressKey, progress.dump()}});
  write_policy_file(run_.policy(), learner_.online());
}

void ExplorerTrainer::restore(const Safetensors& file) {
  const auto fail = [&](const std::string& what) { throw Error({.what = what, .where = file.source()}); };
  const auto text = file.metadata().find(kProgressKey);
  if (text == file.metadata().end()) fail("not a checkpoint: no progress");
  const auto progress = nlohmann::json::parse(text->second, nullptr, /*allow_exceptions=*/false);
  const auto whole = [&](const char* key) {
    if (!progress.is_object() || !progress.contains(key) || !progress[key].is_number_unsigned()) {
      fail("not a checkpoint: no " + in_quotes(key));
    }
    return progress[key].get<std::int64_t>();
  };
  progress_.round = whole("round");
  progress_.states = whole("states");
  if (progress.contains("elapsed_s") && progress["elapsed_s"].is_number())
    progress["elapsed_s"].get_to(progress_.elapsed_s);
  if (progress_.round > options_.rounds)
    fail("the checkpoint is not of this run: it has done more rounds than there are");
  learner_.online() = ExplorerParameters::from_file(file, "online.");
  learner_.target() = ExplorerParameters::from_file(file, "target.");
  learner_.update();
  Adam& adam = learner_.adam();
  const Shape moments = {std::ssize(adam.first())};
  adam.first() = file.get<float>("adam.first", moments);
  adam.second() = file.get<float>("adam.second", moments);
  adam.steps() = file.get<std::int64_t>("adam.steps", {1})[0];
  const auto finite = [](const std::vector<float>& values) {
    return std::all_of(values.begin(), values.end(), [](float value) { return std::isfinite(value); });
  };
  if (!finite(adam.first()) || !finite(adam.second()) || adam.steps() < 0) fail("the optimiser's state is damaged");
  const auto random = file.get<std::uint64_t>("random.state", {4});
  Rng::State state{};
  std::copy(random.begin(), random.end(), state.begin());
  if (state == Rng::State{}) fail("the checkpoint holds no random state");
  rng_ = Rng(state);

  const Shape lessons = file.shape_of("memory.seed");
  const auto seeds = file.get<std::uint64_t>("memory.seed", lessons);
  const auto positions = file.get<std::int64_t>("memory.position", lessons);
  const auto choices = file.get<std::int64_t>("memory.choice", lessons);
  const auto scopes = file.get<std::int64_t>("memory.scope", lessons);
  const auto spendable = file.get<double>("memory.spendable", lessons);
  const auto label_counts = file.get<std::int64_t>("memory.label_count", lessons);
  const auto visited = file.get<std::uint64_t>("memory.visited", file.shape_of("memory.visited"));
  const auto labels = file.get<float>("memory.label", file.shape_of("memory.label"));
  const auto damaged = [&] { fail("the lessons remembered in the checkpoint are damaged"); };
  const bool good_labels = std::none_of(labels.begin(), labels.end(), [](float value) { return std::isinf(value); });
  if (std::ssize(seeds) != std::min(progress_.states, options_.replay_capacity) || !good_labels) damaged();
  // Lessons of one walk share their world.
  std::map<std::uint64_t, std::shared_ptr<LessonWorld>> worlds;
  std::size_t visited_at = 0;
  std::size_t label_at = 0;
  for (std::size_t i = 0; i < seeds.size(); ++i) {
    std::shared_ptr<LessonWorld>& at = worlds[seeds[i]];
    if (!at) {
      at = std::make_shared<LessonWorld>(lesson_options_.worlds[seeds[i] % lesson_options_.worlds.size()], seeds[i]);
    }
    const NodeId nodes = at->world.graph().node_count();
    const std::size_t words = (static_cast<std::size_t>(nodes) + 63) / 64;
    if (positions[i] < 0 || positions[i] >= nodes || at->world.is_blocked(static_cast<NodeId>(positions[i])) ||
        !std::isfinite(spendable[i]) || scopes[i] < 1 || scopes[i] > kExplorerScope || label_counts[i] < 0 ||
        visited.size() - visited_at < words || labels.size() - label_at < static_cast<std::size_t>(label_counts[i])) {
      damaged();
    }
    const auto first_word = visited.begin() + static_cast<std::ptrdiff_t>(visited_at);
    const auto first_label = labels.begin() + static_cast<std::ptrdiff_t>(label_at);
    memory_.push_back({.at = at,
                       .visited = {first_word, first_word + static_cast<std::ptrdiff_t>(words)},
                       .position = static_cast<NodeId>(positions[i]),
                       .spendable = spendable[i],
                       .scope = static_cast<int>(scopes[i]),
                       .choice = static_cast<int>(choices[i]),
                       .shortfall = {first_label, first_label + label_counts[i]}});
    visited_at += words;
    label_at += static_cast<std::size_t>(label_counts[i]);
    ExplorerBatch check;
    const auto visits = std::ssize(memory_.back().append_to(check));
    const bool labelled = lesson_options_.teacher_width > 0;
    if (label_counts[i] != (labelled ? visits : 0) || choices[i] < 0 || choices[i] >= visits) damaged();
  }
  if (visited_at != visited.size() || label_at != labels.size()) damaged();
}

}  // namespace graphdrl
