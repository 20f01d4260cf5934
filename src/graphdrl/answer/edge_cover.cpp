#include "graphdrl/answer/edge_cover.h"

#include <algorithm>
#include <bit>
#include <optional>
#include <queue>
#include <tuple>
#include <utility>

#include "graphdrl/base/random.h"
#include "graphdrl/graph/search.h"

namespace graphdrl {
namespace {

constexpr std::int64_t kExactStates = 4'000'000;

// Of undirected graphs: greedy walks by distances with noise, the best of which counts.
constexpr double kNoise = 1.5;
constexpr std::int64_t kNoisyWork = 20'000'000;  // edges looked at, about
constexpr std::int64_t kMostNoisyTries = 2000;
constexpr std::uint64_t kNoiseSeed = 1;

// One budgeted search for a walk over edges, by their places in the list of walkable ones.
class EdgePlanner {
 public:
  EdgePlanner(const World& world, const Task& task, const Multigraph& graph, std::optional<double> reset_cost)
      : world_(world),
        task_(task),
        graph_(graph),
        reset_cost_(reset_cost),
        directed_(world.open().directed()),
        most_prize_(graph.prizes.empty() ? 1 : *std::ranges::max_element(graph.prizes)),
        limit_(task.limit()),
        leaving_(world.node_count()) {
    for (std::size_t i = 0; i < graph.edges.size(); ++i) {
      const Edge& edge = graph.edges[i];
      leaving_[edge.a].push_back(static_cast<std::int64_t>(i));
      if (leads_back(i) && edge.a != edge.b) leaving_[edge.b].push_back(static_cast<std::int64_t>(i));
    }
  }

  // By all positions and sets of edges walked [Dijkstra]. Empty where there are too many.
  std::optional<EdgeWalk> exact() const {
    const auto edges = static_cast<std::int64_t>(graph_.edges.size());
    const std::int64_t nodes = world_.node_count();
    if (edges > kExactEdges || (nodes << edges) > kExactStates) return std::nullopt;
    struct State {
      double cost = kNoLimit;
      std::int64_t from = -1;  // the state before, and the edge between
      std::int64_t edge = EdgeWalk::kResetEdge;
    };
    std::vector<State> states(static_cast<std::size_t>(nodes << edges));
    using Entry = std::pair<double, std::int64_t>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> heap;
    const auto reach = [&](std::int64_t state, double cost, std::int64_t from, std::int64_t edge) {
      const NodeId node = static_cast<NodeId>(state >> edges);
      if (cost + cost_to_end(node) > limit_ || cost >= states[state].cost) return;
      states[state] = {.cost = cost, .from = from, .edge = edge};
      heap.emplace(cost, state);
    };
    const std::int64_t all = (std::int64_t{1} << edges) - 1;
    std::vector<double> worth(static_cast<std::size_t>(all) + 1);  // of sets of edges
    for (std::int64_t set = 1; set <= all; ++set) {
      const auto last = static_cast<int>(std::bit_width(static_cast<std::uint64_t>(set))) - 1;
      worth[set] = worth[set ^ (std::int64_t{1} << last)] + graph_.prize(last);
    }
    reach(std::int64_t{task_.start()} << edges, 0, -1, EdgeWalk::kResetEdge);
    std::int64_t best = -1;
    std::tuple<double, double> best_rank = {-1, 0};
    while (!heap.empty()) {
      const auto [cost, state] = heap.top();
      heap.pop();
      if (cost > states[state].cost) continue;
      const NodeId node = static_cast<NodeId>(state >> edges);
      const std::int64_t walked = state & all;
      if (task_.ends_anywhere() || node == task_.end()) {
        const std::tuple rank{worth[walked], -cost};
        if (rank > best_rank) std::tie(best, best_rank) = std::tuple(state, rank);
      }
      for (const std::int64_t edge : leaving_[node]) {
        const NodeId next = other_end(edge, node);
        reach(std::int64_t{next} << edges | walked | std::int64_t{1} << edge, cost + graph_.edges[edge].cost, state,
              edge);
      }
      if (reset_cost_)
        reach(std::int64_t{task_.start()} << edges | walked, cost + *reset_cost_, state, EdgeWalk::kResetEdge);
    }
    if (best < 0) return std::nullopt;
    EdgeWalk walk;
    for (std::int64_t state = best; state >= 0; state = states[state].from) {
      walk.nodes.push_back(static_cast<NodeId>(state >> edges));
      if (states[state].from >= 0) walk.edges.push_back(states[state].edge);
    }
    std::ranges::reverse(walk.nodes);
    std::ranges::reverse(walk.edges);
    walk.cost = states[best].cost;
    return walk;
  }

