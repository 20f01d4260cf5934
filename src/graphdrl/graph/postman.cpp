#include "graphdrl/graph/postman.h"

#include <fmt/format.h>

#include <algorithm>
#include <boost/graph/adjacency_list.hpp>
#include <boost/graph/successive_shortest_path_nonnegative_weights.hpp>
#include <cmath>
#include <limits>
#include <utility>

#include "graphdrl/base/error.h"
#include "graphdrl/graph/perfect_matching.h"
#include "graphdrl/graph/search.h"

namespace graphdrl {
namespace {

// Costs that are no whole numbers are rounded to this part of the dearest one.
constexpr double kFineCosts = 1e9;

// An edge of an Eulerian graph, as often as it stands there.
struct Part {
  NodeId a;
  NodeId b;
  std::int64_t edge;
};

// Costs as whole numbers, with which sums are exact.
class WholeCosts {
 public:
  explicit WholeCosts(const Graph& graph, double reset) {
    const bool whole = graph.integer_costs() && std::floor(reset) == reset;
    const double most = std::max({graph.max_cost(), reset, 1e-300});
    scale_ = whole ? 1 : kFineCosts / most;
  }
  std::int64_t of(double cost) const { return std::llround(cost * scale_); }
  double back(double whole) const { return whole / scale_; }

 private:
  double scale_;
};

// The cheapest edge from each node to each neighbour of the simple graph.
class CheapestEdges {
 public:
  CheapestEdges(const Multigraph& graph, const Graph& simple) : simple_(simple), edge_(simple.node_count()) {
    for (NodeId node = 0; node < simple.node_count(); ++node) edge_[node].assign(simple.degree(node), -1);
    for (std::size_t i = 0; i < graph.edges.size(); ++i) {
      const auto& [a, b, cost] = graph.edges[i];
      take(a, b, static_cast<std::int64_t>(i), graph);
      if (!simple.directed() || graph.leads_back(i)) take(b, a, static_cast<std::int64_t>(i), graph);
    }
  }
  std::int64_t edge(NodeId from, NodeId to) const { return edge_[from][simple_.index_of(from, to)]; }

 private:
  void take(NodeId from, NodeId to, std::int64_t edge, const Multigraph& graph) {
    if (from == to) return;
    std::int64_t& best = edge_[from][simple_.index_of(from, to)];
    if (best < 0 || graph.edges[edge].cost < graph.edges[best].cost) best = edge;
  }

  const Graph& simple_;
  std::vector<std::vector<std::int64_t>> edge_;  // as the neighbours of simple_
};

// A flow of least cost in a network with many sources and sinks. Costs are whole numbers as doubles: the library adds
// up the costs of nodes that it cannot reach, for which whole numbers have no infinity.
class LeastCostFlow {
  using Traits = boost::adjacency_list_traits<boost::vecS, boost::vecS, boost::directedS>;
  using Properties = boost::property<boost::edge_capacity_t, std::int64_t,
                                     boost::property<boost::edge_residual_capacity_t, std::int64_t,
                                                     boost::property<boost::edge_reverse_t, Traits::edge_descriptor,
                                                                     boost::property<boost::edge_weight_t, double>>>>;
  using Network = boost::adjacency_list<boost::vecS, boost::vecS, boost::directedS, boost::no_property, Properties>;

 public:
  using Arc = Traits::edge_descriptor;

  explicit LeastCostFlow(int nodes) : network_(nodes + 2), source_(nodes), sink_(nodes + 1) {}

