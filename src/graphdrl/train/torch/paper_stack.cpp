#include "graphdrl/train/torch/paper_stack.h"

#include <torch/torch.h>

#include <algorithm>
#include <cmath>

#include "graphdrl/base/error.h"
#include "graphdrl/nn/paper_features.h"
#include "graphdrl/train/paper_q_network.h"

namespace graphdrl {

// The learner that one training sees.
class StackedLearner final : public PaperLearner {
 public:
  StackedLearner(PaperStack& stack, int training, const PaperLearnerOptions& options, Rng& rng)
      : stack_(stack), training_(training), dropout_(options.dropout) {
    PaperState state{
        .online = PaperParameters(rng), .target = {}, .adam = AdamState(PaperParameters::trainable_count())};
    state.target = state.online;
    const std::lock_guard lock(stack_.mutex_);
    stack_.begin(options);
    stack_.set_state_of(training_, state);
  }

  double learn(const PaperMinibatch& batch, Rng& rng) override {
    PaperStack::Seat& seat = stack_.seats_[training_];
    seat.graphs = &batch.graphs;
    seat.x = batch.x;
    seat.next_x = batch.next_x;
    seat.batch = &batch;
    seat.keep_scale = draw_keep_scale(batch.graphs.graph_count(), kHiddenWidth, dropout_, rng);
    stack_.ask(training_, PaperStack::Request::kLearn);
    return seat.loss;
  }

  void q_values(const GraphBatch& batch, std::span<const float> x, std::span<float> q) override {
    PaperStack::Seat& seat = stack_.seats_[training_];
    seat.graphs = &batch;
    seat.x = x;
    seat.q = q;
    stack_.ask(training_, PaperStack::Request::kMove);
  }

  PaperState state() const override {
    const std::lock_guard lock(stack_.mutex_);
    return stack_.state_of(training_);
  }

  void set_state(const PaperState& state) override {
    const std::lock_guard lock(stack_.mutex_);
    stack_.set_state_of(training_, state);
  }