  // A walk that begins with these edges, as far as the budget goes, and goes on to the nearest edge left; then to the
  // end. noise: by how much of themselves distances may seem longer.
  EdgeWalk greedy(const std::vector<std::int64_t>& first, double noise, Rng& rng) const {
    Growing grown{.walk = {.nodes = {task_.start()}}, .walked = std::vector<bool>(graph_.edges.size())};
    EdgeWalk& walk = grown.walk;
    for (const std::int64_t edge : first) {
      const NodeId next = edge < 0 ? task_.start() : other_end(edge, walk.nodes.back());
      const double cost = edge < 0 ? reset_cost_.value_or(kNoLimit) : graph_.edges[edge].cost;
      if (walk.cost + cost + cost_to_end(next) > limit_) break;
      take(grown, edge, next);
    }
    while (take_nearest(grown, noise, rng)) continue;
    if (reset_cost_ && cost_to_end(walk.nodes.back()) < task_.cost_to_end(walk.nodes.back())) {
      take(grown, EdgeWalk::kResetEdge, task_.start());
    }
    if (!task_.ends_anywhere() && walk.nodes.back() != task_.end()) {
      grown.search.run(world_.open(), walk.nodes.back(), kNoLimit, [&](NodeId node, double) {
        return node == task_.end() ? NearestFirst::Next::kEnd : NearestFirst::Next::kThrough;
      });
      go_to(grown, task_.end());
    }
    return std::move(grown.walk);
  }

  // A node in the middle of each edge, worth 1; other nodes are worth nothing. REQUIRES: is_planned().
  struct Planned {
    EdgeWalk walk;
    double bound;  // on its edges
  };
  Planned planned(const std::function<Plan(const World&, const Task&)>& plan_nodes) const {
    const NodeId nodes = world_.node_count();
    const auto middle = [&](std::size_t edge) { return nodes + static_cast<NodeId>(edge); };
    GraphMap map;
    std::vector<Edge> halves;
    for (std::size_t i = 0; i < graph_.edges.size(); ++i) {
      halves.push_back({graph_.edges[i].a, middle(i), graph_.edges[i].cost});
      halves.push_back({middle(i), graph_.edges[i].b, 0});
    }
    if (reset_cost_) {
      for (NodeId node = 0; node < nodes; ++node) {
        if (node != task_.start()) halves.push_back({node, task_.start(), *reset_cost_});
      }
    }
    map.graph = Graph::from_edges(middle(graph_.edges.size()), halves, EdgeKind::kDirected);
    map.blocked = world_.blocked();
    map.blocked.resize(map.graph.node_count());
    map.prizes.assign(map.graph.node_count(), 1);
    std::fill_n(map.prizes.begin(), nodes, 0);
    std::ranges::copy(graph_.prizes, map.prizes.begin() + nodes);
    const World halved(world_.name(), std::move(map));
    const End end = task_.ends_anywhere() ? End::anywhere() : End::at(task_.end());
    const Plan plan = plan_nodes(halved, Task(halved, task_.start(), task_.budget(), end));
    EdgeWalk walk{.nodes = {task_.start()}};
    for (std::size_t i = 1; i < plan.walk.size(); ++i) {
      const NodeId node = plan.walk[i];
      if (node >= nodes) {
        const std::int64_t edge = node - nodes;
        walk.edges.push_back(edge);
        walk.nodes.push_back(graph_.edges[edge].b);
        walk.cost += graph_.edges[edge].cost;
      } else if (plan.walk[i - 1] < nodes) {
        walk.edges.push_back(EdgeWalk::kResetEdge);
        walk.nodes.push_back(node);
        walk.cost += *reset_cost_;
      }
    }
    return {.walk = std::move(walk), .bound = plan.optimal ? plan.prize : plan.bound};
  }

  // Of the edges that can be reached those that are worth most for their cost, as far as the budget pays for them; of
  // the next one a part where edges have prizes.
  double bound() const {
    std::vector<std::pair<double, double>> edges;  // costs and prizes
    std::vector<double> to(world_.node_count(), kNoLimit);
    to[task_.start()] = 0;
    NearestFirst().run(world_.open(), task_.start(), limit_, [&](NodeId node, double cost) {
      to[node] = cost;
      return NearestFirst::Next::kThrough;
    });
    for (std::size_t i = 0; i < graph_.edges.size(); ++i) {
      const auto& [a, b, cost] = graph_.edges[i];
      double least = to[a] + cost + cost_to_end(b);
      if (leads_back(i)) least = std::min(least, to[b] + cost + cost_to_end(a));
      if (least <= limit_ && graph_.prize(i) > 0) edges.emplace_back(cost, graph_.prize(i));
    }
    const auto cost_for_prize = [](const std::pair<double, double>& edge) { return edge.first / edge.second; };
    std::ranges::sort(edges, {}, cost_for_prize);
    double spent = 0;
    double sum = 0;
    for (const auto& [cost, prize] : edges) {
      if (spent + cost > limit_) {
        if (!graph_.prizes.empty()) sum += prize * (limit_ - spent) / cost;
        break;
      }
      spent += cost;
      sum += prize;
    }
    return sum;
  }

