#include "graphdrl/train/torch/known_graphs.h"

#include <torch/torch.h>

#include <algorithm>

namespace graphdrl {

KnownGraphs::KnownGraphs(torch::Device device)
    : adjacent_(torch::zeros({1, 1, 1}, device)), counts_(torch::zeros({1, 1, 1}, device)) {}

std::int64_t KnownGraphs::add(const Graph& graph) {
  const std::int64_t nodes = graph.node_count();
  const std::int64_t places = adjacent_.size(0);
  // Twice the places, so that other tensors seldom take their part.
  const std::int64_t more_places = size_ == places ? places : 0;
  const std::int64_t more_nodes = std::max<std::int64_t>(nodes - largest(), 0);
  if (more_places > 0 || more_nodes > 0) {
    adjacent_ = torch::constant_pad_nd(adjacent_, {0, more_nodes, 0, more_nodes, 0, more_places});
    counts_ = torch::constant_pad_nd(counts_, {0, 0, 0, more_nodes, 0, more_places});
  }
  torch::Tensor adjacent = torch::zeros({largest(), largest()});
  for (NodeId node = 0; node < graph.node_count(); ++node) {
    for (const NodeId next : graph.neighbours(node)) adjacent[node][next] += 1;
  }
  adjacent_[size_].copy_(adjacent);
  counts_[size_].narrow(0, 0, nodes).fill_(1);
  return size_++;
}

}  // namespace graphdrl