 private:
  PaperStack& stack_;
  int training_;
  double dropout_;
};

PaperStack::PaperStack(torch::Device device, int trainings)
    : seats_(static_cast<std::size_t>(trainings)), present_(trainings), device_(device) {
  torch::set_num_threads(1);  // so that sums on the CPU run in one order
}

MakePaperLearner PaperStack::learner_of(int training) {
  return [this, training](const std::string&, const PaperLearnerOptions& options, Rng& rng) {
    return std::make_unique<StackedLearner>(*this, training, options, rng);
  };
}

void PaperStack::begin(const PaperLearnerOptions& options) {
  if (begun_) return;
  begun_ = true;
  options_ = options;
  adam_ = {.learning_rate = options.learning_rate};
  const auto trainings = static_cast<std::int64_t>(seats_.size());
  const auto all = static_cast<std::int64_t>(PaperParameters().values().size());
  const auto trainable = static_cast<std::int64_t>(PaperParameters::trainable_count());
  const torch::TensorOptions on_device = torch::TensorOptions().device(device_);
  values_ = torch::zeros({trainings, all}, on_device);
  target_values_ = torch::zeros({trainings, all}, on_device);
  first_ = torch::zeros({trainings, trainable}, on_device);
  second_ = torch::zeros({trainings, trainable}, on_device);
  steps_ = torch::zeros({trainings, 1}, on_device.dtype(torch::kFloat64));
  online_ = stacked_tensors(values_, /*learning=*/true);
  target_ = stacked_tensors(target_values_, /*learning=*/false);
}

void PaperStack::leave(int training) {
  const std::lock_guard lock(mutex_);
  seats_[training] = {};
  --present_;
  serve_where_all_wait();
}

void PaperStack::ask(int training, Request request) {
  std::unique_lock lock(mutex_);
  if (failure_) std::rethrow_exception(failure_);
  seats_[training].request = request;
  serve_where_all_wait();
  served_.wait(lock, [&] { return seats_[training].request == Request::kNone || failure_; });
  if (failure_) std::rethrow_exception(failure_);
}

// Moves come first: a training that waits to learn has made its move.
void PaperStack::serve_where_all_wait() {
  std::vector<int> moving;
  std::vector<int> learning;
  for (int training = 0; training < std::ssize(seats_); ++training) {
    if (seats_[training].request == Request::kMove) moving.push_back(training);
    if (seats_[training].request == Request::kLearn) learning.push_back(training);
  }
  if (failure_ || (moving.empty() && learning.empty()) || std::ssize(moving) + std::ssize(learning) < present_) return;
  try {
    const std::vector<int>& chosen = moving.empty() ? learning : moving;
    if (moving.empty()) {
      learn(chosen);
    } else {
      move(chosen);
    }
    for (const int training : chosen) seats_[training].request = Request::kNone;
  } catch (...) {
    failure_ = std::current_exception();
  }
  served_.notify_all();
}

std::int64_t PaperStack::place_of(int training, const Graph& graph) {
  std::map<const Graph*, std::int64_t>& places = seats_[training].places;
  if (const auto found = places.find(&graph); found != places.end()) return found->second;
  torch::Tensor adjacent = torch::zeros({graph.node_count(), graph.node_count()});
  for (NodeId node = 0; node < graph.node_count(); ++node) {
    for (const NodeId next : graph.neighbours(node)) adjacent[node][next] += 1;
  }
  const std::int64_t place = std::ssize(known_);
  places[&graph] = place;
  known_.push_back(adjacent);
  largest_ = std::max<std::int64_t>(largest_, graph.node_count());
  std::vector<torch::Tensor> padded;
  std::vector<torch::Tensor> counts;
  for (const torch::Tensor& one : known_) {
    const std::int64_t padding = largest_ - one.size(0);
    padded.push_back(torch::constant_pad_nd(one, {0, padding, 0, padding}));
    counts.push_back(torch::constant_pad_nd(torch::ones({one.size(0), 1}), {0, 0, 0, padding}));
  }
  all_adjacent_ = torch::stack(padded).to(device_);
  all_counts_ = torch::stack(counts).to(device_);
  return place;
}

StackedGraphs PaperStack::graphs_of(const std::vector<int>& trainings, std::int64_t batch) {
  const auto all = static_cast<std::int64_t>(seats_.size());
  std::vector<std::int64_t> places(static_cast<std::size_t>(all * batch), 0);
  std::vector<float> there(places.size(), 0);
  for (const int training : trainings) {
    const GraphBatch& graphs = *seats_[training].graphs;
    for (int g = 0; g < graphs.graph_count(); ++g) {
      const std::size_t i = static_cast<std::size_t>(training * batch + g);
      places[i] = place_of(training, graphs.graph(g));
      there[i] = 1;
    }
  }
  const torch::Tensor index = torch::tensor(places).to(device_);
  const torch::Tensor present = torch::tensor(there).to(device_).view({all, batch, 1, 1});
  return {.adjacent = all_adjacent_.index_select(0, index),
          .counts = all_counts_.index_select(0, index).view({all, batch, largest_, 1}) * present};
}

torch::Tensor PaperStack::stacked(const std::vector<int>& trainings, std::span<const float> Seat::*x,
                                  std::int64_t batch) const {
  const auto all = static_cast<std::int64_t>(seats_.size());
  torch::Tensor out = torch::zeros({all, batch, largest_, kPaperFeatureCount});
  float* const values = out.data_ptr<float>();
  for (const int training : trainings) {
    const GraphBatch& graphs = *seats_[training].graphs;
    const std::span<const float> rows = seats_[training].*x;
    for (int g = 0; g < graphs.graph_count(); ++g) {
      const auto first = static_cast<std::size_t>(graphs.first_node(g)) * kPaperFeatureCount;
      const auto count = static_cast<std::size_t>(graphs.graph(g).node_count()) * kPaperFeatureCount;
      std::copy_n(rows.data() + first, count, values + (training * batch + g) * largest_ * kPaperFeatureCount);
    }
  }
  return out.to(device_);
}

void PaperStack::move(const std::vector<int>& trainings) {
  const torch::NoGradGuard no_grad;
  const std::int64_t batch = seats_[trainings.front()].graphs->graph_count();
  const StackedGraphs graphs = graphs_of(trainings, batch);
  const torch::Tensor q =
      stacked_q_values(graphs, stacked(trainings, &Seat::x, batch), online_).to(torch::kCPU).contiguous();
  for (const int training : trainings) {
    const std::span<float> out = seats_[training].q;
    std::copy_n(q.data_ptr<float>() + training * batch * kActionCount, out.size(), out.begin());
  }
}

void PaperStack::learn(const std::vector<int>& trainings) {
  const auto all = static_cast<std::int64_t>(seats_.size());
  const std::int64_t batch = seats_[trainings.front()].graphs->graph_count();
  const StackedGraphs graphs = graphs_of(trainings, batch);
  std::vector<float> is_active(seats_.size(), 0);
  std::vector<float> keep(static_cast<std::size_t>(all * batch * kHiddenWidth), 0);
  std::vector<float> rewards(static_cast<std::size_t>(all * batch), 0);
  std::vector<float> goes_on(rewards.size(), 0);
  std::vector<std::int64_t> actions(rewards.size(), 0);
  for (const int training : trainings) {
    const Seat& seat = seats_[training];
    is_active[training] = 1;
    std::copy(seat.keep_scale.begin(), seat.keep_scale.end(), keep.begin() + training * batch * kHiddenWidth);
    for (std::int64_t i = 0; i < batch; ++i) {
      rewards[training * batch + i] = seat.batch->rewards[i];
      goes_on[training * batch + i] = seat.batch->terminal[i] != 0 ? 0.0F : 1.0F;
      actions[training * batch + i] = seat.batch->actions[i];
    }
  }
  const auto on_device = [&](const auto& values, std::vector<std::int64_t> shape) {
    return torch::tensor(values).view(shape).to(device_);
  };
  const torch::Tensor active = on_device(is_active, {all});
  torch::Tensor targets;
  {
    const torch::NoGradGuard no_grad;
    const torch::Tensor next_x = stacked(trainings, &Seat::next_x, batch);
    const torch::Tensor next_q = stacked_q_values(graphs, next_x, target_);
    const torch::Tensor chooser = options_.double_dqn ? stacked_q_values(graphs, next_x, online_) : next_q;
    const torch::Tensor value = next_q.gather(2, chooser.argmax(2, /*keepdim=*/true)).squeeze(2);
    targets = on_device(rewards, {all, batch}) + options_.discount * value * on_device(goes_on, {all, batch});
  }
  const torch::Tensor q = stacked_q_values(graphs, stacked(trainings, &Seat::x, batch), online_,
                                           on_device(keep, {all, batch, kHiddenWidth}), active);
  const torch::Tensor chosen = q.gather(2, on_device(actions, {all, batch, 1})).squeeze(2);
  const torch::Tensor losses = (chosen - targets).square().mean(1);  // L(θ) [paper, eq. 5], [S]
  step(active, stacked_gradient((losses * active).sum(), online_));
  const torch::Tensor known = losses.detach().to(torch::kCPU, torch::kFloat64);
  for (const int training : trainings) seats_[training].loss = known[training].item<double>();
}

// Adam and the soft update, of the trainings that are active [S]. gradient: [S, trainable].
void PaperStack::step(const torch::Tensor& active, const torch::Tensor& gradient) {
  const torch::NoGradGuard no_grad;
  const torch::Tensor mask = active.view({-1, 1});
  steps_ += mask;
  const torch::Tensor clamped = gradient.clamp(-adam_.clamp, adam_.clamp);
  first_.lerp_(clamped, ((1 - adam_.beta1) * mask).expand_as(first_));
  second_.lerp_(clamped.square(), ((1 - adam_.beta2) * mask).expand_as(second_));
  const torch::Tensor t = steps_.clamp_min(1);
  const torch::Tensor root = (1 - torch::pow(adam_.beta2, t)).sqrt().to(torch::kFloat32);
  const torch::Tensor rate = (adam_.learning_rate / (1 - torch::pow(adam_.beta1, t))).to(torch::kFloat32);
  torch::Tensor trainable = values_.narrow(1, 0, first_.size(1));
  trainable.sub_(mask * rate * first_ / (second_.sqrt() / root + adam_.epsilon));
  target_values_.lerp_(values_, (options_.soft_update * mask).expand_as(values_));  // [paper, eq. 6]
}

PaperState PaperStack::state_of(int training) {
  const auto copy_out = [&](const torch::Tensor& all, std::span<float> values) {
    const torch::Tensor host = all[training].to(torch::kCPU).contiguous();
    std::copy_n(host.data_ptr<float>(), values.size(), values.begin());
  };
  PaperState state{.online = {}, .target = {}, .adam = AdamState(PaperParameters::trainable_count())};
  copy_out(values_, state.online.values());
  copy_out(target_values_, state.target.values());
  copy_out(first_, state.adam.exp_avg);
  copy_out(second_, state.adam.exp_avg_sq);
  state.adam.steps = static_cast<std::int64_t>(steps_[training].item<double>());
  return state;
}

void PaperStack::set_state_of(int training, const PaperState& state) {
  const torch::NoGradGuard no_grad;
  const auto copy_in = [&](torch::Tensor& all, std::span<const float> values) {
    all[training].copy_(
        torch::from_blob(const_cast<float*>(values.data()), {static_cast<std::int64_t>(values.size())}));
  };
  copy_in(values_, state.online.values());
  copy_in(target_values_, state.target.values());
  copy_in(first_, state.adam.exp_avg);
  copy_in(second_, state.adam.exp_avg_sq);
  steps_[training] = static_cast<double>(state.adam.steps);
}

std::unique_ptr<PaperLearnerGroup> make_paper_stack(const std::string& device, int trainings) {
  if (device != "cpu" && !torch::cuda::is_available()) {
    throw Error({.what = "this LibTorch finds no CUDA device", .expected = "cpu", .got = device, .where = "--device"});
  }
  return std::make_unique<PaperStack>(torch::Device(device), trainings);
}

}  // namespace graphdrl
