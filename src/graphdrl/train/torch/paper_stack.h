// Many trainings of the paper's network on one device, whose learning steps and moves are done together. Each training
// runs on a thread of its own and waits in its learner until all others wait too; then one thread does the work of all.
// So the stack sees the same requests as single learners would, in the same order for each training.
#pragma once

#include <condition_variable>
#include <map>
#include <mutex>
#include <optional>
#include <vector>

#include "graphdrl/train/adam.h"
#include "graphdrl/train/paper_learner.h"
#include "graphdrl/train/torch/device_stream.h"
#include "graphdrl/train/torch/known_graphs.h"
#include "graphdrl/train/torch/paper_stacked_network.h"

namespace graphdrl {

class PaperStack {
 public:
  // Throws Error where LibTorch does not have the device.
  PaperStack(torch::Device device, int trainings);

  // The learner of a training, from 0 up, which the stack must outlive. REQUIRES: all have the same options and batch
  // size.
  std::unique_ptr<PaperLearner> learner(int training, const PaperLearnerOptions& options, Rng& rng);
  // That training asks for nothing more. Must be called once for each, or the others wait for ever.
  void leave(int training);

 private:
  friend class StackedLearner;

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

    std::vector<torch::Tensor*> all();
  };
  // Reused for every request of one kind and batch size.
  struct Work {
    Inputs host;
    Inputs device;
    torch::Tensor q;  // [S, B, A], of a move
    DeviceStream::Event sent;
    std::unique_ptr<DeviceStream::CapturedWork> run;
  };

  void begin(const PaperLearnerOptions& options);
  void ask(int training, Request request);
  void serve_where_all_wait();
  void move(const std::vector<int>& trainings);
  void learn(const std::vector<int>& trainings);
  std::vector<double> take_losses(int training);
  void fetch_losses();

  Work& work_for(Request request, const std::vector<int>& trainings);
  Inputs empty_inputs(Request request, std::int64_t batch, const torch::TensorOptions& where) const;
  void fill(Inputs& host, const std::vector<int>& trainings) const;
  void send(Work& work, const std::vector<int>& trainings);
  void choose_values(const Inputs& inputs, const torch::Tensor& q);
  void learn_step(const Inputs& inputs);
  void adam_step(const torch::Tensor& active, const torch::Tensor& gradient);
  StackedGraphs graphs_of(const Inputs& inputs) const;
  std::int64_t stack_size() const { return static_cast<std::int64_t>(seats_.size()); }

  // REQUIRES: mutex_ is held.
  PaperState state_of(int training);
  void set_state_of(int training, const PaperState& state);

  std::mutex mutex_;
  std::condition_variable served_;
  std::vector<Seat> seats_;
  int present_;
  std::exception_ptr failure_;

  DeviceStream stream_;
  PaperLearnerOptions options_;
  AdamOptions adam_;
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

// One source for each training of a stack on a device; a training leaves when its source is destroyed. Throws Error
// where LibTorch does not have the device.
std::vector<std::unique_ptr<LearnerSource>> stack_sources(const std::string& device, int trainings);

// Learners on the CPU by its kernels, on other devices by LibTorch, those of one kind of training by one stack.
class DeviceLearners final : public LearnerSource {
 public:
  std::unique_ptr<PaperLearner> make(const std::string& device, const PaperLearnerOptions& options,
                                     Rng& rng) const override;
  std::vector<std::unique_ptr<LearnerSource>> make_together(const std::string& device, int trainings) const override;
};

}  // namespace graphdrl
