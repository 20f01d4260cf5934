// Maximum flows and minimum cuts.
#pragma once

#include <cstdint>
#include <vector>

namespace graphdrl {

// A network of nodes and arcs with capacities. Flows go along shortest augmenting paths [Edmonds and Karp 1972]. Suits
// many small flows in one network: a run leaves the capacities as it found them.
class MaxFlow {
 public:
  explicit MaxFlow(int nodes) : arcs_at_(nodes), came_by_(nodes) {}

  // Adds an arc, with its capacity in the other direction too. Gives its number.
  int add_arc(int from, int to, double capacity, double back = 0);
  void set_capacity(int arc, double capacity, double back = 0);

  // Whether that much can flow; less than kFlowRounding counts as nothing. Cost: a breadth-first search for each path.
  bool reaches(int from, int to, double needed);
  // After a flow that falls short: the nodes on the near side of a minimum cut, `from` among them.
  const std::vector<int>& near_side() const { return queue_; }
  // Arcs looked at up to now.
  std::int64_t scanned() const { return scanned_; }

  static constexpr double kFlowRounding = 1e-7;

 private:
  // Arcs come in pairs: arc i ^ 1 is arc i turned round.
  struct Arc {
    int to;
    double capacity;
  };
  struct Pushed {
    int arc;
    double flow;
  };

  bool find_path(int from, int to);

  std::vector<Arc> arcs_;
  std::vector<std::vector<int>> arcs_at_;
  std::vector<int> came_by_;  // arcs; -1 for nodes not reached
  std::vector<int> queue_;
  std::vector<Pushed> pushed_;
  std::int64_t scanned_ = 0;
};

}  // namespace graphdrl
