#include "graphdrl/planners/bound.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "graphdrl/graph/search.h"

namespace graphdrl {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

// Least costs by number of nodes visited, from 0 up; kNever where so many cannot be had.
using Costs = std::vector<double>;

// The least cost to visit k nodes in two independent parts together, for every k that `limit` allows.
Costs min_plus_convolution(const Costs& one, const Costs& other, double limit) {
  Costs sum(one.size() + other.size() - 1, kNever);
  for (std::size_t i = 0; i < one.size(); ++i) {
    if (one[i] > limit) continue;
    for (std::size_t j = 0; j < other.size(); ++j) sum[i + j] = std::min(sum[i + j], one[i] + other[j]);
  }
  while (sum.back() > limit) sum.pop_back();  // k = 0 costs nothing
  return sum;
}

void lower_to(Costs& costs, const Costs& other) {
  if (costs.size() < other.size()) costs.resize(other.size(), kNever);
  for (std::size_t i = 0; i < other.size(); ++i) costs[i] = std::min(costs[i], other[i]);
}

// A branch of the tree of blocks, seen from the node it hangs from, which is not counted.
struct Branch {
  Costs closed = {0};  // the walk comes back
  Costs open = {0};    // the walk may end there
};

// Adds a branch beside another: the walk ends in one of them at most.
void add_beside(Branch& branch, const Branch& other, double limit) {
  Costs open = min_plus_convolution(branch.open, other.closed, limit);
  lower_to(open, min_plus_convolution(branch.closed, other.open, limit));
  branch.open = std::move(open);
  branch.closed = min_plus_convolution(branch.closed, other.closed, limit);
}

class ArrivalBound {
 public:
  ArrivalBound(const Graph& graph, const Graph& back, NodeId start, double limit)
      : graph_(graph), back_(back), start_(start), limit_(limit), reached_(graph.node_count()) {
    reached_[start] = true;
    reached_nodes_ = {start};
    NearestFirst(graph_).run(start, limit, [&](NodeId node, double) {
      reached_[node] = true;
      reached_nodes_.push_back(node);
      return NearestFirst::Next::kThrough;
    });
  }

  // What can be reached within the limit, the start first.
  const std::vector<NodeId>& reached() const { return reached_nodes_; }

  // Nodes besides the start that can be had within the limit.
  int most_visited() {
    hanging_.resize(graph_.node_count());
    find_blocks();
    return static_cast<int>(hanging_[start_].open.size()) - 1;
  }

 private:
  // The undirected neighbours of a node: where edges lead, then where they come from.
  NodeId neighbour(NodeId node, std::size_t index) const {
    const auto out = graph_.neighbours(node);
    return index < out.size() ? out[index] : back_.neighbours(node)[index - out.size()];
  }
  std::size_t neighbour_count(NodeId node) const {
    return graph_.neighbours(node).size() + (graph_.directed() ? back_.neighbours(node).size() : 0);
  }

  void find_blocks();
  void close_block(NodeId root, const std::vector<NodeId>& members);
  double cheapest_arrival(NodeId node) const;

