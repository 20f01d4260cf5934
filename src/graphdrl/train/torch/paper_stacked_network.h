// The paper's Q-network of many trainings at once: weights stacked along a first dimension, every product one batched
// product. Shapes do not depend on what the batches hold.
//
// Beside the legend of nn/: S trainings; n nodes of the largest graph. Smaller graphs are padded with nodes that have
// no edge and count nowhere.
#pragma once

#include <torch/types.h>

#include <map>
#include <string>

#include "graphdrl/nn/paper_network.h"

namespace graphdrl {

// The network's tensors by PyTorch's names.
using NamedTensors = std::map<std::string, torch::Tensor>;

// What the graphs of S batches look like.
struct StackedGraphs {
  torch::Tensor adjacent;   // [S * B, n, n] float32: 1 where an edge leads from the second node to the first
  torch::Tensor node_mask;  // [S, B, n, 1] float32: 1 for nodes, 0 for padding
};

// The graphs that trainings have met, as dense matrices on a device, padded to one number of nodes.
class KnownGraphs {
 public:
  // On the current stream of the device, as add().
  explicit KnownGraphs(c10::Device device);

  // Adds a graph; gives its index.
  std::int64_t add(const Graph& graph);

  std::int64_t padded_nodes() const { return adjacent_.size(1); }  // n, those of the largest
  const torch::Tensor& adjacent() const { return adjacent_; }      // [graphs, n, n] float32, [g, to, from]: edges
  const torch::Tensor& node_mask() const { return node_mask_; }    // [graphs, n, 1] float32: 1 for nodes, 0 for padding

 private:
  std::int64_t size_ = 0;
  torch::Tensor adjacent_;
  torch::Tensor node_mask_;
};

// Views of S flat buffers [S, all] of parameters and running statistics, by PyTorch's names: weights [S, …]. Each is a
// variable of its own: with `learning`, the trainable ones are leaves.
NamedTensors stacked_tensors(const torch::Tensor& values, bool learning);

// The gradient of a loss by the trainable ones of `tensors`. [S, trainable], in the order of the flat buffers.
torch::Tensor stacked_gradient(const torch::Tensor& loss, const NamedTensors& tensors);

// q [S, B, A] of x [S, B, n, F]. With `keep_scale` [S, B, 256] in train mode, as PaperNetwork::q_values: the
// running statistics of the trainings that are `active` [S] move. Without it in eval mode.
torch::Tensor stacked_q_values(const StackedGraphs& graphs, const torch::Tensor& x, const NamedTensors& tensors,
                               const torch::Tensor& keep_scale = {}, const torch::Tensor& active = {});

}  // namespace graphdrl
