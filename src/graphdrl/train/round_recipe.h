// Trainings in rounds: walks are drawn, which give lessons; then come learning steps on all that is remembered.
#pragma once

#include <atomic>
#include <optional>
#include <vector>

#include "graphdrl/base/bytes.h"
#include "graphdrl/base/parallel.h"
#include "graphdrl/base/ranks.h"
#include "graphdrl/env/world_families.h"
#include "graphdrl/train/recipe.h"

namespace graphdrl {

class RoundRecipe : public Recipe {
 public:
  RoundRecipe(const TrainOptions& options, Ranks& ranks) : options_(options), ranks_(ranks) {}

  bool run_unit(TrainingProgress& progress, const std::function<bool()>& stop) final;
  std::string status(const TrainingProgress& progress) const final;
  std::vector<Metric> take_metrics(const TrainingProgress& progress) final;

 protected:
  struct LearningStep {
    double loss;
    double regret;  // what is lost by the network's choices, in nodes
  };

  // Draws the lessons of a round, and remembers them; gives how many. Nothing where `stop` said so before the last.
  virtual std::optional<std::int64_t> draw(std::int64_t round, const std::function<bool()>& stop) = 0;
  // One learning step; nothing where there is nothing to learn from.
  virtual std::optional<LearningStep> learn(double rate) = 0;

  const TrainOptions& options() const { return options_; }
  Ranks& ranks() const { return ranks_; }

  // draw_walk(seed): the lessons of one walk, through a world of worlds[seed mod their number]. make_bytes(): puts
  // lessons into bytes and gets them back, a walk at a time. The same for any number of threads and ranks. Collective.
  template <typename Lesson, typename DrawWalk, typename MakeBytes>
  std::optional<std::vector<Lesson>> draw_walks(std::int64_t round, const std::function<bool()>& stop,
                                                const std::vector<WorldSpec>& worlds, const DrawWalk& draw_walk,
                                                const MakeBytes& make_bytes) const {
    std::vector<std::vector<Lesson>> by_walk(static_cast<std::size_t>(options_.walks));
    std::vector<char> drawn_here(by_walk.size());
    std::atomic<bool> stopped = false;
    {
      const std::vector<int> order = largest_first(round, worlds);
      const auto walks = static_cast<int>(options_.walks);
      const auto queue = ranks_.hand_out((walks + kWalksPerTask - 1) / kWalksPerTask);
      parallel_for(threads(), [&](int) {
        while (const auto task = queue->next()) {
          for (int i = *task * kWalksPerTask; i < std::min(walks, (*task + 1) * kWalksPerTask); ++i) {
            const int walk = order[i];
            if (stopped || stop()) {
              stopped = true;
              queue->close();
              return;
            }
            by_walk[walk] = draw_walk(seed_of(round, walk));
            drawn_here[walk] = 1;
          }
        }
      });
    }
    if (ranks_.any(stopped)) return std::nullopt;
    if (!ranks_.alone()) tell_walks(by_walk, drawn_here, make_bytes);
    std::vector<Lesson> all;
    for (std::vector<Lesson>& of_walk : by_walk) {
      for (Lesson& lesson : of_walk) all.push_back(std::move(lesson));
    }
    return all;
  }

  // Tells all ranks the walks that were drawn here, and hears of theirs.
  template <typename Lesson, typename MakeBytes>
  void tell_walks(std::vector<std::vector<Lesson>>& by_walk, std::span<const char> drawn_here,
                  const MakeBytes& make_bytes) const {
    ByteWriter told;
    for (std::size_t walk = 0; walk < by_walk.size(); ++walk) {
      if (drawn_here[walk] == 0) continue;
      ByteWriter lessons;
      for (const Lesson& lesson : by_walk[walk]) make_bytes().put(lesson, lessons);
      told.put(walk);
      told.put_text(lessons.bytes());
    }
    std::vector<std::string> bytes(by_walk.size());
    for (const std::string& of_rank : ranks_.gather(told.bytes())) {
      for (ByteReader heard(of_rank); !heard.at_end();) {
        const auto walk = heard.get<std::size_t>();
        bytes.at(walk) = heard.get_text();
      }
    }
    parallel_for(static_cast<int>(by_walk.size()), [&](int walk) {
      if (drawn_here[walk] != 0) return;
      auto reader = make_bytes();
      for (ByteReader lessons(bytes[walk]); !lessons.at_end();) by_walk[walk].push_back(reader.get(lessons));
    });
  }

  // The round under way. Throws Error where another number of lessons is remembered than was drawn.
  void save_round(CheckpointWriter& checkpoint) const;
  void restore_round(const Checkpoint& checkpoint, std::int64_t remembered, const TrainingProgress& progress);

 private:
  static constexpr int kWalksPerTask = 4;  // walks of unknown maps take some 3 ms; asking takes a part of one

  std::vector<int> largest_first(std::int64_t round, const std::vector<WorldSpec>& worlds) const;
  std::uint64_t seed_of(std::int64_t round, int walk) const;
  bool take_steps(std::int64_t round, const std::function<bool()>& stop);

  TrainOptions options_;
  Ranks& ranks_;
  std::optional<std::int64_t> updates_;  // learning steps of the round under way; none before its walks are drawn
  // Of the round under way, or the last one.
  double loss_ = 0;
  double regret_ = 0;
};

}  // namespace graphdrl
