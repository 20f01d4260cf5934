#include "graphdrl/train/explorer_learner.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "graphdrl/base/parallel.h"
#include "graphdrl/train/minibatch.h"

namespace graphdrl {
namespace {

// Not searched over; docs/explorer.md tells which parts of the loss pay.
constexpr double kHuberKnee = 2;       // nodes
constexpr double kFarShort = 4;        // nodes: where even the best falls this short, values count half
constexpr double kLeastShare = 1e-30;  // keeps the logarithm of a share finite

double huber(double error) {
  const double size = std::abs(error);
  return size < kHuberKnee ? error * error / 2 : kHuberKnee * (size - kHuberKnee / 2);
}

double huber_slope(double error) {
  return std::clamp(error, -kHuberKnee, kHuberKnee);
}

// The labelled first visits of one state.
struct Labelled {
  std::vector<std::size_t> visits;  // places in the batch
  double mean_label = 0;
  double mean_shortfall = 0;
  double least_label = 0;
  double least_shortfall = 0;
};

// Calls visit(labelled) for every state that has a label. Visits of a state stand together.
template <typename Visit>
void for_each_state(const ExplorerBatch& batch, std::span<const float> label, std::span<const float> shortfall,
                    const Visit& visit) {
  Labelled state;
  for (std::size_t v = 0; v < label.size();) {
    state.visits.clear();
    const int index = batch.state[v];
    for (; v < label.size() && batch.state[v] == index; ++v) {
      if (!std::isnan(label[v])) state.visits.push_back(v);
    }
    if (state.visits.empty()) continue;
    state.mean_label = state.mean_shortfall = 0;
    state.least_label = label[state.visits[0]];
    state.least_shortfall = shortfall[state.visits[0]];
    const auto count = static_cast<double>(state.visits.size());
    for (const std::size_t at : state.visits) {
      state.mean_label += label[at] / count;
      state.mean_shortfall += shortfall[at] / count;
      state.least_label = std::min<double>(state.least_label, label[at]);
      state.least_shortfall = std::min<double>(state.least_shortfall, shortfall[at]);
    }
    visit(state);
  }
}

}  // namespace

double explorer_loss(const ExplorerBatch& batch, std::span<const float> label, std::span<const float> shortfall,
                     double ranking, std::span<float> grad) {
  const double states = batch.graphs.graph_count();
  double loss = 0;
  std::fill(grad.begin(), grad.end(), 0.0f);
  for_each_state(batch, label, shortfall, [&](const Labelled& state) {
    const auto count = static_cast<double>(state.visits.size());
    const double value_weight = 1 / (1 + std::max(0.0, state.least_label) / kFarShort) / count / states;
    const double deviation_weight = 1 / count / states;
    double mean_slope = 0;
    double label_sum = 0;
    double shortfall_sum = 0;
    const auto odds = [](double above_least) { return std::exp(-above_least / kRankingTemperature); };
    for (const std::size_t v : state.visits) {
      const double deviation = (double{shortfall[v]} - state.mean_shortfall) - (double{label[v]} - state.mean_label);
      mean_slope += huber_slope(deviation) / count;
      label_sum += odds(label[v] - state.least_label);
      shortfall_sum += odds(shortfall[v] - state.least_shortfall);
    }
    for (const std::size_t v : state.visits) {
      const double error = double{shortfall[v]} - label[v];
      const double deviation = error - (state.mean_shortfall - state.mean_label);
      const double goal = odds(label[v] - state.least_label) / label_sum;
      const double share = odds(shortfall[v] - state.least_shortfall) / shortfall_sum;
      loss += value_weight * huber(error) + deviation_weight * huber(deviation) -
              ranking / states * goal * std::log(std::max(share, kLeastShare));
      grad[v] = static_cast<float>(value_weight * huber_slope(error) +
                                   deviation_weight * (huber_slope(deviation) - mean_slope) +
                                   ranking / states * (goal - share) / kRankingTemperature);
    }
  });
  return loss;
}

ExplorerLearner::ExplorerLearner(double ranking, Rng& rng, Ranks& ranks)
    : ranking_(ranking), ranks_(ranks), parameters_(rng), adam_(parameters_.values().size()) {}

void ExplorerLearner::set_state(const ExplorerParameters& parameters, AdamState adam) {
  parameters_ = parameters;
  adam_ = std::move(adam);
}

double ExplorerLearner::learn(std::span<const Lesson* const> lessons, double rate) {
  workers_.resize(static_cast<std::size_t>(threads()));
  for (Worker& worker : workers_) worker.network.set_parameters(parameters_);
  const std::size_t count = parameters_.values().size();
  sum_.resize(count + 2);
  sum_over_minibatch(
      ranks_, static_cast<int>(lessons.size()),
      [&](int worker, int begin, int end, std::span<float> sum) {
        const double share = static_cast<double>(end - begin) / static_cast<double>(lessons.size());
        const auto [loss, regret] = compute_gradient(lessons.subspan(begin, end - begin), share, workers_[worker]);
        std::ranges::copy(std::as_const(workers_[worker].grad).values(), sum.begin());
        sum[count] = static_cast<float>(loss);
        sum[count + 1] = static_cast<float>(regret);
      },
      sum_);
  regret_ = sum_[count + 1];
  adam_.step(std::span(sum_).first(count), rate, parameters_.values());
  return sum_[count];
}

// share: of the minibatch.
ExplorerLearner::Losses ExplorerLearner::compute_gradient(std::span<const Lesson* const> lessons, double share,
                                                          Worker& worker) const {
  auto& [network, scratch, batch, grad, label, shortfall, grad_shortfall] = worker;
  batch.clear();
  label.clear();
  for (const Lesson* const lesson : lessons) {
    lesson->append_to(batch, scratch);
    label.insert(label.end(), lesson->shortfall.begin(), lesson->shortfall.end());
  }
  shortfall.resize(label.size());
  grad_shortfall.resize(label.size());
  network.forward(batch, shortfall, /*keep=*/true);
  Losses losses{.loss = share * explorer_loss(batch, label, shortfall, ranking_, grad_shortfall), .regret = 0};
  for (float& slope : grad_shortfall) slope *= static_cast<float>(share);
  for_each_state(batch, label, shortfall, [&, &all_shortfall = shortfall, &all_label = label](const Labelled& state) {
    const std::size_t choice =
        *std::min_element(state.visits.begin(), state.visits.end(),
                          [&](std::size_t a, std::size_t b) { return all_shortfall[a] < all_shortfall[b]; });
    losses.regret += share * (all_label[choice] - state.least_label) / static_cast<double>(lessons.size());
  });
  network.backward(batch, grad_shortfall, grad);
  return losses;
}

}  // namespace graphdrl