  Arc add(int from, int to, std::int64_t capacity, double cost) {
    const Arc arc = boost::add_edge(from, to, network_).first;
    const Arc back = boost::add_edge(to, from, network_).first;
    put(arc, back, capacity, cost);
    put(back, arc, 0, -cost);
    return arc;
  }
  // A node has so many units more than it needs, or less.
  void supply(int node, std::int64_t units) {
    if (units > 0) add(source_, node, units, 0);
    if (units < 0) add(node, sink_, -units, 0);
    left_ += std::max<std::int64_t>(units, 0);
  }
  // Whether all units can flow.
  bool run() {
    boost::successive_shortest_path_nonnegative_weights(network_, source_, sink_);
    std::int64_t flow = 0;
    for (const Arc& arc : boost::make_iterator_range(boost::out_edges(source_, network_))) flow += units(arc);
    return flow == left_;
  }
  std::int64_t units(const Arc& arc) const {
    return boost::get(boost::edge_capacity, network_, arc) - boost::get(boost::edge_residual_capacity, network_, arc);
  }

 private:
  void put(const Arc& arc, const Arc& back, std::int64_t capacity, double cost) {
    boost::put(boost::edge_capacity, network_, arc, capacity);
    boost::put(boost::edge_reverse, network_, arc, back);
    boost::put(boost::edge_weight, network_, arc, cost);
  }

  Network network_;
  int source_;
  int sink_;
  std::int64_t left_ = 0;
};

// Walks all parts, from a node on [Hierholzer 1873]. Empty where they do not hang together. REQUIRES: as many parts
// lead to a node as from it, but for the ends.
std::optional<EdgeWalk> eulerian_walk(const Multigraph& graph, bool directed, NodeId node_count, NodeId start,
                                      const std::vector<Part>& parts, double reset_cost) {
  std::vector<std::vector<std::size_t>> at(node_count);
  for (std::size_t i = parts.size(); i-- > 0;) {  // taken from the end: the first come first
    at[parts[i].a].push_back(i);
    if (!directed && parts[i].a != parts[i].b) at[parts[i].b].push_back(i);
  }
  std::vector<bool> used(parts.size());
  struct Step {
    NodeId node;
    std::int64_t edge;
  };
  std::vector<Step> stack = {{.node = start, .edge = 0}};
  EdgeWalk walk;
  while (!stack.empty()) {
    const NodeId here = stack.back().node;
    while (!at[here].empty() && used[at[here].back()]) at[here].pop_back();
    if (!at[here].empty()) {
      const Part& part = parts[at[here].back()];
      used[at[here].back()] = true;
      stack.push_back({.node = part.a == here ? part.b : part.a, .edge = part.edge});
      continue;
    }
    walk.nodes.push_back(here);
    if (stack.size() > 1) walk.edges.push_back(stack.back().edge);
    stack.pop_back();
  }
  if (walk.edges.size() != parts.size()) return std::nullopt;
  std::ranges::reverse(walk.nodes);
  std::ranges::reverse(walk.edges);
  for (const std::int64_t edge : walk.edges) {
    walk.cost += edge == EdgeWalk::kResetEdge ? reset_cost : graph.edges[edge].cost;
  }
  return walk;
}

// Walks over all edges of a directed or mixed graph.
class DirectedPostman {
 public:
  DirectedPostman(const Multigraph& graph, const Graph& simple, NodeId start, const PostmanOptions& options)
      : graph_(graph),
        simple_(simple),
        start_(start),
        options_(options),
        reset_cost_(options.reset_cost.value_or(0)),
        whole_(simple, reset_cost_),
        cheapest_(graph, simple) {}

  std::optional<PostmanWalk> walk() const {
    std::vector<bool> turned(graph_.edges.size());  // edges that lead both ways are walked from b to a
    Relaxed relaxed = solve(turned, !graph_.both_ways.empty());
    if (!relaxed.flows) return std::nullopt;
    std::vector<std::size_t> undecided;
    for (std::size_t i = 0; i < relaxed.turns.size(); ++i) {
      turned[i] = relaxed.turns[i] == 2;
      if (relaxed.turns[i] == 1) undecided.push_back(i);
    }
    const double bound = relaxed.cost;
    Relaxed best = graph_.both_ways.empty() ? std::move(relaxed) : solve(turned, false);
    const auto tries =
        std::min<std::int64_t>(std::ssize(undecided), kTurnWork / std::max<std::int64_t>(std::ssize(graph_.edges), 1));
    for (std::int64_t i = 0; i < tries && best.cost > bound; ++i) {
      turned[undecided[i]] = true;
      Relaxed other = solve(turned, false);
      if (other.flows && other.cost < best.cost) {
        best = std::move(other);
      } else {
        turned[undecided[i]] = false;
      }
    }
    if (!best.flows) return std::nullopt;
    auto walk = eulerian_walk(graph_, /*directed=*/true, simple_.node_count(), start_, best.parts, reset_cost_);
    if (!walk) return std::nullopt;
    // Costs that were rounded tell nothing finer.
    return PostmanWalk{.walk = *walk, .bound = best.cost == bound ? walk->cost : whole_.back(bound)};
  }

