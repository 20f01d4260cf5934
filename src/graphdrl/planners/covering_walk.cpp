#include "graphdrl/planners/covering_walk.h"

#include <algorithm>
#include <array>
#include <boost/pending/disjoint_sets.hpp>
#include <queue>

#include "graphdrl/planners/two_matching.h"

namespace graphdrl {
namespace {

constexpr double kWorstDetour =
    0.75;                            // prize for its cost, in mean prizes a mean edge: what brings more is not left out
constexpr int kLongestDetour = 400;  // steps
constexpr int kMostRounds = 10;      // of joining near nodes, each of which is linear; around a hub each joins two
constexpr int kSizeTries = 5;        // of how much to cover, where the walk must end somewhere
constexpr double kFirstSize = 1.02;  // of the steps that the limit pays for, in nodes
constexpr double kMoreSize = 1.01;   // times as many nodes, where all of them can be paid for

// Where edges are walked: how often each is, up to twice.
class Multigraph {
 public:
  explicit Multigraph(const Graph& graph) : graph_(graph), first_(graph.node_count() + 1) {
    for (NodeId node = 0; node < graph.node_count(); ++node) first_[node + 1] = first_[node] + graph.degree(node);
    times_.resize(first_.back());
  }

  // More than twice is once or twice: two walks along an edge can be left out, and the rest stays connected.
  void add(NodeId a, NodeId b, int times) {
    std::uint8_t& there = times_[first_[a] + graph_.index_of(a, b)];
    const int sum = there + times;
    there = static_cast<std::uint8_t>(sum > 2 ? sum - 2 : sum);
    times_[first_[b] + graph_.index_of(b, a)] = there;
  }

  template <typename Visit>
  void for_edges(const Visit& visit) const {
    for (NodeId node = 0; node < graph_.node_count(); ++node) {
      const auto neighbours = graph_.neighbours(node);
      for (int i = 0; i < std::ssize(neighbours); ++i) {
        if (neighbours[i] > node && times_[first_[node] + i] > 0) visit(node, neighbours[i]);
      }
    }
  }

  // The walk through all edges [Hierholzer 1873], which are taken out. REQUIRES: they are connected, the start is on
  // one of them, and all degrees are even but those of the start and of the other end.
  std::vector<NodeId> take_walk(NodeId start) {
    std::vector<int> next(graph_.node_count());
    std::vector<NodeId> trail = {start};
    std::vector<NodeId> walk;
    while (!trail.empty()) {
      const NodeId node = trail.back();
      const auto neighbours = graph_.neighbours(node);
      while (next[node] < std::ssize(neighbours) && times_[first_[node] + next[node]] == 0) ++next[node];
      if (next[node] == std::ssize(neighbours)) {
        walk.push_back(node);
        trail.pop_back();
        continue;
      }
      const NodeId to = neighbours[next[node]];
      --times_[first_[node] + next[node]];
      --times_[first_[to] + graph_.index_of(to, node)];
      trail.push_back(to);
    }
    std::reverse(walk.begin(), walk.end());
    return walk;
  }

 private:
  const Graph& graph_;
  std::vector<std::int64_t> first_;  // [N + 1], of a node's edges
  std::vector<std::uint8_t> times_;  // [2E]
};

// The ways, of fewest steps, between neighbours among a set of nodes: the Voronoi cells of the set, and the edges
// between two cells.
class NearbyWays {
 public:
  struct Way {
    int steps;
    NodeId a;  // the edge between the two cells
    NodeId b;
  };

  NearbyWays(const Graph& graph, const std::vector<NodeId>& sites) : sites_(graph.node_count(), kNoNode) {
    std::vector<NodeId> queue = sites;
    std::vector<int> steps(graph.node_count());
    towards_.assign(graph.node_count(), kNoNode);
    for (const NodeId site : sites) sites_[site] = site;
    for (std::size_t i = 0; i < queue.size(); ++i) {
      for (const NodeId next : graph.neighbours(queue[i])) {
        if (sites_[next] != kNoNode) continue;
        sites_[next] = sites_[queue[i]];
        towards_[next] = queue[i];
        steps[next] = steps[queue[i]] + 1;
        queue.push_back(next);
      }
    }
    for (const NodeId node : queue) {
      for (const NodeId next : graph.neighbours(node)) {
        if (next > node && sites_[next] != sites_[node]) ways_.push_back({steps[node] + steps[next] + 1, node, next});
      }
    }
    std::stable_sort(ways_.begin(), ways_.end(), [](const Way& a, const Way& b) { return a.steps < b.steps; });
  }

