#include "graphdrl/train/torch/paper_stack.h"

#include <torch/torch.h>

#include <algorithm>
#include <utility>

#include "graphdrl/nn/paper_features.h"

namespace graphdrl {

namespace {
constexpr std::int64_t kLossLogRows = 64;
}  // namespace

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

  // With a stack of its own.
  StackedLearner(std::unique_ptr<PaperStack> stack, const PaperLearnerOptions& options, Rng& rng)
      : StackedLearner(*stack, 0, options, rng) {
    own_stack_ = std::move(stack);
  }

  void learn(const PaperMinibatch& batch, Rng& rng) override {
    PaperStack::Seat& seat = stack_.seats_[training_];
    seat.graphs = &batch.graphs;
    seat.x = batch.x;
    seat.next_x = batch.next_x;
    seat.batch = &batch;
    seat.keep_scale = draw_keep_scale(batch.graphs.graph_count(), kHiddenWidth, dropout_, rng);
    stack_.ask(training_, PaperStack::Request::kLearn);
  }

  std::vector<double> take_losses() override {
    const std::lock_guard lock(stack_.mutex_);
    return stack_.take_losses(training_);
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
  std::unique_ptr<PaperStack> own_stack_;
  PaperStack& stack_;
  int training_;
  double dropout_;
};

namespace {

// Of one of a stack's trainings.
class StackSource final : public LearnerSource {
 public:
  StackSource(std::shared_ptr<PaperStack> stack, int training) : stack_(std::move(stack)), training_(training) {}
  ~StackSource() override { stack_->leave(training_); }
  StackSource(const StackSource&) = delete;

  std::unique_ptr<PaperLearner> make(const std::string& /*device*/, const PaperLearnerOptions& options,
                                     Rng& rng) const override {
    return stack_->learner(training_, options, rng);
  }