 private:
  static constexpr std::int64_t kTurnWork = 10'000;  // flows tried, times edges

  struct Relaxed {
    bool flows;
    std::vector<Part> parts = {};
    std::vector<std::int64_t> turns = {};  // [edges], halves of a turn
    double cost = 0;                       // of all parts, in whole costs
  };

  // turns: whether edges that lead both ways may be turned, by halves; parts are then no walk.
  Relaxed solve(const std::vector<bool>& turned, bool turns) const {
    const NodeId count = simple_.node_count();
    const auto most = static_cast<std::int64_t>(graph_.edges.size()) + 1;  // of any use of an edge
    const int end = options_.end == kNoNode ? count : options_.end;        // anywhere: a node beyond all others
    LeastCostFlow flow(count + 1);
    struct Used {
      LeastCostFlow::Arc arc;
      Part part;
      double cost;
    };
    std::vector<Used> arcs;
    const auto add = [&](const Part& part, double cost) {
      const auto whole = static_cast<double>(whole_.of(cost));
      arcs.push_back({.arc = flow.add(part.a, part.b, most, whole), .part = part, .cost = whole});
    };
    for (NodeId node = 0; node < count; ++node) {
      for (int i = 0; i < simple_.degree(node); ++i) {
        const NodeId next = simple_.neighbours(node)[i];
        add({node, next, cheapest_.edge(node, next)}, simple_.cost(node, i));
      }
      if (options_.reset_cost && node != start_) add({node, start_, EdgeWalk::kResetEdge}, reset_cost_);
      if (options_.end == kNoNode) flow.add(node, end, 1, 0);
    }
    Relaxed solved{.flows = false};
    std::vector<std::int64_t> surplus(count + 1, 0);  // arrivals less departures
    std::vector<std::pair<std::size_t, LeastCostFlow::Arc>> turning;
    for (std::size_t i = 0; i < graph_.edges.size(); ++i) {
      const Edge& edge = graph_.edges[i];
      const NodeId from = turned[i] ? edge.b : edge.a;
      const NodeId to = turned[i] ? edge.a : edge.b;
      --surplus[from];
      ++surplus[to];
      solved.parts.push_back({from, to, static_cast<std::int64_t>(i)});
      solved.cost += static_cast<double>(whole_.of(edge.cost));
      if (turns && graph_.leads_back(i) && from != to) turning.emplace_back(i, flow.add(to, from, 2, 0));
    }
    ++surplus[start_];
    --surplus[end];
    for (int node = 0; node <= count; ++node) flow.supply(node, surplus[node]);
    solved.flows = flow.run();
    if (!solved.flows) return solved;
    for (const Used& used : arcs) {
      const std::int64_t units = flow.units(used.arc);
      solved.parts.insert(solved.parts.end(), units, used.part);
      solved.cost += static_cast<double>(units) * used.cost;
    }
    solved.turns.resize(graph_.edges.size());
    for (const auto& [edge, arc] : turning) solved.turns[edge] = flow.units(arc);
    return solved;
  }

