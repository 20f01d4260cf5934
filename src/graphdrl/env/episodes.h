// Many episodes side by side, as vector environments show them.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "graphdrl/base/parallel.h"
#include "graphdrl/base/random.h"
#include "graphdrl/env/episode.h"
#include "graphdrl/env/task.h"
#include "graphdrl/env/world_families.h"

namespace graphdrl {

struct EpisodesOptions {
  std::optional<World> world = {};  // of all episodes; without it, each episode has a new one of the family
  Budget budget = Budget(0);
  WorldSpec family = {};
  NodeId start = kNoNode;       // kNoNode: a random one for each episode
  EpisodeOptions episode = {};  // but for its budget and action space
  int count = 1;                // V, 1 to 1,000,000
  bool restarts = false;        // the next step of an episode that is over begins another [Gymnasium's NEXT_STEP]

  World draw_world(Rng& rng) const { return world ? *world : random_world(family, rng); }
  bool is_grid() const;       // each world is, with four directions
  NodeId most_nodes() const;  // of the largest world
};

// V episodes. A kind of episodes, a class derived from this one, says what an action is and what is observed: A actions
// and F numbers. Arrays have a row per episode and stay where they are; every call writes them anew. Blocks of episodes
// are stepped by parallel_for, and results do not depend on the number of threads. Not thread safe.
class Episodes {
 public:
  Episodes(const Episodes&) = delete;
  Episodes& operator=(const Episodes&) = delete;
  virtual ~Episodes() = default;

  int count() const { return static_cast<int>(slots_.size()); }  // V

  // Of random starts and worlds, from the next episode on.
  void seed(int index, std::uint64_t seed);
  // Begins the episodes with a true in `mask` [V], at `start` unless it is kNoNode. Throws Error on a mask of another
  // length, and as begin() does.
  void reset(std::span<const bool> mask, NodeId start = kNoNode);
  // Takes an action in each episode. actions: [V], from 0 to A - 1. Throws Error on others, and on an episode that is
  // over, unless it restarts.
  void step(std::span<const std::int64_t> actions);

  // The same for one episode, within for_each() too. Throws Error on a start that is blocked or not in the world, and
  // on any start of random worlds.
  void begin(int index, NodeId start = kNoNode);
  void act(int index, int action);                           // REQUIRES: !over(index), 0 <= action < A
  bool over(int index) const { return slots_[index].over; }  // or not begun yet

  // Calls visit(index) for every episode, those of a block one after the other on one thread.
  template <typename Visit>
  void for_each(const Visit& visit) {
    const auto visit_block = [&](int block) {
      const int end = std::min(count(), (block + 1) * kBlock);
      for (int i = block * kBlock; i < end; ++i) visit(i);
    };
    parallel_for((count() + kBlock - 1) / kBlock, visit_block, Schedule::kFixed);
  }

  const Episode& episode(int index) const;  // throws Error before it has begun

  std::span<float> observations() { return observations_; }                    // [V, F]
  std::span<bool> action_masks() { return {masks_.get(), targets_.size()}; }   // [V, A], the actions to choose from
  std::span<std::int64_t> targets() { return targets_; }                       // [V, A], where each leads; or kNoNode
  std::span<double> rewards() { return rewards_; }                             // [V]
  std::span<bool> terminated() { return {terminated_.get(), slots_.size()}; }  // [V]
  std::span<bool> truncated() { return {truncated_.get(), slots_.size()}; }    // [V]
  std::span<std::int64_t> visited() { return visited_; }                       // [V], how many nodes
  std::span<std::int64_t> positions() { return positions_; }                   // [V]
  // Of one episode: [F], [A], [A].
  std::span<float> observation_of(int index) { return {observations_.data() + width_ * index, width_}; }
  std::span<bool> mask_of(int index) { return {masks_.get() + actions_ * index, actions_}; }
  std::span<std::int64_t> targets_of(int index) { return {targets_.data() + actions_ * index, actions_}; }

 protected:
  struct Outcome {
    double reward = 0;
    bool terminated = false;
    bool truncated = false;
  };

  // Throws Error on options that do not fit each other.
  Episodes(EpisodesOptions options, ActionSpace actions);
  // The second half of making them. width: F. actions: A.
  void allocate(std::size_t width, int actions);

  const EpisodesOptions& options() const { return options_; }
  // A masked action of episodes that have no directions: pays for an edge of mean cost and stays, as a blocked
  // direction does. Terminates what cannot pay for that.
  static Outcome waste(Episode& episode);

 private:
  static constexpr int kBlock = 64;  // episodes; their states fit a core's first-level cache

  struct Slot {
    Rng rng{0};
    std::optional<Episode> episode;
    bool over = true;
  };

  // Shows an episode that has begun.
  virtual void show_start(int index, const Episode& episode) = 0;
  // Takes an action and shows what follows.
  virtual Outcome take(int index, Episode& episode, int action) = 0;

  Episode new_episode(Rng& rng) const;
  void tell(int index);

  EpisodesOptions options_;
  std::size_t width_ = 0;
  std::size_t actions_ = 0;
  std::vector<Slot> slots_;
  std::vector<float> observations_;
  std::unique_ptr<bool[]> masks_;
  std::vector<std::int64_t> targets_;
  std::vector<double> rewards_;
  std::unique_ptr<bool[]> terminated_;
  std::unique_ptr<bool[]> truncated_;
  std::vector<std::int64_t> visited_;
  std::vector<std::int64_t> positions_;
};

// What networks on graphs observe.
struct GraphObservation {
  std::vector<float> nodes;         // [N, F]
  std::vector<float> costs;         // [E, 1], in mean edges of the world
  std::vector<std::int64_t> links;  // [E, 2], from and to; an edge both ways has two rows
};
GraphObservation observation_on(const Graph& graph, double mean_cost, std::vector<float> nodes);

}  // namespace graphdrl