  double prize_of(const EdgeWalk& walk) const {
    std::vector<bool> walked(graph_.edges.size());
    double prize = 0;
    for (const std::int64_t edge : walk.edges) {
      if (edge < 0 || walked[edge]) continue;
      walked[edge] = true;
      prize += graph_.prize(static_cast<std::size_t>(edge));
    }
    return prize;
  }

  // Whether it is planned by planned(); else by many greedy walks.
  bool is_planned() const { return directed_ && graph_.both_ways.empty(); }

 private:
  struct Growing {
    EdgeWalk walk;
    std::vector<bool> walked;  // [edges]
    NearestFirst search = {};
  };

  void take(Growing& grown, std::int64_t edge, NodeId next) const {
    grown.walk.edges.push_back(edge);
    grown.walk.nodes.push_back(next);
    grown.walk.cost += edge < 0 ? *reset_cost_ : graph_.edges[edge].cost;
    if (edge >= 0) grown.walked[edge] = true;
  }

  // The cheapest way to a node that the search met, over its cheapest edges.
  void go_to(Growing& grown, NodeId goal) const {
    std::vector<NodeId> way;
    grown.search.append_path_to(goal, way);
    for (const NodeId next : way) take(grown, cheapest_between(grown.walk.nodes.back(), next), next);
  }

  // Goes to the nearest edge left, for its prize, and over it. False where none can be paid for.
  bool take_nearest(Growing& grown, double noise, Rng& rng) const {
    const NodeId here = grown.walk.nodes.back();
    std::int64_t nearest = -1;
    NodeId at = kNoNode;
    double least = kNoLimit;
    const auto look_at = [&](NodeId node, double cost) {
      for (const std::int64_t edge : leaving_[node]) {
        const double whole = cost + graph_.edges[edge].cost;
        const double prize = graph_.prize(static_cast<std::size_t>(edge));
        if (grown.walked[edge] || prize == 0) continue;
        if (grown.walk.cost + whole + cost_to_end(other_end(edge, node)) > limit_) continue;
        const double seeming = (noise == 0 ? cost : whole * (1 + noise * rng.uniform())) / prize;
        if (seeming >= least) continue;
        least = seeming;
        nearest = edge;
        at = node;
      }
      return cost >= least * most_prize_ ? NearestFirst::Next::kEnd : NearestFirst::Next::kThrough;
    };
    if (look_at(here, 0) == NearestFirst::Next::kThrough) {
      grown.search.run(world_.open(), here, limit_ - grown.walk.cost, look_at);
    }
    if (nearest < 0) return false;
    if (at != here) go_to(grown, at);
    take(grown, nearest, other_end(nearest, at));
    return true;
  }

  bool leads_back(std::size_t edge) const { return !directed_ || graph_.leads_back(edge); }
  double cost_to_end(NodeId node) const {
    const double cost = task_.cost_to_end(node);
    if (!reset_cost_ || task_.ends_anywhere()) return cost;
    return std::min(cost, *reset_cost_ + task_.cost_to_end(task_.start()));
  }
  NodeId other_end(std::int64_t edge, NodeId node) const {
    return graph_.edges[edge].a == node ? graph_.edges[edge].b : graph_.edges[edge].a;
  }
  std::int64_t cheapest_between(NodeId from, NodeId to) const {
    std::int64_t best = -1;
    for (const std::int64_t edge : leaving_[from]) {
      if (other_end(edge, from) != to) continue;
      if (best < 0 || graph_.edges[edge].cost < graph_.edges[best].cost) best = edge;
    }
    return best;
  }