  const std::vector<Way>& ways() const { return ways_; }  // the shortest first
  NodeId site(NodeId node) const { return sites_[node]; }
  void add(const Way& way, int times, Multigraph& edges) const {
    edges.add(way.a, way.b, times);
    for (NodeId node : {way.a, way.b}) {
      for (; towards_[node] != kNoNode; node = towards_[node]) edges.add(node, towards_[node], times);
    }
  }

 private:
  std::vector<NodeId> sites_;    // [N], the site whose cell a node is in
  std::vector<NodeId> towards_;  // [N], the next node on the way to it
  std::vector<Way> ways_;
};

// Joins odd nodes along a tree of shortest ways: an edge is walked if an odd number of them hangs from it.
void join_along_tree(const Graph& graph, NodeId root, std::vector<char>& is_odd, Multigraph& edges) {
  std::vector<std::pair<NodeId, NodeId>> tree;  // nodes and what they hang from, the root's neighbours first
  std::vector<char> met(graph.node_count());
  met[root] = 1;
  std::size_t done = 0;
  for (NodeId node = root;; node = tree[done++].first) {
    for (const NodeId next : graph.neighbours(node)) {
      if (met[next] != 0) continue;
      met[next] = 1;
      tree.emplace_back(next, node);
    }
    if (done == tree.size()) break;
  }
  for (std::size_t i = tree.size(); i-- > 0;) {
    const auto [node, parent] = tree[i];
    if (is_odd[node] == 0) continue;
    is_odd[node] = 0;
    is_odd[parent] ^= 1;
    edges.add(node, parent, 1);
  }
}

// Joins odd nodes in pairs, near ones first, until at most one is left.
void join_pairs(const Graph& graph, std::vector<NodeId> odd, NodeId root, Multigraph& edges) {
  std::vector<char> is_odd(graph.node_count());
  for (const NodeId node : odd) is_odd[node] = 1;
  for (int round = 0; odd.size() > 1; ++round) {
    if (round == kMostRounds) return join_along_tree(graph, root, is_odd, edges);
    const NearbyWays nearby(graph, odd);
    for (const NearbyWays::Way& way : nearby.ways()) {
      const NodeId a = nearby.site(way.a);
      const NodeId b = nearby.site(way.b);
      if (is_odd[a] == 0 || is_odd[b] == 0) continue;
      is_odd[a] = is_odd[b] = 0;
      nearby.add(way, 1, edges);
    }
    std::erase_if(odd, [&](NodeId node) { return is_odd[node] == 0; });
  }
}

// Adds edges there and back until all nodes are connected [Kruskal 1956].
void connect(const Graph& graph, const std::vector<NodeId>& nodes, Multigraph& edges) {
  boost::disjoint_sets_with_storage<> parts(graph.node_count());
  edges.for_edges([&](NodeId a, NodeId b) { parts.union_set(a, b); });
  const NearbyWays nearby(graph, nodes);
  for (const NearbyWays::Way& way : nearby.ways()) {
    const NodeId a = nearby.site(way.a);
    const NodeId b = nearby.site(way.b);
    if (parts.find_set(a) == parts.find_set(b)) continue;
    parts.union_set(a, b);
    nearby.add(way, 2, edges);
  }
}

// A walk over these nodes, the task's start and its end among them; of the start alone once the clock passes.
std::vector<NodeId> walk_over(const Task& task, const std::vector<NodeId>& nodes, const Clock& clock) {
  const Graph& graph = task.view().open();
  TwoMatching matching(graph, nodes);
  if (task.ends_anywhere() || task.end() != task.start()) matching.end_at(task.start());
  if (!task.ends_anywhere() && task.end() != task.start()) matching.end_at(task.end());
  matching.grow_paths();
  matching.join_ends(clock);
  if (clock.passed()) return {task.start()};
  matching.patch_cycles();
  Multigraph edges(graph);
  for (const NodeId node : nodes) {
    for (const NodeId next : matching.links(node)) {
      if (next > node) edges.add(node, next, 1);
    }
  }
  std::vector<char> odd(graph.node_count());
  for (const NodeId node : nodes) odd[node] = matching.degree(node) % 2 != 0 ? 1 : 0;
  for (const TwoMatching::Hop& hop : matching.hops()) {
    edges.add(hop.from, hop.over, 1);
    edges.add(hop.over, hop.to, 1);
    odd[hop.from] ^= 1;
    odd[hop.to] ^= 1;
  }
  odd[task.start()] ^= 1;
  if (!task.ends_anywhere()) odd[task.end()] ^= 1;
  std::vector<NodeId> left;
  std::copy_if(nodes.begin(), nodes.end(), std::back_inserter(left), [&](NodeId node) { return odd[node] != 0; });
  join_pairs(graph, std::move(left), task.start(), edges);
  if (clock.passed()) return {task.start()};
  connect(graph, nodes, edges);
  if (clock.passed()) return {task.start()};
  return edges.take_walk(task.start());
}

// A walk, and which of its steps are left out: detours, which end where they begin.
class Shortening {
 public:
  Shortening(const Task& task, std::vector<NodeId> walk)
      : task_(task),
        walk_(std::move(walk)),
        next_(walk_.size()),
        at_(walk_.size()),
        gone_(walk_.size()),
        times_(task.view().node_count()),
        times_inside_(task.view().node_count()) {
    for (std::size_t i = 0; i < walk_.size(); ++i) {
      next_[i] = static_cast<int>(i) + 1;
      at_[i] = static_cast<int>(i);
      ++times_[walk_[i]];
      if (i > 0) cost_ += step_cost(walk_[i - 1], walk_[i]);
    }
    find_detours();
  }

