#include <algorithm>
#include <cmath>
#include <optional>

#include "graphdrl/train/adam.h"
#include "graphdrl/train/minibatch.h"
#include "graphdrl/train/online_lessons.h"
#include "graphdrl/train/round_recipe.h"

namespace graphdrl {
namespace {

constexpr double kRuleRounds = 0.1;  // of all rounds, in which rules value first visits: the network cannot yet
constexpr double kEntropy = 0.03;    // weight of the entropy of choices, in % of the nodes

constexpr int kOnlineSides[] = {5, 8, 11, 14, 17, 20, 26};
constexpr int kOnlineNodes[] = {33, 50, 77, 110, 150, 182};
constexpr int kOnlineNodesPerSide = 7;

// The worlds of the online explorer, each as likely as any other. None are honeycombs, triangular lattices, toruses or
// power-law clusters: these are kept for tests.
std::vector<WorldSpec> online_worlds(int largest) {
  std::vector<WorldSpec> worlds;
  for (const int side : kOnlineSides) {
    if (side > largest) break;
    const int odd = side | 1;
    for (const char* const family : {"obstacles", "rooms", "caves", "houses", "streets", "room-grid"}) {
      worlds.push_back({family, side});
    }
    worlds.push_back({.family = "obstacles", .size = side, .blocked = 0.0});
    worlds.push_back({.family = "obstacles", .size = side, .blocked = 0.2});
    if (odd > 17) continue;
    for (const char* const family : {"maze", "loop-maze", "braided-maze"}) worlds.push_back({family, 2 * side - 1});
  }
  for (const int nodes : kOnlineNodes) {
    if (nodes > kOnlineNodesPerSide * largest) break;
    for (const char* const family : {"erdos-renyi", "barabasi-albert", "barabasi-albert-dense", "watts-strogatz",
                                     "geometric", "caveman", "road", "ladder", "tree", "balanced-tree"}) {
      worlds.push_back({family, nodes});
    }
    for (const char* const family : {"road", "geometric", "erdos-renyi", "watts-strogatz"}) {
      worlds.push_back({family, nodes, /*weighted=*/true});
    }
    worlds.push_back({"ladder", 2 * nodes});
  }
  return worlds;
}

class OnlineRecipe final : public RoundRecipe {
 public:
  OnlineRecipe(const TrainOptions& options, Rng& rng, Ranks& ranks)
      : RoundRecipe(options, ranks), rng_(rng), parameters_(rng), adam_(parameters_.values().size()) {
    lesson_options_.worlds = online_worlds(static_cast<int>(options.largest));
    lesson_options_.lead = options.lead;
  }

  void save(CheckpointWriter& checkpoint) const override {
    checkpoint.add("online.", parameters_);
    checkpoint.add(adam_);
    std::vector<std::int64_t> counts;
    std::vector<float> rows;
    std::vector<float> values;
    for (const OnlineLesson& lesson : lessons_) {
      counts.push_back(std::ssize(lesson.value));
      rows.insert(rows.end(), lesson.rows.begin(), lesson.rows.end());
      values.insert(values.end(), lesson.value.begin(), lesson.value.end());
    }
    checkpoint.add("replay.visits", std::move(counts));
    checkpoint.add("replay.rows", std::move(rows));
    checkpoint.add("replay.value", std::move(values));
    checkpoint.add("replay.next", std::vector<std::int64_t>{static_cast<std::int64_t>(next_)});
    save_round(checkpoint);
  }

  void restore(const Checkpoint& checkpoint, const TrainingProgress& progress) override {
    parameters_ = checkpoint.parameters<OnlineParameters>("online.");
    adam_ = checkpoint.adam(trainable_count(OnlineParameters::specs()));
    const auto counts = checkpoint.get<std::int64_t>("replay.visits");
    const auto rows = checkpoint.get<float>("replay.rows");
    const auto values = checkpoint.get<float>("replay.value");
    const auto next = checkpoint.get<std::int64_t>("replay.next");
    std::int64_t visits = 0;
    for (const std::int64_t count : counts) {
      if (count < 2 || count > lesson_options_.most_valued) checkpoint.fail("a lesson with a bad number of visits");
      visits += count;
    }
    if (std::ssize(values) != visits || std::ssize(rows) != visits * kOnlineFeatureCount || next.size() != 1 ||
        next[0] < 0 || next[0] > std::ssize(counts)) {
      checkpoint.fail("lessons that do not fit together");
    }
    lessons_.clear();
    std::size_t at = 0;
    for (const std::int64_t count : counts) {
      const auto row = rows.begin() + static_cast<std::ptrdiff_t>(at) * kOnlineFeatureCount;
      const auto value = values.begin() + static_cast<std::ptrdiff_t>(at);
      lessons_.push_back({.rows = std::vector<float>(row, row + count * kOnlineFeatureCount),
                          .value = std::vector<float>(value, value + count)});
      at += static_cast<std::size_t>(count);
    }
    next_ = static_cast<std::size_t>(next[0]);
    restore_round(checkpoint, std::ssize(lessons_), progress);
  }

  std::string not_finite() const override { return parameters_.first_not_finite(); }
  void write_policy(const std::filesystem::path& path) const override { write_policy_file(path, parameters_); }

