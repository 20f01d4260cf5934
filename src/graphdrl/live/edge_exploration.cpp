#include "graphdrl/live/edge_exploration.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "graphdrl/base/error.h"
#include "graphdrl/base/random.h"
#include "graphdrl/live/live_exploration.h"
#include "graphdrl/planners/registry.h"

namespace graphdrl {
namespace {

void check_request(const World& world, const Task& task, const PlanRequest& request) {
  if (request.reveal.kind() != Reveal::Kind::kEdges) {
    throw Error({.what = "edges are explored where visits show edges", .got = request.reveal.text()});
  }
  if (request.score == Score::kSeen)
    throw Error({.what = "edges count where they are walked, not where they are seen"});
  if (request.believed || request.own_planner || request.own_policy) {
    throw Error({.what = "edges of unknown maps are explored by policies of our own, without an old map"});
  }
  if (!task.ends_anywhere() && task.end() != task.start()) {
    throw Error({.what = "edges of unknown maps are explored to end anywhere or at the start"});
  }
  if (request.reset_cost && !world.open().directed()) {
    throw Error({.what = "resets go with edges that lead one way", .where = world.name()});
  }
}

// A world as a client of a live exploration knows it.
class WorldClient {
 public:
  WorldClient(const World& world, std::uint64_t seed)
      : directed_(world.open().directed()),
        edges_(walkable_edges(world)),
        moves_(world.node_count()),
        walked_(edges_.graph.edges.size()),
        news_(world.node_count()) {
    const std::vector<Edge>& edges = edges_.graph.edges;
    const Multigraph* const all = world.multigraph();
    for (std::size_t i = 0; i < edges.size(); ++i) {
      // Both ends of an edge call it the same, and nothing else.
      const bool named = directed_ && all != nullptr;
      const std::string label = named ? all->label(static_cast<std::size_t>(edges_.numbers[i])) : "";
      add(edges[i].a, i, label);
      if (leads_back(i) && edges[i].a != edges[i].b) add(edges[i].b, i, label);
    }
    // The order of a file says nothing.
    Rng rng(seed);
    for (std::vector<Move>& moves : moves_) {
      for (std::size_t left = moves.size(); left > 1; --left) {
        std::swap(moves[static_cast<std::size_t>(rng.index(static_cast<int>(left)))], moves[left - 1]);
      }
    }
  }

  static std::string name_of(NodeId node) { return std::to_string(node); }

  std::vector<OfferedMove> moves(NodeId node) const {
    std::vector<OfferedMove> moves;
    for (const Move& move : moves_[node]) {
      moves.push_back({.name = move.name,
                       .to = name_of(other_end(move.edge, node)),
                       .cost = edges_.graph.edges[move.edge].cost,
                       .tried = walked_[move.edge]});
    }
    return moves;
  }
  // Whether the moves of a node have to be told again: one was walked from its other end.
  bool has_news(NodeId node) const { return news_[node]; }

  // Does a move. Gives where it leads, and what it costs.
  std::pair<NodeId, double> walk(NodeId node, const std::string& name, EdgeWalk& walk) {
    const std::size_t edge = edge_of_.at({node, name});
    const NodeId to = other_end(edge, node);
    news_[to] = leads_back(edge) && !walked_[edge];
    walked_[edge] = true;
    walk.edges.push_back(edges_.numbers[edge]);
    return {to, edges_.graph.edges[edge].cost};
  }

 private:
  struct Move {
    std::string name;
    std::size_t edge;
  };

  // By its label, unless another move of the node has it.
  void add(NodeId node, std::size_t edge, const std::string& label) {
    std::string name = label.empty() ? fmt::format("#{}", edge) : label;
    while (!edge_of_.emplace(std::pair(node, name), edge).second) name += fmt::format("#{}", edge);
    moves_[node].push_back({std::move(name), edge});
  }
  bool leads_back(std::size_t edge) const { return !directed_ || edges_.graph.leads_back(edge); }
  NodeId other_end(std::size_t edge, NodeId node) const {
    const Edge& both = edges_.graph.edges[edge];
    return both.a == node ? both.b : both.a;
  }

