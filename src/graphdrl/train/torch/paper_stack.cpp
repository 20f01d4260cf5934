#include "graphdrl/train/torch/paper_stack.h"

#include <torch/torch.h>

#include <algorithm>
#include <condition_variable>
#include <map>
#include <mutex>
#include <optional>
#include <utility>

#include "graphdrl/nn/vector_math.h"
#include "graphdrl/train/torch/device_stream.h"
#include "graphdrl/train/torch/paper_stacked_network.h"

namespace graphdrl {
namespace {

constexpr std::int64_t kLossLogRows = 64;

// REQUIRES: all trainings, numbered from 0 up, have the same options and batch size.
class PaperStack {
 public:
  // What a training waits for.
  enum class Request { kNone, kMove, kLearn };
  struct Seat {
    Request request = Request::kNone;
    const GraphBatch* graphs = nullptr;
    std::span<const float> x;       // [N, F]
    std::span<const float> next_x;  // [N, F], to learn
    const PaperMinibatch* batch = nullptr;
    std::vector<float> keep_scale;                       // [B, 256]
    std::span<float> q;                                  // [B, A], of a move
    std::vector<std::int64_t> log_rows;                  // its rows of loss_log_ that are not fetched yet
    std::vector<double> losses;                          // not taken yet
    std::map<const Graph*, std::int64_t> graph_indices;  // of its graphs among those known, while it is there
  };

  PaperStack(torch::Device device, int trainings)
      : seats_(static_cast<std::size_t>(trainings)), present_(trainings), stream_(device) {
    torch::set_num_threads(1);  // so that sums on the CPU run in one order
  }

