#include "graphdrl/train/torch/known_graphs.h"

#include <torch/torch.h>

#include <algorithm>

namespace graphdrl {

KnownGraphs::KnownGraphs(c10::Device device)
    : adjacent_(torch::zeros({1, 1, 1}, device)), node_mask_(torch::zeros({1, 1, 1}, device)) {}

std::int64_t KnownGraphs::add(const Graph& graph) {
  const std::int64_t nodes = graph.node_count();
  const std::int64_t capacity = adjacent_.size(0);
  // Doubles, so that the tensors, and what was captured on them, are seldom replaced.
  const std::int64_t more_graphs = size_ == capacity ? capacity : 0;
  const std::int64_t more_nodes = std::max<std::int64_t>(nodes - padded_nodes(), 0);
  if (more_graphs > 0 || more_nodes > 0) {
    adjacent_ = torch::constant_pad_nd(adjacent_, {0, more_nodes, 0, more_nodes, 0, more_graphs});
    node_mask_ = torch::constant_pad_nd(node_mask_, {0, 0, 0, more_nodes, 0, more_graphs});
  }
  torch::Tensor adjacent = torch::zeros({padded_nodes(), padded_nodes()});
  auto edges = adjacent.accessor<float, 2>();
  for (NodeId node = 0; node < graph.node_count(); ++node) {
    for (const NodeId next : graph.neighbours(node)) edges[node][next] += 1;
  }
  adjacent_[size_].copy_(adjacent);
  node_mask_[size_].narrow(0, 0, nodes).fill_(1);
  return size_++;
}

}  // namespace graphdrl