  const Multigraph& graph_;
  const Graph& simple_;
  NodeId start_;
  const PostmanOptions& options_;
  double reset_cost_;
  WholeCosts whole_;
  CheapestEdges cheapest_;
};

std::optional<EdgeWalk> undirected_walk(const Multigraph& graph, const Graph& simple, NodeId start, NodeId end) {
  const NodeId count = simple.node_count();
  std::vector<bool> odd(count);
  std::vector<Part> parts;
  for (std::size_t i = 0; i < graph.edges.size(); ++i) {
    const Edge& edge = graph.edges[i];
    odd[edge.a] = !odd[edge.a];
    odd[edge.b] = !odd[edge.b];
    parts.push_back({edge.a, edge.b, static_cast<std::int64_t>(i)});
  }
  // An open walk is a closed one with an edge from its end to its start, which costs nothing.
  odd[start] = !odd[start];
  if (end != kNoNode) odd[end] = !odd[end];
  std::vector<NodeId> ends;
  for (NodeId node = 0; node < count; ++node) {
    if (odd[node]) ends.push_back(node);
  }
  const auto most = static_cast<std::size_t>(kMostOddNodes);
  if (ends.size() > most) {
    throw Error({.what = "too many nodes with an odd number of edges for the shortest walk over all edges",
                 .expected = fmt::format("at most {}", most),
                 .got = fmt::format("{}", ends.size())});
  }
  const std::size_t anywhere = ends.size();  // where an open walk ends, beside the odd nodes
  const std::size_t all = ends.size() + (end == kNoNode ? 1 : 0);

  const WholeCosts whole(simple, 0);
  std::vector<NearestFirst> searches(ends.size());
  std::vector<std::vector<std::int64_t>> costs(all, std::vector<std::int64_t>(all, 0));
  std::vector<std::size_t> place(count);
  for (std::size_t i = 0; i < ends.size(); ++i) place[ends[i]] = i;
  for (std::size_t i = 0; i < ends.size(); ++i) {
    std::size_t reached = 1;
    searches[i].run(simple, ends[i], kNoLimit, [&](NodeId node, double cost) {
      if (odd[node]) {
        costs[i][place[node]] = whole.of(cost);
        ++reached;
      }
      return NearestFirst::Next::kThrough;
    });
    if (reached < ends.size()) return std::nullopt;
  }
  const std::vector<int> mate = cheapest_pairs(costs);
  const CheapestEdges cheapest(graph, simple);
  for (std::size_t i = 0; i < ends.size(); ++i) {
    const auto partner = static_cast<std::size_t>(mate[i]);
    if (partner == anywhere || partner < i) continue;
    std::vector<NodeId> way = {ends[i]};
    searches[i].append_path_to(ends[partner], way);
    for (std::size_t step = 1; step < way.size(); ++step) {
      parts.push_back({way[step - 1], way[step], cheapest.edge(way[step - 1], way[step])});
    }
  }
  return eulerian_walk(graph, /*directed=*/false, count, start, parts, 0);
}

}  // namespace

bool has_too_many_odd_nodes(const Multigraph& graph, EdgeKind kind, NodeId node_count) {
  if (kind == EdgeKind::kDirected) return false;
  std::vector<bool> odd(node_count);
  for (const Edge& edge : graph.edges) {
    odd[edge.a] = !odd[edge.a];
    odd[edge.b] = !odd[edge.b];
  }
  return std::ranges::count(odd, true) > kMostOddNodes - 2;  // the ends of a walk are odd, too
}

std::optional<PostmanWalk> postman_walk(const Multigraph& graph, EdgeKind kind, NodeId node_count, NodeId start,
                                        const PostmanOptions& options) {
  const Graph simple = Graph::from_edges(node_count, graph.arcs(), kind);
  if (kind == EdgeKind::kDirected) return DirectedPostman(graph, simple, start, options).walk();
  if (options.reset_cost) {
    throw Error({.what = "resets go with edges that lead one way", .expected = "a directed graph"});
  }
  auto walk = undirected_walk(graph, simple, start, options.end);
  if (!walk) return std::nullopt;
  const double cost = walk->cost;
  return PostmanWalk{.walk = *std::move(walk), .bound = cost};
}

}  // namespace graphdrl