 private:
  std::optional<std::int64_t> draw(std::int64_t round, const std::function<bool()>& stop) override {
    OnlineLessonOptions options = lesson_options_;
    options.by_rules = static_cast<double>(round) < kRuleRounds * static_cast<double>(this->options().rounds);
    auto drawn = draw_walks<OnlineLesson>(
        round, stop, options.worlds,
        [&](std::uint64_t seed) { return draw_online_lessons(options, parameters_, seed); },
        [] { return OnlineLessonBytes(); });
    if (!drawn) return std::nullopt;
    const std::int64_t count = std::ssize(*drawn);
    for (OnlineLesson& lesson : *drawn) {
      if (std::ssize(lessons_) < this->options().replay_capacity) {
        lessons_.push_back(std::move(lesson));
      } else {
        next_ %= lessons_.size();
        lessons_[next_++] = std::move(lesson);
      }
    }
    return count;
  }

  std::optional<LearningStep> learn(double rate) override {
    if (lessons_.empty()) return std::nullopt;
    std::vector<const OnlineLesson*> picked(static_cast<std::size_t>(options().batch_size));
    for (const OnlineLesson*& lesson : picked) {
      lesson = &lessons_[rng_.below(static_cast<std::uint32_t>(lessons_.size()))];
    }
    balance_shards(picked, [](const OnlineLesson* lesson) { return lesson->value.size(); });
    workers_.resize(static_cast<std::size_t>(threads()));
    const std::size_t count = parameters_.values().size();
    std::vector<float> sum(count + 2);
    sum_over_minibatch(
        ranks(), static_cast<int>(picked.size()),
        [&](int worker, int begin, int end, std::span<float> of_shard) {
          const auto lessons = std::span(std::as_const(picked)).subspan(begin, end - begin);
          const LearningStep step = compute_gradient(lessons, static_cast<double>(picked.size()), workers_[worker]);
          std::ranges::copy(std::as_const(workers_[worker].grad).values(), of_shard.begin());
          of_shard[count] = static_cast<float>(step.loss);
          of_shard[count + 1] = static_cast<float>(step.regret);
        },
        sum);
    adam_.step(std::span(sum).first(count), rate, parameters_.values());
    return LearningStep{.loss = sum[count], .regret = sum[count + 1]};
  }

  // What a thread computes the gradient of some lessons with.
  struct Worker {
    OnlineNetwork network;
    OnlineParameters grad;
    std::vector<float> rows;
    std::vector<float> score;
    std::vector<float> grad_score;
  };

  // Ascends the mean value of a choice by softmax(score), and a little of its entropy. batch: lessons of the minibatch.
  LearningStep compute_gradient(std::span<const OnlineLesson* const> lessons, double batch, Worker& worker) const {
    worker.rows.clear();
    std::size_t visits = 0;
    for (const OnlineLesson* const lesson : lessons) {
      worker.rows.insert(worker.rows.end(), lesson->rows.begin(), lesson->rows.end());
      visits += lesson->value.size();
    }
    worker.score.resize(visits);
    worker.grad_score.resize(visits);
    worker.network.forward(parameters_, worker.rows, worker.score);
    LearningStep step{.loss = 0, .regret = 0};
    std::size_t first = 0;
    for (const OnlineLesson* const lesson : lessons) {
      const std::size_t count = lesson->value.size();
      const std::span<const float> score(worker.score.data() + first, count);
      const auto best = std::ranges::max_element(score);
      std::vector<double> share(count);
      double sum = 0;
      for (std::size_t i = 0; i < count; ++i) sum += share[i] = std::exp(double{score[i]} - *best);
      double mean = 0;
      double entropy = 0;
      for (std::size_t i = 0; i < count; ++i) {
        share[i] /= sum;
        mean += share[i] * lesson->value[i];
        entropy -= share[i] * std::log(share[i] + 1e-12);
      }
      for (std::size_t i = 0; i < count; ++i) {
        const double by_value = share[i] * (lesson->value[i] - mean);
        const double by_entropy = -share[i] * (std::log(share[i] + 1e-12) + entropy);
        worker.grad_score[first + i] = static_cast<float>(-(by_value + kEntropy * by_entropy) / batch);
      }
      const double least = static_cast<double>(*std::ranges::max_element(lesson->value)) -
                           lesson->value[static_cast<std::size_t>(best - score.begin())];
      step.regret += least / batch;
      step.loss -= (mean + kEntropy * entropy) / batch;
      first += count;
    }
    worker.network.backward(parameters_, worker.rows, worker.grad_score, worker.grad);
    return step;
  }

  Rng& rng_;
  OnlineLessonOptions lesson_options_;
  OnlineParameters parameters_;
  AdamState adam_;
  std::vector<Worker> workers_;
  std::vector<OnlineLesson> lessons_;  // a ring
  std::size_t next_ = 0;               // where the next lesson goes once the ring is full
};

}  // namespace

std::unique_ptr<Recipe> make_online_recipe(const TrainOptions& options, Rng& rng, Ranks& ranks) {
  return std::make_unique<OnlineRecipe>(options, rng, ranks);
}

}  // namespace graphdrl
