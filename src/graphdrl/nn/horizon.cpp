#include "graphdrl/nn/horizon.h"

#include <algorithm>

namespace graphdrl {

// Breadth first, whichever way edges lead.
void Horizon::gather_nodes(const Graph& graph, NodeId from) {
  if (marks_.size() < static_cast<std::size_t>(graph.node_count())) marks_.resize(graph.node_count());
  if (++call_ == 0) {
    std::fill(marks_.begin(), marks_.end(), Mark());
    call_ = 1;
  }
  nodes_.assign(1, from);
  marks_[from] = {call_, 0};
  most_steps_ = 1;
  std::size_t next_ring = 1;  // where nodes one step farther begin
  for (std::size_t head = 0; head < nodes_.size() && nodes_.size() < kExplorerHorizon; ++head) {
    if (head == next_ring) {
      next_ring = nodes_.size();
      ++most_steps_;
    }
    for (const NodeId next : graph.neighbours(nodes_[head])) {
      if (index_of(next) >= 0) continue;
      if (nodes_.size() == kExplorerHorizon) break;
      marks_[next] = {call_, size()};
      nodes_.push_back(next);
    }
  }
}

void Horizon::gather(const Exploration& state) {
  const Graph& graph = state.view().both_ways();
  gather_nodes(graph, state.position());
  for (auto* values : {&degree_, &unvisited_neighbours_}) values->resize(nodes_.size());
  unvisited_.resize(nodes_.size());
  unvisited_count_ = 0;
  for (int i = 0; i < size(); ++i) {
    unvisited_[i] = state.is_new(nodes_[i]);
    unvisited_count_ += unvisited_[i];
  }
  offsets_.assign(1, 0);
  neighbours_.clear();
  is_all_ = true;
  for (int i = 0; i < size(); ++i) {
    int unvisited = 0;
    for (const NodeId next : graph.neighbours(nodes_[i])) {
      const int index = index_of(next);
      if (index >= 0) {
        neighbours_.push_back(index);
        unvisited += unvisited_[index];
      } else {
        is_all_ = false;
        unvisited += state.is_new(next);
      }
    }
    degree_[i] = graph.degree(nodes_[i]);
    unvisited_neighbours_[i] = unvisited;
    offsets_.push_back(std::ssize(neighbours_));
  }
}

}  // namespace graphdrl
