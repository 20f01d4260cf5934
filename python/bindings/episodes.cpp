#include "episodes.h"

#include "graphdrl/base/error.h"
#include "graphdrl/base/parallel.h"

namespace graphdrl::python {
namespace {

constexpr int kBlock = 64;  // episodes of one task; their states fit a core's first-level cache

}  // namespace

Episodes::Episodes(Setting setting, int count, bool restarts, std::size_t width, int actions)
    : setting_(std::move(setting)),
      restarts_(restarts),
      width_(width),
      actions_(static_cast<std::size_t>(actions)),
      slots_(static_cast<std::size_t>(count)),
      observations_(width * slots_.size()),
      masks_(std::make_unique<bool[]>(actions_ * slots_.size())),
      targets_(actions_ * slots_.size(), kNoNode),
      rewards_(slots_.size()),
      terminated_(std::make_unique<bool[]>(slots_.size())),
      truncated_(std::make_unique<bool[]>(slots_.size())),
      visited_(slots_.size()),
      positions_(slots_.size()) {
  if (setting_.world && setting_.start != kNoNode) checked_node(*setting_.world, setting_.start, "start");
}

void Episodes::seed(int index, std::uint64_t seed) {
  slots_.at(static_cast<std::size_t>(index)).rng = Rng(seed);
}

const Episode& Episodes::episode(int index) const {
  const auto& episode = slots_.at(static_cast<std::size_t>(index)).episode;
  if (!episode) throw Error({.what = "no episode yet", .expected = "reset() first"});
  return *episode;
}

void Episodes::reset(const InArray<bool, nb::ndim<1>>& mask, std::int64_t start) {
  if (mask.size() != count()) throw Error({.what = "bad length of a mask"});
  NodeId node = kNoNode;
  if (start != kNoNode) {
    if (!setting_.world) throw Error({.what = "a random world has no start to choose"});
    node = checked_node(*setting_.world, start, "start");
  }
  for (std::size_t i = 0; i < count(); ++i) {
    if (mask.data()[i]) begin(static_cast<int>(i), node);
  }
}

void Episodes::step(const InArray<std::int64_t, nb::ndim<1>>& actions) {
  if (actions.size() != count()) {
    throw Error(
        {.what = "bad number of actions", .expected = std::to_string(count()), .got = std::to_string(actions.size())});
  }
  for (const std::int64_t action : values_of<std::int64_t>(actions)) {
    if (action >= 0 && action < static_cast<std::int64_t>(actions_)) continue;
    throw Error(
        {.what = "bad action", .expected = "0 to " + std::to_string(actions_ - 1), .got = std::to_string(action)});
  }
  if (!restarts_ && slots_[0].over) throw Error({.what = "the episode is over", .expected = "reset() first"});
  const nb::gil_scoped_release unlocked;
  const int all = static_cast<int>(count());
  const auto step_block = [&](int block) {
    for (int i = block * kBlock; i < std::min(all, (block + 1) * kBlock); ++i) {
      Slot& slot = slots_[i];
      if (slot.over) {
        begin(i, kNoNode);
        continue;
      }
      const Outcome outcome = act(i, *slot.episode, static_cast<int>(actions.data()[i]));
      rewards_[i] = outcome.reward;
      terminated_[i] = outcome.terminated;
      truncated_[i] = !outcome.terminated && outcome.truncated;
      slot.over = outcome.terminated || outcome.truncated;
      tell(i);
    }
  };
  parallel_for((all + kBlock - 1) / kBlock, step_block, Schedule::kFixed);
}

void Episodes::begin(int i, NodeId start) {
  Slot& slot = slots_[i];
  if (!slot.episode || !setting_.world) {
    const World world = setting_.world_for(slot.rng);
    EpisodeOptions options = setting_.options;
    options.budget = setting_.budget.cost_in(world);
    slot.episode.emplace(world, options);
  }
  Episode& episode = *slot.episode;
  const auto nodes = episode.world().valid_nodes();
  if (start == kNoNode) start = setting_.start;
  if (start == kNoNode) start = nodes[slot.rng.below(static_cast<std::uint32_t>(nodes.size()))];
  episode.reset(start);
  begun(i, episode);
  rewards_[i] = 0;
  terminated_[i] = truncated_[i] = false;
  slot.over = false;
  tell(i);
}

void Episodes::tell(int i) {
  visited_[i] = slots_[i].episode->visited_count();
  positions_[i] = slots_[i].episode->position();
}

}  // namespace graphdrl::python
