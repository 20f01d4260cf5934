// The graphs that trainings have met, as dense matrices on a device, padded to the size of the largest.
#pragma once

#include <torch/types.h>

#include "graphdrl/graph/graph.h"

namespace graphdrl {

class KnownGraphs {
 public:
  explicit KnownGraphs(torch::Device device);

  // Adds one; gives its place.
  std::int64_t add(const Graph& graph);

  std::int64_t largest() const { return adjacent_.size(1); }   // n, nodes
  const torch::Tensor& adjacent() const { return adjacent_; }  // [places, n, n] float32, [g, to, from]: edges
  const torch::Tensor& counts() const { return counts_; }      // [places, n, 1] float32: 1 for nodes, 0 for padding

 private:
  std::int64_t size_ = 0;
  torch::Tensor adjacent_;
  torch::Tensor counts_;
};

}  // namespace graphdrl