  const Graph& graph_;
  const Graph& back_;  // graph_ turned round
  NodeId start_;
  double limit_;
  std::vector<bool> reached_;
  std::vector<NodeId> reached_nodes_;
  std::vector<Branch> hanging_;  // [N], what hangs from a node, away from the start
  std::vector<int> block_of_;    // [N], marks the members of the block being closed
  int block_ = 0;
};

// Depth-first search from the start; a block is closed, with all that hangs from its nodes, before the branch that its
// root hangs in.
void ArrivalBound::find_blocks() {
  struct Frame {
    NodeId node;
    NodeId parent;
    std::size_t next = 0;
  };
  std::vector<int> depth(graph_.node_count(), -1);
  std::vector<int> low(graph_.node_count());
  std::vector<NodeId> open_nodes;  // of blocks not closed yet
  std::vector<Frame> stack = {{start_, kNoNode}};
  int clock = 0;
  block_of_.assign(graph_.node_count(), -1);
  depth[start_] = low[start_] = clock++;
  while (!stack.empty()) {
    Frame& frame = stack.back();
    const NodeId node = frame.node;
    if (frame.next < neighbour_count(node)) {
      const NodeId next = neighbour(node, frame.next++);
      if (!reached_[next] || next == frame.parent) continue;
      if (depth[next] >= 0) {
        low[node] = std::min(low[node], depth[next]);
        continue;
      }
      depth[next] = low[next] = clock++;
      open_nodes.push_back(next);
      stack.push_back({next, node});
      continue;
    }
    const NodeId parent = frame.parent;
    stack.pop_back();
    if (parent == kNoNode) break;
    low[parent] = std::min(low[parent], low[node]);
    if (low[node] < depth[parent]) continue;
    std::vector<NodeId> members;
    do {
      members.push_back(open_nodes.back());
      open_nodes.pop_back();
    } while (members.back() != node);
    close_block(parent, members);
  }
}

// The least cost of an edge of the block being closed that leads to a node.
double ArrivalBound::cheapest_arrival(NodeId node) const {
  double least = kNever;
  const auto from = back_.neighbours(node);
  for (int i = 0; i < std::ssize(from); ++i) {
    if (block_of_[from[i]] == block_) least = std::min(least, back_.cost(node, i));
  }
  return least;
}

// Adds a block, and what hangs from its members, to what hangs from its root.
void ArrivalBound::close_block(NodeId root, const std::vector<NodeId>& members) {
  ++block_;
  block_of_[root] = block_;
  for (const NodeId member : members) block_of_[member] = block_;
  // Members from which nothing hangs: the cheapest first. Sums of sorted costs are convex, so they go in at once.
  std::vector<double> plain;
  Branch block;
  const auto behind = [](const Costs& costs, double arrival) {
    Costs result = {0};
    for (const double cost : costs) result.push_back(arrival + cost);
    return result;
  };
  for (const NodeId member : members) {
    const double arrival = cheapest_arrival(member);
    if (hanging_[member].open.size() == 1) {
      plain.push_back(arrival);
    } else {
      add_beside(block, {behind(hanging_[member].closed, arrival), behind(hanging_[member].open, arrival)}, limit_);
      hanging_[member] = {};
    }
  }
  std::sort(plain.begin(), plain.end());
  Costs sums = {0};
  for (const double cost : plain) {
    if (sums.back() + cost > limit_) break;
    sums.push_back(sums.back() + cost);
  }
  add_beside(block, {sums, sums}, limit_);
  const double back = cheapest_arrival(root);
  for (std::size_t k = 1; k < block.closed.size(); ++k) block.closed[k] += back;
  add_beside(hanging_[root], block, limit_);
}

// How many nodes of a bipartite graph `steps` steps can visit at most; all of them where it is not bipartite.
int colour_bound(const Graph& graph, const Graph& back, const std::vector<NodeId>& reached, double steps) {
  std::vector<int> colour(graph.node_count(), -1);
  std::vector<bool> in_reach(graph.node_count());
  for (const NodeId node : reached) in_reach[node] = true;
  colour[reached.front()] = 0;
  std::vector<NodeId> queue = {reached.front()};
  std::int64_t counts[2] = {0, 0};
  for (std::size_t head = 0; head < queue.size(); ++head) {
    const NodeId node = queue[head];
    ++counts[colour[node]];
    for (const Graph* const edges : {&graph, &back}) {
      for (const NodeId next : edges->neighbours(node)) {
        if (!in_reach[next]) continue;
        if (colour[next] == colour[node]) return static_cast<int>(reached.size());
        if (colour[next] >= 0) continue;
        colour[next] = 1 - colour[node];
        queue.push_back(next);
      }
    }
  }
  const auto positions = static_cast<std::int64_t>(std::min(steps, 4e18)) + 1;
  return static_cast<int>(std::min(counts[0], (positions + 1) / 2) + std::min(counts[1], positions / 2));
}

// The most nodes on a way through the strongly connected parts of a directed graph.
int order_bound(const Graph& graph, const Graph& back, const std::vector<NodeId>& reached) {
  // Kosaraju's algorithm: nodes by the time a depth-first search leaves them, then the parts by searches backwards.
  std::vector<bool> seen(graph.node_count());
  std::vector<NodeId> finished;
  struct Frame {
    NodeId node;
    std::size_t next = 0;
  };
  std::vector<Frame> stack = {{reached.front()}};
  seen[reached.front()] = true;
  while (!stack.empty()) {
    Frame& frame = stack.back();
    const auto neighbours = graph.neighbours(frame.node);
    if (frame.next == neighbours.size()) {
      finished.push_back(frame.node);
      stack.pop_back();
      continue;
    }
    const NodeId next = neighbours[frame.next++];
    if (seen[next]) continue;
    seen[next] = true;
    stack.push_back({next});
  }
  std::vector<int> component(graph.node_count(), -1);
  std::vector<int> most;  // nodes on the best way from the start to the end of a part; parts come in order
  for (auto root = finished.rbegin(); root != finished.rend(); ++root) {
    if (component[*root] >= 0) continue;
    const int index = static_cast<int>(most.size());
    int size = 0;
    int before = 0;
    std::vector<NodeId> members = {*root};
    component[*root] = index;
    while (!members.empty()) {
      const NodeId node = members.back();
      members.pop_back();
      ++size;
      for (const NodeId from : back.neighbours(node)) {
        if (!seen[from]) continue;
        if (component[from] < 0) {
          component[from] = index;
          members.push_back(from);
        } else if (component[from] != index) {
          before = std::max(before, most[component[from]]);
        }
      }
    }
    most.push_back(before + size);
  }
  return *std::max_element(most.begin(), most.end());
}

double cheapest_edge(const Graph& graph) {
  double least = kNever;
  for (const Edge& edge : graph.edges()) least = std::min(least, edge.cost);
  return least;
}

}  // namespace

int max_visited(const SearchStart& start) {
  const Graph& open = start.world->open();
  const Graph back = open.reversed();
  ArrivalBound arrivals(open, back, start.position, start.limit());
  int most = 1 + arrivals.most_visited();
  const double steps = open.edge_count() == 0 ? 0 : std::floor(start.limit() / cheapest_edge(open) * (1 + 1e-12));
  most = std::min(most, colour_bound(open, back, arrivals.reached(), steps));
  if (open.directed()) most = std::min(most, order_bound(open, back, arrivals.reached()));
  // Where the walk began before: its nodes count again at worst, but nothing counts that is neither visited nor
  // reached.
  const auto visited_before = static_cast<int>(std::count(start.visited.begin(), start.visited.end(), true)) - 1;
  std::vector<bool> possible = start.visited;
  for (const NodeId node : arrivals.reached()) possible[node] = true;
  return std::min(most + visited_before, static_cast<int>(std::count(possible.begin(), possible.end(), true)));
}

}  // namespace graphdrl