  const World& world_;
  const Task& task_;
  const Multigraph& graph_;
  std::optional<double> reset_cost_;
  bool directed_;
  double most_prize_;  // of an edge
  double limit_;
  std::vector<std::vector<std::int64_t>> leaving_;  // [N], edges that lead on from a node
};

}  // namespace

Multigraph all_edges(const World& world) {
  return world.multigraph() != nullptr ? *world.multigraph() : Multigraph{.edges = world.graph().edges()};
}

WalkableEdges walkable_edges(const World& world) {
  const Multigraph all = all_edges(world);
  WalkableEdges walkable;
  for (std::size_t i = 0; i < all.edges.size(); ++i) {
    if (world.is_blocked(all.edges[i].a) || world.is_blocked(all.edges[i].b)) continue;
    walkable.graph.edges.push_back(all.edges[i]);
    if (!all.prizes.empty()) walkable.graph.prizes.push_back(all.prizes[i]);
    if (!all.both_ways.empty()) walkable.graph.both_ways.push_back(all.both_ways[i]);
    walkable.numbers.push_back(static_cast<std::int64_t>(i));
  }
  return walkable;
}

namespace {

// Fills in what there is, and what is walked.
void count_edges(const World& world, EdgeCover& cover) {
  const auto [graph, numbers] = walkable_edges(world);
  std::vector<std::int64_t> walked = cover.walk.edges;
  std::erase(walked, EdgeWalk::kResetEdge);
  std::ranges::sort(walked);
  walked.erase(std::unique(walked.begin(), walked.end()), walked.end());
  cover.edges = std::ssize(graph.edges);
  cover.walked = std::ssize(walked);
  cover.has_prizes = !graph.prizes.empty();
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    cover.total_prize += graph.prize(i);
    if (std::ranges::binary_search(walked, numbers[i])) cover.prize += graph.prize(i);
  }
}

std::optional<PostmanWalk> walk_over_all(const World& world, const Task& task, const Multigraph& graph,
                                         std::optional<double> reset_cost) {
  const EdgeKind kind = world.open().directed() ? EdgeKind::kDirected : EdgeKind::kUndirected;
  if (has_too_many_odd_nodes(graph, kind, world.node_count())) return std::nullopt;
  return postman_walk(graph, kind, world.node_count(), task.start(), {.end = task.end(), .reset_cost = reset_cost});
}

// Of a cover that walks all.
void compare_with_all(const PostmanWalk& all, EdgeCover& cover) {
  constexpr double kAsCheap = 1 + 1e-9;
  cover.least_cost = all.bound;
  cover.all_cheapest = cover.walk.cost <= all.bound * kAsCheap;
}

}  // namespace

EdgeCover cover_edges(const World& world, const Task& task, std::optional<double> reset_cost,
                      const std::function<Plan(const World&, const Task&)>& plan_nodes) {
  const auto [graph, numbers] = walkable_edges(world);
  EdgeCover cover{.walk = {}, .reset_cost = reset_cost};
  const auto all = walk_over_all(world, task, graph, reset_cost);
  const EdgePlanner planner(world, task, graph, reset_cost);
  cover.bound = planner.bound();
  if (all && all->walk.cost <= task.limit()) {
    cover.walk = all->walk;
    cover.policy = "postman";
    compare_with_all(*all, cover);
  } else if (auto exact = planner.exact()) {
    cover.walk = *std::move(exact);
    cover.policy = "exact";
  } else {
    Rng rng(kNoiseSeed);
    std::vector<EdgeWalk> walks = {planner.greedy({}, 0, rng)};
    if (all) walks.push_back(planner.greedy(all->walk.edges, 0, rng));
    if (planner.is_planned()) {
      auto [walk, bound] = planner.planned(plan_nodes);
      walks.push_back(std::move(walk));
      cover.bound = std::min(cover.bound, bound);
    } else {
      const auto edges = std::ssize(graph.edges);
      const std::int64_t tries = std::clamp<std::int64_t>(kNoisyWork / (edges * edges), 4, kMostNoisyTries);
      for (std::int64_t i = 0; i < tries; ++i) walks.push_back(planner.greedy({}, kNoise, rng));
    }
    const auto rank = [&](const EdgeWalk& walk) { return std::pair(planner.prize_of(walk), -walk.cost); };
    cover.walk = *std::ranges::max_element(walks, {}, rank);
  }
  for (std::int64_t& edge : cover.walk.edges) {
    if (edge >= 0) edge = numbers[edge];
  }
  count_edges(world, cover);
  // What is searched by states is the best; sums may differ by the order of rounding.
  cover.bound = cover.policy == "exact" ? cover.prize : std::max(cover.bound, cover.prize);
  cover.all_cheapest = cover.all_cheapest || (cover.policy == "exact" && cover.walked == cover.edges);
  return cover;
}

EdgeCover judge_edges(const World& world, const Task& task, std::optional<double> reset_cost, EdgeWalk walk) {
  const auto [graph, numbers] = walkable_edges(world);
  EdgeCover cover{.walk = std::move(walk), .reset_cost = reset_cost};
  count_edges(world, cover);
  cover.bound = std::max(cover.prize, EdgePlanner(world, task, graph, reset_cost).bound());
  if (cover.walked < cover.edges) return cover;
  if (const auto all = walk_over_all(world, task, graph, reset_cost)) compare_with_all(*all, cover);
  return cover;
}

}  // namespace graphdrl