  bool directed_;
  WalkableEdges edges_;
  std::vector<std::vector<Move>> moves_;  // [N]
  std::map<std::pair<NodeId, std::string>, std::size_t> edge_of_;
  std::vector<bool> walked_;  // [edges], from either end
  std::vector<bool> news_;    // [N]
};

// A walk, and how the nodes became known.
struct Explored {
  EdgeWalk walk;
  Discovered discovered = {};
};

// Does what the exploration says until there is nothing to do.
Explored walk_edges(const World& world, const Task& task, const PlanRequest& request, LiveExploration& exploration,
                    const Clock& clock) {
  WorldClient client(world, request.seed);
  Explored explored{.walk = {.nodes = {task.start()}}};
  EdgeWalk& walk = explored.walk;
  Discovered& discovered = explored.discovered;
  std::vector<bool> seen(world.node_count());
  std::vector<bool> visited(world.node_count());
  const auto see = [&](NodeId node) {
    if (!seen[node]) discovered.nodes.push_back(node);
    seen[node] = true;
  };
  std::optional<double> cost;
  while (true) {
    const NodeId here = walk.nodes.back();
    LiveObservation told{.state = WorldClient::name_of(here), .cost = cost};
    if (!visited[here] || client.has_news(here)) told.moves = client.moves(here);
    if (!visited[here]) {
      see(here);
      for (const OfferedMove& move : *told.moves) see(static_cast<NodeId>(std::stoll(*move.to)));
    }
    visited[here] = true;
    const auto count = static_cast<int>(discovered.nodes.size());
    const bool stayed = walk.nodes.size() > 1 && here == walk.nodes[walk.nodes.size() - 2];  // a loop
    if (!stayed) discovered.after_step.push_back(count);
    exploration.observe(told);
    if (clock.passed()) exploration.end();
    const LiveStep& step = exploration.next();
    if (step.kind == LiveStep::Kind::kDone) break;
    if (step.kind == LiveStep::Kind::kReset) {
      walk.edges.push_back(EdgeWalk::kResetEdge);
      walk.nodes.push_back(task.start());
      cost = request.reset_cost;
    } else {
      const auto [to, paid] = client.walk(here, step.move, walk);
      walk.nodes.push_back(to);
      cost = paid;
    }
    walk.cost += *cost;
  }
  return explored;
}

// By a walk that knows the map.
Plan plan_known_edges(const World& world, const Task& task, const PlanRequest& request, const Clock& clock) {
  const Clock thinks = clock.at_most(*request.price_s);
  const EdgeCover known =
      cover_edges(world, task, request.reset_cost, [&](const World& halved, const Task& halved_task) {
        return make_plan(halved, halved_task, {.seed = request.seed}, thinks).plan;
      });
  return Plan{.walk = known.walk.nodes, .prize = known.prize, .cost = known.walk.cost};
}

Answer explore_edges(const World& world, const Task& task, const PlanRequest& request, const Clock& clock) {
  check_request(world, task, request);
  const Stopwatch watch;
  LiveExploration exploration({.cover = Cover::kEdges,
                               .directed = world.open().directed(),
                               .budget = task.has_budget() ? task.budget() : kNoLimit,
                               .end_at_start = !task.ends_anywhere(),
                               .reset_cost = request.reset_cost,
                               .policy = request.policy,
                               .think_s = request.think_s,
                               .seed = request.seed});
  auto [walk, discovered] = walk_edges(world, task, request, exploration, clock);
  Answer answer = edge_answer(world, task, judge_edges(world, task, request.reset_cost, std::move(walk)),
                              exploration.options().policy);
  answer.reveal = request.reveal;
  answer.discovered = std::move(discovered);
  answer.until_covered = request.until_covered || answer.until_covered;
  if (request.price_s) answer.known = plan_known_edges(world, task, request, clock);
  answer.elapsed_s = watch.seconds();
  return answer;
}

}  // namespace

Answer answer_task(const World& world, const Task& task, const PlanRequest& request, const Clock& clock) {
  const bool explores_edges = request.cover == Cover::kEdges && !request.reveal.all();
  return explores_edges ? explore_edges(world, task, request, clock) : make_plan(world, task, request, clock);
}

void compare_edges(ComparisonOptions& options, std::optional<double> reset_cost) {
  for (const std::string& policy : options.policies) {
    if (options.reveal.all()) {
      parse_policy(policy);
    } else {
      const LiveExploration trial({.policy = policy});
    }
  }
  const auto walked = [](const Answer& answer) {
    return ComparisonOptions::Walked{answer.edges->percent(answer.edges->prize), answer.plan.cost};
  };
  PlanRequest request{.reveal = options.reveal,
                      .score = options.score,
                      .cover = Cover::kEdges,
                      .reset_cost = reset_cost,
                      .until_covered = options.until_covered};
  options.cover_edges = [request, walked](const World& world, const Task& task, const std::string& policy,
                                          std::uint64_t seed) {
    PlanRequest one = request;
    one.policy = policy;
    one.seed = seed;
    const Answer answer = answer_task(world, task, one);
    if (one.until_covered && answer.edges->walked < answer.edges->edges) {
      throw Error({.what = "costs until covered cannot be compared where not all edges can be walked",
                   .got = fmt::format("{} of {} by {}", answer.edges->walked, answer.edges->edges, policy),
                   .where = world.name()});
    }
    return walked(answer);
  };
  options.cover_known_edges = [request, walked, price_s = options.price_s](const World& world, const Task& task) {
    PlanRequest one = request;
    one.reveal = Reveal();
    return walked(answer_task(world, task, one, Clock().at_most(price_s.value_or(kNoLimit))));
  };
}

}  // namespace graphdrl
