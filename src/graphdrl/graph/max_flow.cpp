#include "graphdrl/graph/max_flow.h"

#include <algorithm>

namespace graphdrl {

int MaxFlow::add_arc(int from, int to, double capacity, double back) {
  const int arc = static_cast<int>(arcs_.size());
  arcs_.push_back({to, capacity});
  arcs_.push_back({from, back});
  arcs_at_[from].push_back(arc);
  arcs_at_[to].push_back(arc + 1);
  return arc;
}

void MaxFlow::set_capacity(int arc, double capacity, double back) {
  arcs_[arc].capacity = capacity;
  arcs_[arc ^ 1].capacity = back;
}

bool MaxFlow::find_path(int from, int to) {
  std::fill(came_by_.begin(), came_by_.end(), -1);
  queue_.assign(1, from);
  scanned_ += std::ssize(came_by_) / 8;  // forgetting the marks
  for (std::size_t head = 0; head < queue_.size(); ++head) {
    scanned_ += std::ssize(arcs_at_[queue_[head]]);
    for (const int arc : arcs_at_[queue_[head]]) {
      const int next = arcs_[arc].to;
      if (next == from || came_by_[next] >= 0 || arcs_[arc].capacity <= kFlowRounding) continue;
      came_by_[next] = arc;
      if (next == to) return true;
      queue_.push_back(next);
    }
  }
  return false;
}

bool MaxFlow::reaches(int from, int to, double needed) {
  double flow = 0;
  pushed_.clear();
  while (flow < needed && find_path(from, to)) {
    double most = needed - flow;
    for (int node = to; node != from; node = arcs_[came_by_[node] ^ 1].to) {
      most = std::min(most, arcs_[came_by_[node]].capacity);
    }
    for (int node = to; node != from; node = arcs_[came_by_[node] ^ 1].to) {
      arcs_[came_by_[node]].capacity -= most;
      arcs_[came_by_[node] ^ 1].capacity += most;
      pushed_.push_back({came_by_[node], most});
    }
    flow += most;
  }
  for (const Pushed& part : pushed_) {
    arcs_[part.arc].capacity += part.flow;
    arcs_[part.arc ^ 1].capacity -= part.flow;
  }
  return flow >= needed;
}

}  // namespace graphdrl
