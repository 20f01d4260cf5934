#include "graphdrl/train/replay_buffer.h"

#include <algorithm>

#include "graphdrl/base/error.h"

namespace graphdrl {

void ReplayBuffer::push(const Transition& transition, std::span<const std::uint32_t> visits) {
  if (transitions_.size() < capacity_) {
    transitions_.push_back(transition);
    visits_.resize(visits_.size() + max_nodes_);
    next_ = transitions_.size() - 1;
  } else {
    transitions_[next_] = transition;
  }
  const auto slot = visits_.begin() + static_cast<std::ptrdiff_t>(next_ * max_nodes_);
  std::fill(std::copy(visits.begin(), visits.end(), slot), slot + static_cast<std::ptrdiff_t>(max_nodes_), 0);
  next_ = (next_ + 1) % capacity_;
}

void ReplayBuffer::save(Packed& packed, std::vector<TensorView>& tensors) const {
  packed = {};
  for (const Transition& t : transitions_) {
    packed.integers.insert(packed.integers.end(), {t.world, t.position, t.action, t.next_position, t.terminal});
    packed.rewards.push_back(t.reward);
  }
  packed.next = {static_cast<std::int64_t>(next_)};
  const auto size = static_cast<std::int64_t>(transitions_.size());
  tensors.emplace_back("replay.visits", Shape{size, static_cast<std::int64_t>(max_nodes_)},
                       std::span<const std::uint16_t>(visits_));
  tensors.emplace_back("replay.transitions", Shape{size, kIntegers}, std::span<const std::int32_t>(packed.integers));
  tensors.emplace_back("replay.rewards", Shape{size}, std::span<const float>(packed.rewards));
  tensors.emplace_back("replay.next", Shape{1}, std::span<const std::int64_t>(packed.next));
}

void ReplayBuffer::restore(const Safetensors& file, const std::function<bool(const Transition&)>& is_valid) {
  const auto fail = [&](const std::string& what) { throw Error({.what = what, .where = file.source()}); };
  const Shape& shape = file.shape_of("replay.rewards");
  const std::int64_t size = shape.size() == 1 ? shape[0] : 0;
  const auto rewards = file.get<float>("replay.rewards", {size});
  const auto integers = file.get<std::int32_t>("replay.transitions", {size, kIntegers});
  const std::int64_t next = file.get<std::int64_t>("replay.next", {1}).front();
  if (size > static_cast<std::int64_t>(capacity_)) fail("the checkpoint's replay buffer is larger than the run's");
  if (next < 0 || next >= static_cast<std::int64_t>(capacity_) || next > size) fail("bad place in the replay buffer");
  visits_ = file.get<std::uint16_t>("replay.visits", {size, static_cast<std::int64_t>(max_nodes_)});
  next_ = static_cast<std::size_t>(next);
  transitions_.clear();
  for (std::int64_t i = 0; i < size; ++i) {
    const std::int32_t* const t = integers.data() + i * kIntegers;
    transitions_.push_back({.world = t[0],
                            .position = t[1],
                            .action = t[2],
                            .next_position = t[3],
                            .reward = rewards[i],
                            .terminal = t[4] != 0});
    if (!is_valid(transitions_.back())) fail("the replay buffer holds a transition of another world");
  }
}

}  // namespace graphdrl
