// Episodes side by side, in arrays for Python.
#pragma once

#include "bindings.h"
#include "graphdrl/base/random.h"
#include "graphdrl/env/budget.h"
#include "graphdrl/env/world_families.h"

namespace graphdrl::python {

// Where episodes take place.
struct Setting {
  std::optional<World> world;  // of all of them; without it, each has a new one of the family
  WorldSpec family = {};
  Budget budget;
  NodeId start = kNoNode;  // kNoNode: a random one
  EpisodeOptions options = {};

  World world_for(Rng& rng) const { return world ? *world : random_world(family, rng); }
};

// One environment, or many. What they show stands in arrays that stay the same and are written anew by every call.
class Episodes {
 public:
  // restarts: where an episode is over, the next step begins a new one [gymnasium's autoreset NEXT_STEP]. width: of an
  // observation. actions: how many there are.
  Episodes(Setting setting, int count, bool restarts, std::size_t width, int actions);
  Episodes(const Episodes&) = delete;
  virtual ~Episodes() = default;

  void seed(int index, std::uint64_t seed);
  // Begins new episodes of those with a true in `mask`; at `start` where that is a node.
  void reset(const InArray<bool, nb::ndim<1>>& mask, std::int64_t start);
  // One step of each.
  void step(const InArray<std::int64_t, nb::ndim<1>>& actions);

  const World& world(int index) const { return episode(index).world(); }
  const Episode& episode(int index) const;

  // Views of the arrays, which live as long as this does. [n, width], [n, actions], [n] …
  auto observations() { return nb::ndarray<nb::numpy, float, nb::ndim<2>>(observations_.data(), {count(), width_}); }
  auto action_masks() { return nb::ndarray<nb::numpy, bool, nb::ndim<2>>(masks_.get(), {count(), actions_}); }
  auto targets() { return nb::ndarray<nb::numpy, std::int64_t, nb::ndim<2>>(targets_.data(), {count(), actions_}); }
  auto rewards() { return nb::ndarray<nb::numpy, double, nb::ndim<1>>(rewards_.data(), {count()}); }
  auto terminated() { return nb::ndarray<nb::numpy, bool, nb::ndim<1>>(terminated_.get(), {count()}); }
  auto truncated() { return nb::ndarray<nb::numpy, bool, nb::ndim<1>>(truncated_.get(), {count()}); }
  auto visited() { return nb::ndarray<nb::numpy, std::int64_t, nb::ndim<1>>(visited_.data(), {count()}); }
  auto positions() { return nb::ndarray<nb::numpy, std::int64_t, nb::ndim<1>>(positions_.data(), {count()}); }

 protected:
  struct Outcome {
    double reward;
    bool terminated;
    bool truncated;
  };

  std::size_t count() const { return slots_.size(); }
  std::span<float> observation_of(int i) { return {observations_.data() + width_ * i, width_}; }
  // What an action leads to, and whether it may be taken; of actions that there are not, -1 and false.
  std::span<bool> mask_of(int i) { return {masks_.get() + actions_ * i, actions_}; }
  std::span<std::int64_t> targets_of(int i) { return {targets_.data() + actions_ * i, actions_}; }

 private:
  // An episode has begun: shows it.
  virtual void begun(int i, const Episode& episode) = 0;
  // Takes an action, and shows what follows.
  virtual Outcome act(int i, Episode& episode, int action) = 0;

  struct Slot {
    Rng rng{0};
    std::optional<Episode> episode;
    bool over = true;
  };

  void begin(int i, NodeId start);
  void tell(int i);

  Setting setting_;
  bool restarts_;
  std::size_t width_;
  std::size_t actions_;
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

}  // namespace graphdrl::python
