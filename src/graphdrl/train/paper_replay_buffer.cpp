#include "graphdrl/train/paper_replay_buffer.h"

#include <algorithm>
#include <cmath>

namespace graphdrl {

void PaperReplayBuffer::push(const Transition& transition, std::span<const std::uint32_t> visits) {
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

void PaperReplayBuffer::save(CheckpointWriter& checkpoint) const {
  std::vector<std::int32_t> integers;
  std::vector<float> rewards;
  for (const Transition& t : transitions_) {
    integers.insert(integers.end(), {t.world, t.position, t.action, t.next_position, t.terminal});
    rewards.push_back(t.reward);
  }
  const auto size = static_cast<std::int64_t>(transitions_.size());
  checkpoint.add(TensorView("replay.visits", {size, static_cast<std::int64_t>(max_nodes_)}, std::span(visits_)));
  checkpoint.add("replay.transitions", {size, kIntegers}, std::move(integers));
  checkpoint.add("replay.rewards", std::move(rewards));
  checkpoint.add("replay.next", std::vector<std::int64_t>{static_cast<std::int64_t>(next_)});
}

void PaperReplayBuffer::restore(const Checkpoint& checkpoint, const std::function<bool(const Transition&)>& is_valid) {
  const std::int64_t size = checkpoint.size_of("replay.rewards");
  const auto rewards = checkpoint.get<float>("replay.rewards");
  const auto integers = checkpoint.get<std::int32_t>("replay.transitions", {size, kIntegers});
  const std::int64_t next = checkpoint.get<std::int64_t>("replay.next", {1}).front();
  const auto capacity = static_cast<std::int64_t>(capacity_);
  if (size > capacity) checkpoint.fail("the checkpoint's replay buffer is larger than the run's");
  if (next < 0 || next >= capacity || next > size) checkpoint.fail("bad place in the replay buffer");
  visits_ = checkpoint.get<std::uint16_t>("replay.visits", {size, static_cast<std::int64_t>(max_nodes_)});
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
    if (!is_valid(transitions_.back()) || !std::isfinite(rewards[i])) {
      checkpoint.fail("the replay buffer holds a transition of another world");
    }
  }
}

void append_transition(const PaperReplayBuffer& replay, std::size_t index, const PaperFeatureEncoder& encoder,
                       PaperMinibatch& batch) {
  const Transition& t = replay.transition(index);
  const Graph& graph = encoder.view().grid().graph();
  const std::size_t row = batch.x.size();
  const std::size_t values = static_cast<std::size_t>(graph.node_count()) * kPaperFeatureCount;
  batch.graphs.add(graph);
  batch.x.resize(row + values);
  batch.next_x.resize(row + values);
  const auto visits = replay.visits(index).first(graph.node_count());
  encoder.encode(t.position, visits, std::span(batch.x).subspan(row));
  batch.next_visits.assign(visits.begin(), visits.end());
  ++batch.next_visits[t.next_position];
  encoder.encode(t.next_position, std::span<const std::uint16_t>(batch.next_visits),
                 std::span(batch.next_x).subspan(row));
  batch.actions.push_back(t.action);
  batch.rewards.push_back(t.reward);
  batch.terminal.push_back(t.terminal);
}

void sample_minibatch(const PaperReplayBuffer& replay, std::span<const PaperFeatureEncoder> encoders, std::int64_t size,
                      Rng& rng, PaperMinibatch& batch) {
  batch.clear();
  for (std::int64_t i = 0; i < size; ++i) {
    const std::size_t index = rng.below(static_cast<std::uint32_t>(replay.size()));
    append_transition(replay, index, encoders[replay.transition(index).world], batch);
  }
}

}  // namespace graphdrl