 private:
  std::shared_ptr<PaperStack> stack_;
  int training_;
};

}  // namespace

PaperStack::PaperStack(torch::Device device, int trainings)
    : seats_(static_cast<std::size_t>(trainings)), present_(trainings), stream_(device) {
  torch::set_num_threads(1);  // so that sums on the CPU run in one order
}

std::unique_ptr<PaperLearner> PaperStack::learner(int training, const PaperLearnerOptions& options, Rng& rng) {
  return std::make_unique<StackedLearner>(*this, training, options, rng);
}

void PaperStack::begin(const PaperLearnerOptions& options) {
  if (graphs_) return;
  options_ = options;
  adam_ = {.learning_rate = options.learning_rate};
  at::globalContext().setAllowTF32CuBLAS(options.tf32);
  const auto all = static_cast<std::int64_t>(PaperParameters().values().size());
  const auto trainable = static_cast<std::int64_t>(PaperParameters::trainable_count());
  const DeviceStream::Scope scope(stream_);
  graphs_.emplace(stream_.device());
  const torch::TensorOptions on_device = torch::TensorOptions().device(stream_.device());
  values_ = torch::zeros({stack_size(), all}, on_device);
  target_values_ = torch::zeros({stack_size(), all}, on_device);
  first_ = torch::zeros({stack_size(), trainable}, on_device);
  second_ = torch::zeros({stack_size(), trainable}, on_device);
  steps_ = torch::zeros({stack_size(), 1}, on_device.dtype(torch::kFloat64));
  loss_log_ = torch::zeros({kLossLogRows, stack_size()}, on_device.dtype(torch::kFloat64));
  loss_log_row_ = torch::zeros({1}, on_device.dtype(torch::kInt64));
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
    const DeviceStream::Scope scope(stream_);
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

void PaperStack::move(const std::vector<int>& trainings) {
  Work& work = work_for(Request::kMove, trainings);
  send(work, trainings);
  const torch::Tensor q = work.q.to(torch::kCPU);  // waits
  const std::int64_t size = q.size(1) * q.size(2);
  for (const int training : trainings) {
    const std::span<float> out = seats_[training].q;
    std::copy_n(q.data_ptr<float>() + training * size, out.size(), out.begin());
  }
}

// Does not wait for the device.
void PaperStack::learn(const std::vector<int>& trainings) {
  if (learned_ - fetched_ == kLossLogRows) fetch_losses();
  send(work_for(Request::kLearn, trainings), trainings);
  for (const int training : trainings) seats_[training].log_rows.push_back(learned_ % kLossLogRows);
  ++learned_;
}

std::vector<double> PaperStack::take_losses(int training) {
  if (!seats_[training].log_rows.empty()) fetch_losses();
  return std::exchange(seats_[training].losses, {});
}

void PaperStack::fetch_losses() {
  const DeviceStream::Scope scope(stream_);
  const torch::Tensor log = loss_log_.to(torch::kCPU);
  const auto losses = log.accessor<double, 2>();
  for (int training = 0; training < std::ssize(seats_); ++training) {
    Seat& seat = seats_[training];
    for (const std::int64_t row : seat.log_rows) seat.losses.push_back(losses[row][training]);
    seat.log_rows.clear();
  }
  fetched_ = learned_;
}

// Graphs not seen before may change all shapes.
PaperStack::Work& PaperStack::work_for(Request request, const std::vector<int>& trainings) {
  const torch::Tensor known = graphs_->adjacent();
  for (const int training : trainings) {
    Seat& seat = seats_[training];
    for (int g = 0; g < seat.graphs->graph_count(); ++g) {
      const Graph& graph = seat.graphs->graph(g);
      if (!seat.graph_indices.contains(&graph)) seat.graph_indices[&graph] = graphs_->add(graph);
    }
  }
  if (!graphs_->adjacent().is_same(known)) {
    stream_.synchronize();
    works_.clear();
  }
  const std::int64_t batch = seats_[trainings.front()].graphs->graph_count();
  const auto [found, is_new] = works_.try_emplace({request, batch});
  Work& work = found->second;
  if (!is_new) return work;
  const torch::TensorOptions on_host = torch::TensorOptions().pinned_memory(!stream_.device().is_cpu());
  work.host = empty_inputs(request, batch, on_host);
  work.device = empty_inputs(request, batch, torch::TensorOptions().device(stream_.device()));
  if (request == Request::kMove) {
    work.q = torch::zeros({stack_size(), batch, kActionCount}, stream_.device());
    work.run = std::make_unique<DeviceStream::CapturedWork>([this, &work] { choose_values(work.device, work.q); });
  } else {
    work.run = std::make_unique<DeviceStream::CapturedWork>([this, &work] { learn_step(work.device); });
  }
  return work;
}

std::vector<torch::Tensor*> PaperStack::Inputs::all() {
  std::vector<torch::Tensor*> tensors = {&active, &graph_indices, &x};
  if (next_x.defined()) tensors.insert(tensors.end(), {&next_x, &keep_scale, &rewards, &not_terminal, &actions});
  return tensors;
}

PaperStack::Inputs PaperStack::empty_inputs(Request request, std::int64_t batch,
                                            const torch::TensorOptions& where) const {
  const std::vector<std::int64_t> features = {stack_size(), batch, graphs_->padded_nodes(), kPaperFeatureCount};
  Inputs inputs;
  inputs.active = torch::zeros({stack_size()}, where);
  inputs.graph_indices = torch::zeros({stack_size() * batch}, where.dtype(torch::kInt64));
  inputs.x = torch::zeros(features, where);
  if (request == Request::kMove) return inputs;
  inputs.next_x = torch::zeros(features, where);
  inputs.keep_scale = torch::zeros({stack_size(), batch, kHiddenWidth}, where);
  inputs.rewards = torch::zeros({stack_size(), batch}, where);
  inputs.not_terminal = torch::zeros({stack_size(), batch}, where);
  inputs.actions = torch::zeros({stack_size(), batch, 1}, where.dtype(torch::kInt64));
  return inputs;
}

// Padding of x has no edge and counts nowhere: it need not be cleared.
void PaperStack::fill(Inputs& host, const std::vector<int>& trainings) const {
  const bool learning = host.next_x.defined();
  const std::int64_t batch = host.x.size(1);
  const std::int64_t row = host.x.size(2) * host.x.size(3);  // of one graph's features
  host.active.zero_();
  for (const int training : trainings) {
    const Seat& seat = seats_[training];
    const std::int64_t first = training * batch;
    host.active.data_ptr<float>()[training] = 1;
    for (int g = 0; g < seat.graphs->graph_count(); ++g) {
      const Graph& graph = seat.graphs->graph(g);
      host.graph_indices.data_ptr<std::int64_t>()[first + g] = seat.graph_indices.at(&graph);
      const auto from = static_cast<std::ptrdiff_t>(seat.graphs->first_node(g)) * kPaperFeatureCount;
      const std::int64_t count = std::int64_t{graph.node_count()} * kPaperFeatureCount;
      std::copy_n(seat.x.begin() + from, count, host.x.data_ptr<float>() + (first + g) * row);
      if (learning) std::copy_n(seat.next_x.begin() + from, count, host.next_x.data_ptr<float>() + (first + g) * row);
    }
    if (!learning) continue;
    std::copy(seat.keep_scale.begin(), seat.keep_scale.end(), host.keep_scale.data_ptr<float>() + first * kHiddenWidth);
    for (std::int64_t i = 0; i < batch; ++i) {
      host.rewards.data_ptr<float>()[first + i] = seat.batch->rewards[i];
      host.not_terminal.data_ptr<float>()[first + i] = seat.batch->terminal[i] != 0 ? 0.0F : 1.0F;
      host.actions.data_ptr<std::int64_t>()[first + i] = seat.batch->actions[i];
    }
  }
}

// Copies what the trainings ask for to the device, and has it work on that.
void PaperStack::send(Work& work, const std::vector<int>& trainings) {
  work.sent.synchronize();  // what was sent before
  fill(work.host, trainings);
  const std::vector<torch::Tensor*> from = work.host.all();
  const std::vector<torch::Tensor*> to = work.device.all();
  for (std::size_t i = 0; i < from.size(); ++i) to[i]->copy_(*from[i], /*non_blocking=*/true);
  work.sent.record(stream_);
  work.run->run(stream_);
}

StackedGraphs PaperStack::graphs_of(const Inputs& inputs) const {
  const torch::Tensor node_mask = graphs_->node_mask().index_select(0, inputs.graph_indices);
  return {
      .adjacent = graphs_->adjacent().index_select(0, inputs.graph_indices),
      .node_mask = node_mask.view({stack_size(), -1, graphs_->padded_nodes(), 1}) * inputs.active.view({-1, 1, 1, 1})};
}

void PaperStack::choose_values(const Inputs& inputs, const torch::Tensor& q) {
  const torch::NoGradGuard no_grad;
  q.copy_(stacked_q_values(graphs_of(inputs), inputs.x, online_));
}

void PaperStack::learn_step(const Inputs& inputs) {
  const StackedGraphs graphs = graphs_of(inputs);
  torch::Tensor targets;
  {
    const torch::NoGradGuard no_grad;
    const torch::Tensor next_q = stacked_q_values(graphs, inputs.next_x, target_);
    const torch::Tensor chooser = options_.double_dqn ? stacked_q_values(graphs, inputs.next_x, online_) : next_q;
    const torch::Tensor value = next_q.gather(2, chooser.argmax(2, /*keepdim=*/true)).squeeze(2);
    targets = inputs.rewards + options_.discount * value * inputs.not_terminal;
  }
  const torch::Tensor q = stacked_q_values(graphs, inputs.x, online_, inputs.keep_scale, inputs.active);
  const torch::Tensor chosen = q.gather(2, inputs.actions).squeeze(2);
  const torch::Tensor losses = (chosen - targets).square().mean(1);  // L(θ) [paper, eq. 5], [S]
  adam_step(inputs.active, stacked_gradient((losses * inputs.active).sum(), online_));
  const torch::NoGradGuard no_grad;
  loss_log_.index_copy_(0, loss_log_row_, losses.detach().to(torch::kFloat64).unsqueeze(0));
  loss_log_row_.add_(1).remainder_(kLossLogRows);
}

// Adam and the soft update, of the trainings that are active [S]. gradient: [S, trainable].
void PaperStack::adam_step(const torch::Tensor& active, const torch::Tensor& gradient) {
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
  const DeviceStream::Scope scope(stream_);
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
  const DeviceStream::Scope scope(stream_);
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

std::vector<std::unique_ptr<LearnerSource>> stack_sources(const std::string& device, int trainings) {
  const auto stack = std::make_shared<PaperStack>(torch::Device(device), trainings);
  std::vector<std::unique_ptr<LearnerSource>> sources;
  for (int training = 0; training < trainings; ++training) {
    sources.push_back(std::make_unique<StackSource>(stack, training));
  }
  return sources;
}

std::unique_ptr<PaperLearner> DeviceLearners::make(const std::string& device, const PaperLearnerOptions& options,
                                                   Rng& rng) const {
  if (device == "cpu") return LearnerSource::make(device, options, rng);
  return std::make_unique<StackedLearner>(std::make_unique<PaperStack>(torch::Device(device), 1), options, rng);
}

std::vector<std::unique_ptr<LearnerSource>> DeviceLearners::make_together(const std::string& device,
                                                                          int trainings) const {
  if (device == "cpu") return {};
  return stack_sources(device, trainings);
}

}  // namespace graphdrl
