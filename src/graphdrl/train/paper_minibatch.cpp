#include "graphdrl/train/paper_minibatch.h"

namespace graphdrl {

void PaperMinibatch::clear() {
  graphs.clear();
  x.clear();
  next_x.clear();
  actions.clear();
  rewards.clear();
  terminal.clear();
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

std::vector<float> draw_keep_scale(int rows, int width, double p, Rng& rng) {
  std::vector<float> scale(static_cast<std::size_t>(rows) * width);
  for (float& value : scale) value = rng.uniform() < p ? 0.0f : static_cast<float>(1 / (1 - p));
  return scale;
}

}  // namespace graphdrl