  // Leaves out what brings least for its cost, until the limit pays for the rest or all that is left brings more than
  // `worst` for a unit of cost.
  void shorten(double worst) {
    std::priority_queue<Rated> queue;
    const auto push = [&](const Detour& detour) {
      const Rated rated = rate(detour);
      if (rated.cost > 0 && rated.lost <= worst * rated.cost) queue.push(rated);
    };
    for (const Detour& detour : detours_) push(detour);
    while (!queue.empty() && cost_ > task_.limit()) {
      const Rated best = queue.top();
      queue.pop();
      if (is_gone(best.detour)) continue;
      // What else was left out may have changed what this one brings.
      if (const Rated now = rate(best.detour); now.lost != best.lost || now.cost != best.cost) {
        push(best.detour);
      } else {
        leave_out(best);
      }
    }
  }

  double cost() const { return cost_; }

  // What is left, as far as the limit pays for it if the walk may end anywhere.
  std::vector<NodeId> take_walk() {
    std::vector<NodeId> walk = {walk_[0]};
    double left = task_.limit();
    for (int i = next_[0]; i < std::ssize(walk_); i = next_[i]) {
      left -= step_cost(walk.back(), walk_[i]);
      if (left < 0 && task_.ends_anywhere()) break;
      walk.push_back(walk_[i]);
    }
    return walk;
  }

 private:
  struct Detour {
    int first;  // places in the walk, of the same node
    int last;
  };
  struct Rated {
    Detour detour;
    double lost;  // prize
    double cost;
    bool operator<(const Rated& other) const {  // the top brings least for its cost, and saves most of those
      const double mine = lost * other.cost;
      const double its = other.lost * cost;
      return mine != its ? mine > its : cost < other.cost;
    }
  };

  double step_cost(NodeId from, NodeId to) const {
    const Graph& open = task_.view().open();
    return open.cost(from, open.index_of(from, to));
  }

  // Each time that the walk comes back to a node of the way up to there, what it did since is a detour.
  void find_detours() {
    std::vector<int> place(task_.view().node_count(), -1);  // on the trail
    std::vector<int> trail;
    for (int i = 0; i < std::ssize(walk_); ++i) {
      int& here = place[walk_[i]];
      if (here < 0) {
        here = static_cast<int>(trail.size());
        trail.push_back(i);
        continue;
      }
      for (std::size_t k = here + 1; k < trail.size(); ++k) place[walk_[trail[k]]] = -1;
      if (i - trail[here] <= kLongestDetour) detours_.push_back({trail[here], i});
      trail.resize(here + 1);
      trail[here] = i;
    }
  }

  // A place, or the earlier one of the same node that stands for it once a detour between them was left out.
  int stands_for(int place) {
    while (at_[place] != place) place = at_[place] = at_[at_[place]];
    return place;
  }
  bool is_gone(const Detour& detour) { return gone_[stands_for(detour.first)] != 0; }

