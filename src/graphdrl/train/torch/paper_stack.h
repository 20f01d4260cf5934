// Many trainings of the paper's network on one device, whose learning steps and moves are done together. Each training
// runs on a thread of its own and waits in its learner until all others wait too; then one thread does the work of all.
// So the stack sees the same requests as single learners would, in the same order for each training.
#pragma once

#include <condition_variable>
#include <map>
#include <mutex>
#include <vector>

#include "graphdrl/train/adam.h"
#include "graphdrl/train/paper_learner.h"
#include "graphdrl/train/torch/paper_stacked_network.h"

namespace graphdrl {

class PaperStack final : public PaperLearnerGroup {
 public:
  PaperStack(torch::Device device, int trainings);

  // As PaperLearner, of one of the trainings. All have the same options and batch size.
  MakePaperLearner learner_of(int training) override;
  // That training asks for nothing more. Must be called for each, or the others wait for ever.
  void leave(int training) override;

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
    std::vector<float> keep_scale;  // [B, 256]
    std::span<float> q;             // [B, A], of a move
    double loss = 0;
    std::map<const Graph*, std::int64_t> places;  // of its graphs in all_adjacent_, while it is there
  };

  void begin(const PaperLearnerOptions& options);
  void ask(int training, Request request);
  void serve_where_all_wait();
  void move(const std::vector<int>& trainings);
  void learn(const std::vector<int>& trainings);
  void step(const torch::Tensor& active, const torch::Tensor& gradient);
  // Writes [S, B, n, F] of the trainings, zeros elsewhere.
  torch::Tensor stacked(const std::vector<int>& trainings, std::span<const float> Seat::*x, std::int64_t batch) const;
  StackedGraphs graphs_of(const std::vector<int>& trainings, std::int64_t batch);
  std::int64_t place_of(int training, const Graph& graph);

  PaperState state_of(int training);
  void set_state_of(int training, const PaperState& state);

  std::mutex mutex_;
  std::condition_variable served_;
  std::vector<Seat> seats_;
  int present_;
  std::exception_ptr failure_;

  torch::Device device_;
  bool begun_ = false;
  PaperLearnerOptions options_;
  AdamOptions adam_;
  torch::Tensor values_;         // [S, all]
  torch::Tensor target_values_;  // [S, all]
  torch::Tensor first_;          // [S, trainable], as the next
  torch::Tensor second_;
  torch::Tensor steps_;  // [S, 1] float64, of Adam
  NamedTensors online_;
  NamedTensors target_;

  // Every graph that was seen.
  std::vector<torch::Tensor> known_;  // [nodes, nodes] each
  std::int64_t largest_ = 0;          // n
  torch::Tensor all_adjacent_;        // [graphs, n, n]
  torch::Tensor all_counts_;          // [graphs, n, 1]
};

// Makes a stack on a device by its name. Throws Error where LibTorch does not have the device.
std::unique_ptr<PaperLearnerGroup> make_paper_stack(const std::string& device, int trainings);

}  // namespace graphdrl