  // Before the first training begins; later calls change nothing.
  void begin(const PaperLearnerOptions& options) {
    const std::lock_guard lock(mutex_);
    if (graphs_) return;
    options_ = options;
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

  // That training asks for nothing more. Must be called once for each, or the others wait for ever.
  void leave(int training) {
    const std::lock_guard lock(mutex_);
    seats_[training] = {};
    --present_;
    serve_where_all_wait();
  }

  // Its own; the stack reads it while the training waits in ask().
  Seat& seat(int training) { return seats_[training]; }

  // Waits until it is done.
  void ask(int training, Request request) {
    std::unique_lock lock(mutex_);
    if (failure_) std::rethrow_exception(failure_);
    seats_[training].request = request;
    serve_where_all_wait();
    served_.wait(lock, [&] { return seats_[training].request == Request::kNone || failure_; });
    if (failure_) std::rethrow_exception(failure_);
  }

  std::vector<double> take_losses(int training) {
    const std::lock_guard lock(mutex_);
    if (!seats_[training].log_rows.empty()) fetch_losses();
    return std::exchange(seats_[training].losses, {});
  }

  PaperState state_of(int training) {
    const std::lock_guard lock(mutex_);
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

  void set_state_of(int training, const PaperState& state) {
    const std::lock_guard lock(mutex_);
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

 private:
  // What all seats ask for, on the host and on the device. Those of seats that ask for nothing are old, and count
  // nowhere.
  struct Inputs {
    torch::Tensor active;         // [S]: 1 where a training asks, else 0
    torch::Tensor graph_indices;  // [S * B] int64, among the known graphs
    torch::Tensor x;              // [S, B, n, F]
    // To learn:
    torch::Tensor next_x;        // [S, B, n, F]
    torch::Tensor keep_scale;    // [S, B, 256]
    torch::Tensor rewards;       // [S, B]
    torch::Tensor not_terminal;  // [S, B]: 0 where the next state is terminal, else 1
    torch::Tensor actions;       // [S, B, 1] int64

    std::vector<torch::Tensor*> all() {
      std::vector<torch::Tensor*> tensors = {&active, &graph_indices, &x};
      if (next_x.defined()) tensors.insert(tensors.end(), {&next_x, &keep_scale, &rewards, &not_terminal, &actions});
      return tensors;
    }
  };
  // Reused for every request of one kind and batch size.
  struct Work {
    Inputs host;
    Inputs device;
    torch::Tensor q;  // [S, B, A], of a move
    DeviceStream::Event sent;
    std::unique_ptr<DeviceStream::CapturedWork> run;
  };

  // Moves come first: a training that waits to learn has made its move.
  void serve_where_all_wait() {
    std::vector<int> moving;
    std::vector<int> learning;
    for (int training = 0; training < std::ssize(seats_); ++training) {
      if (seats_[training].request == Request::kMove) moving.push_back(training);
      if (seats_[training].request == Request::kLearn) learning.push_back(training);
    }
    const auto waiting = std::ssize(moving) + std::ssize(learning);
    if (failure_ || waiting == 0 || waiting < present_) return;
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

  void move(const std::vector<int>& trainings) {
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
  void learn(const std::vector<int>& trainings) {
    if (learned_ - fetched_ == kLossLogRows) fetch_losses();
    send(work_for(Request::kLearn, trainings), trainings);
    for (const int training : trainings) seats_[training].log_rows.push_back(learned_ % kLossLogRows);
    ++learned_;
  }

  void fetch_losses() {
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
  Work& work_for(Request request, const std::vector<int>& trainings) {
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

  Inputs empty_inputs(Request request, std::int64_t batch, const torch::TensorOptions& where) const {
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
  void fill(Inputs& host, const std::vector<int>& trainings) const {
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
      std::copy(seat.keep_scale.begin(), seat.keep_scale.end(),
                host.keep_scale.data_ptr<float>() + first * kHiddenWidth);
      for (std::int64_t i = 0; i < batch; ++i) {
        host.rewards.data_ptr<float>()[first + i] = seat.batch->rewards[i];
        host.not_terminal.data_ptr<float>()[first + i] = seat.batch->terminal[i] != 0 ? 0.0F : 1.0F;
        host.actions.data_ptr<std::int64_t>()[first + i] = seat.batch->actions[i];
      }
    }
  }

  // Copies what the trainings ask for to the device, and has it work on that.
  void send(Work& work, const std::vector<int>& trainings) {
    work.sent.synchronize();  // what was sent before
    fill(work.host, trainings);
    const std::vector<torch::Tensor*> from = work.host.all();
    const std::vector<torch::Tensor*> to = work.device.all();
    for (std::size_t i = 0; i < from.size(); ++i) to[i]->copy_(*from[i], /*non_blocking=*/true);
    work.sent.record(stream_);
    work.run->run(stream_);
  }

  StackedGraphs graphs_of(const Inputs& inputs) const {
    const torch::Tensor node_mask = graphs_->node_mask().index_select(0, inputs.graph_indices);
    return {.adjacent = graphs_->adjacent().index_select(0, inputs.graph_indices),
            .node_mask =
                node_mask.view({stack_size(), -1, graphs_->padded_nodes(), 1}) * inputs.active.view({-1, 1, 1, 1})};
  }

  void choose_values(const Inputs& inputs, const torch::Tensor& q) {
    const torch::NoGradGuard no_grad;
    q.copy_(stacked_q_values(graphs_of(inputs), inputs.x, online_));
  }

  void learn_step(const Inputs& inputs) {
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
  void adam_step(const torch::Tensor& active, const torch::Tensor& gradient) {
    const torch::NoGradGuard no_grad;
    const torch::Tensor mask = active.view({-1, 1});
    steps_ += mask;
    const torch::Tensor clamped = gradient.clamp(-kGradientClamp, kGradientClamp);
    first_.lerp_(clamped, ((1 - kAdamBeta1) * mask).expand_as(first_));
    second_.lerp_(clamped.square(), ((1 - kAdamBeta2) * mask).expand_as(second_));
    const torch::Tensor t = steps_.clamp_min(1);
    const torch::Tensor root = (1 - torch::pow(kAdamBeta2, t)).sqrt().to(torch::kFloat32);
    const torch::Tensor rate = (options_.learning_rate / (1 - torch::pow(kAdamBeta1, t))).to(torch::kFloat32);
    torch::Tensor trainable = values_.narrow(1, 0, first_.size(1));
    trainable.sub_(mask * rate * first_ / (second_.sqrt() / root + kAdamEpsilon));
    target_values_.lerp_(values_, (options_.soft_update * mask).expand_as(values_));  // [paper, eq. 6]
  }

  std::int64_t stack_size() const { return static_cast<std::int64_t>(seats_.size()); }

  std::mutex mutex_;
  std::condition_variable served_;
  std::vector<Seat> seats_;
  int present_;
  std::exception_ptr failure_;

  DeviceStream stream_;
  PaperLearnerOptions options_;
  torch::Tensor values_;         // [S, all]
  torch::Tensor target_values_;  // [S, all]
  torch::Tensor first_;          // [S, trainable], as the next
  torch::Tensor second_;
  torch::Tensor steps_;  // [S, 1] float64, of Adam
  NamedTensors online_;
  NamedTensors target_;

  // Losses stay on the device until a training asks for its own.
  torch::Tensor loss_log_;      // [rows, S] float64, written in turn
  torch::Tensor loss_log_row_;  // [1] int64, the next
  std::int64_t learned_ = 0;    // steps
  std::int64_t fetched_ = 0;    // of them

  std::optional<KnownGraphs> graphs_;                       // from begin() on
  std::map<std::pair<Request, std::int64_t>, Work> works_;  // by kind and batch size
};

// The learner that one training sees.
class StackedLearner final : public PaperLearner {
 public:
  StackedLearner(std::shared_ptr<PaperStack> stack, int training, const PaperLearnerOptions& options, Rng& rng)
      : stack_(std::move(stack)), training_(training), dropout_(options.dropout) {
    stack_->begin(options);
    stack_->set_state_of(training_, PaperState::begin(rng));
  }

  void learn(const PaperMinibatch& batch, Rng& rng) override {
    PaperStack::Seat& seat = stack_->seat(training_);
    seat.graphs = &batch.graphs;
    seat.x = batch.x;
    seat.next_x = batch.next_x;
    seat.batch = &batch;
    seat.keep_scale = draw_keep_scale(batch.graphs.graph_count(), kHiddenWidth, dropout_, rng);
    stack_->ask(training_, PaperStack::Request::kLearn);
  }

  void q_values(const GraphBatch& batch, std::span<const float> x, std::span<float> q) override {
    PaperStack::Seat& seat = stack_->seat(training_);
    seat.graphs = &batch;
    seat.x = x;
    seat.q = q;
    stack_->ask(training_, PaperStack::Request::kMove);
  }

  std::vector<double> take_losses() override { return stack_->take_losses(training_); }
  PaperState state() const override { return stack_->state_of(training_); }
  void set_state(const PaperState& state) override { stack_->set_state_of(training_, state); }

 private:
  std::shared_ptr<PaperStack> stack_;
  int training_;
  double dropout_;
};

// Of one of a stack's trainings.
class StackSource final : public LearnerSource {
 public:
  StackSource(std::shared_ptr<PaperStack> stack, int training) : stack_(std::move(stack)), training_(training) {}
  ~StackSource() override { stack_->leave(training_); }
  StackSource(const StackSource&) = delete;

  std::unique_ptr<PaperLearner> make(const std::string& /*device*/, const PaperLearnerOptions& options,
                                     Rng& rng) const override {
    return std::make_unique<StackedLearner>(stack_, training_, options, rng);
  }

 private:
  std::shared_ptr<PaperStack> stack_;
  int training_;
};

}  // namespace

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
  return std::make_unique<StackedLearner>(std::make_shared<PaperStack>(torch::Device(device), 1), 0, options, rng);
}

std::vector<std::unique_ptr<LearnerSource>> DeviceLearners::make_together(const std::string& device,
                                                                          int trainings) const {
  if (device == "cpu") return {};
  return stack_sources(device, trainings);
}

}  // namespace graphdrl