  Rated rate(const Detour& detour) {
    if (is_gone(detour)) return {.detour = detour, .lost = 0, .cost = 0};
    Rated rated{.detour = detour, .lost = 0, .cost = 0};
    const int first = stands_for(detour.first);
    const int last = stands_for(detour.last);
    int before = first;
    for (int i = next_[first]; before != last; before = i, i = next_[i]) {
      rated.cost += step_cost(walk_[before], walk_[i]);
      if (++times_inside_[walk_[i]] == times_[walk_[i]]) rated.lost += task_.prize(walk_[i]);
    }
    for (int i = first; i != last; i = next_[i]) times_inside_[walk_[next_[i]]] = 0;
    return rated;
  }

  void leave_out(const Rated& rated) {
    const int first = stands_for(rated.detour.first);
    const int last = stands_for(rated.detour.last);
    for (int i = next_[first];; i = next_[i]) {
      gone_[i] = 1;
      --times_[walk_[i]];
      if (i == last) break;
    }
    gone_[last] = 0;
    at_[last] = first;
    next_[first] = next_[last];
    cost_ -= rated.cost;
  }

  const Task& task_;
  std::vector<NodeId> walk_;
  std::vector<int> next_;          // [steps + 1], the place of the next step that is left
  std::vector<int> at_;            // [steps + 1]
  std::vector<char> gone_;         // [steps + 1]
  std::vector<int> times_;         // [N], that the walk is at a node
  std::vector<int> times_inside_;  // [N], 0 between two ratings
  std::vector<Detour> detours_;
  double cost_ = 0;
};

// The ends, then all that is to be visited, by what a walk costs that goes there alone.
std::vector<NodeId> nodes_to_cover(const Task& task) {
  const NodeSet ground = task.ground();
  const std::vector<bool>& in_reach = task.reach().contains;
  std::vector<std::pair<double, NodeId>> nodes = {{0, task.start()}};
  NearestFirst().run(task.view().open(), task.start(), task.limit(), [&](NodeId node, double cost) {
    const bool counts = node == task.end() || (task.prize(node) > 0 && !ground.contains(node));
    if (counts && in_reach[node]) nodes.emplace_back(node == task.end() ? 0 : cost + task.cost_to_end(node), node);
    return NearestFirst::Next::kThrough;
  });
  std::stable_sort(nodes.begin(), nodes.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<NodeId> order(nodes.size());
  std::transform(nodes.begin(), nodes.end(), order.begin(), [](const auto& node) { return node.second; });
  return order;
}

double mean_prize(const Task& task, const std::vector<NodeId>& nodes) {
  double sum = 0;
  for (const NodeId node : nodes) sum += task.prize(node);
  return sum / static_cast<double>(nodes.size());
}

}  // namespace

bool covering_fits(const Task& task) {
  const Graph& open = task.view().open();
  return !open.directed() && !open.is_complete();
}

Plan covering_plan(const Task& task, const Clock& clock) {
  const std::vector<NodeId> nodes = nodes_to_cover(task);
  const double mean_cost = task.view().open().mean_cost();
  const double worst = kWorstDetour * mean_prize(task, nodes) / mean_cost;
  if (task.ends_anywhere()) {
    Shortening walk(task, walk_over(task, nodes, clock));
    walk.shorten(worst);
    return plan_of_walk(task, walk.take_walk());
  }
  std::vector<NodeId> straight = {task.start()};
  NearestFirst search;
  append_way_to_end(task, straight, search);
  Plan best = plan_of_walk(task, std::move(straight));
  double size = kFirstSize * task.limit() / mean_cost;
  for (int i = 0; i < kSizeTries && !clock.passed(); ++i) {
    size = std::clamp(size, std::min(2.0, static_cast<double>(nodes.size())), static_cast<double>(nodes.size()));
    Shortening walk(task, walk_over(task, {nodes.begin(), nodes.begin() + static_cast<std::ptrdiff_t>(size)}, clock));
    const bool fits = walk.cost() <= task.limit();
    walk.shorten(worst);
    const double cost = walk.cost();
    if (cost > task.limit()) walk.shorten(kNoLimit);
    if (clock.passed()) break;
    if (walk.cost() <= task.limit()) best = better_of(std::move(best), plan_of_walk(task, walk.take_walk()));
    if (fits && size >= static_cast<double>(nodes.size())) break;
    size *= cost > task.limit() ? task.limit() / cost : kMoreSize;
  }
  return best;
}

}  // namespace graphdrl
