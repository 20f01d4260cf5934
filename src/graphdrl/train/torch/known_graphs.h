// The graphs that trainings have met, as dense matrices on a device, padded to one number of nodes.
#pragma once

#include <torch/types.h>

#include "graphdrl/graph/graph.h"

namespace graphdrl {

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

}  // namespace graphdrl
