#include "graphdrl/planners/paper_policy.h"

#include <algorithm>

#include "graphdrl/base/error.h"

namespace graphdrl {
namespace {

constexpr std::int64_t kMaxBatchNodes = 8192;  // about 32 MB of working memory

}  // namespace

PaperPolicy::PaperPolicy(PaperParameters parameters) : parameters_(std::move(parameters)) {
  network_.set_parameters(parameters_);
}

const PaperFeatureEncoder& PaperPolicy::encoder_for(const View& view) {
  if (!encoder_ || !(encoder_->view() == view)) encoder_.emplace(view, parameters_.wall());
  return *encoder_;
}

void PaperPolicy::q_values(std::span<const Observation> observations, std::span<float> q) {
  while (!observations.empty()) {
    std::size_t count = 0;
    for (std::int64_t nodes = 0; count < observations.size(); ++count) {
      nodes += observations[count].view().node_count();
      if (count > 0 && nodes > kMaxBatchNodes) break;
    }
    q_values_of_block(observations.first(count), q.first(count * kActionCount));
    observations = observations.subspan(count);
    q = q.subspan(count * kActionCount);
  }
}

void PaperPolicy::q_values_of_block(std::span<const Observation> observations, std::span<float> q) {
  batch_.clear();
  for (const Observation& observation : observations) {
    if (observation.action_space != ActionSpace::kDirections) {
      throw Error(
          {.what = "the paper's network chooses directions, on grid maps only", .where = observation.view().name()});
    }
    batch_.add(observation.view().grid().graph());
  }
  features_.resize(static_cast<std::size_t>(batch_.node_count()) * kPaperFeatureCount);
  std::span<float> rest = features_;
  for (const Observation& observation : observations) {
    const std::size_t size = static_cast<std::size_t>(observation.view().node_count()) * kPaperFeatureCount;
    encoder_for(observation.view()).encode(observation.position, observation.visits, rest.first(size));
    rest = rest.subspan(size);
  }
  network_.q_values(batch_, features_, q);
}

void PaperPolicy::act(std::span<const Observation> observations, std::span<int> actions, const Clock& /*clock*/) {
  q_.resize(observations.size() * kActionCount);
  q_values(observations, q_);
  for (std::size_t i = 0; i < observations.size(); ++i) {
    actions[i] = argmax(std::span(q_).subspan(i * kActionCount, kActionCount));
  }
}

int argmax(std::span<const float> values) {
  return static_cast<int>(std::max_element(values.begin(), values.end()) - values.begin());
}

}  // namespace graphdrl
