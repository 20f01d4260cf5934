#include "graphdrl/live/edge_exploration.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <unordered_map>
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
        walked_(edges_.graph.edges.size()) {
    const std::vector<Edge>& edges = edges_.graph.edges;
    const Multigraph* const all = world.multigraph();
    for (std::size_t i = 0; i < edges.size(); ++i) {
      // Both ends of an edge call it the same, and nothing else.
      const bool named = directed_ && all != nullptr;
      const std::string label = named ? all->label(static_cast<std::size_t>(edges_.numbers[i])) : "";
      add(edges[i].a, i, label);
      const bool back = !directed_ || edges_.graph.leads_back(i);
      if (back && edges[i].a != edges[i].b) add(edges[i].b, i, label);
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

  // Does a move; gives where it leads.
  NodeId walk(NodeId node, const std::string& name, EdgeWalk& walk) {
    const auto move = std::ranges::find(moves_[node], name, &Move::name);
    walked_[move->edge] = true;
    walk.edges.push_back(edges_.numbers[move->edge]);
    walk.cost += edges_.graph.edges[move->edge].cost;
    return other_end(move->edge, node);
  }

 private:
  struct Move {
    std::string name;
    std::size_t edge;
  };

  void add(NodeId node, std::size_t edge, const std::string& label) {
    const auto is_it = [&](const Move& one) { return one.name == label; };
    const bool unclear = label.empty() || std::ranges::any_of(moves_[node], is_it);
    moves_[node].push_back({unclear ? fmt::format("{}#{}", label, edge) : label, edge});
  }
  NodeId other_end(std::size_t edge, NodeId node) const {
    const Edge& both = edges_.graph.edges[edge];
    return both.a == node ? both.b : both.a;
  }

  bool directed_;
  WalkableEdges edges_;
  std::vector<std::vector<Move>> moves_;  // [N]
  std::vector<bool> walked_;              // [edges], from either end
};

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
  WorldClient client(world, request.seed);
  EdgeWalk walk{.nodes = {task.start()}};
  Discovered discovered;
  std::vector<bool> seen(world.node_count());
  const auto see = [&](NodeId node) {
    if (!seen[node]) discovered.nodes.push_back(node);
    seen[node] = true;
  };
  std::optional<double> cost;
  while (true) {
    const NodeId here = walk.nodes.back();
    std::vector<OfferedMove> moves = client.moves(here);
    see(here);
    for (const OfferedMove& move : moves) see(static_cast<NodeId>(std::stoll(*move.to)));
    const auto count = static_cast<int>(discovered.nodes.size());
    const bool stayed = walk.nodes.size() > 1 && here == walk.nodes[walk.nodes.size() - 2];  // a loop
    if (!stayed) discovered.after_step.push_back(count);
    exploration.observe({.state = WorldClient::name_of(here), .cost = cost, .moves = std::move(moves)});
    if (clock.passed()) exploration.end();
    const LiveStep& step = exploration.next();
    if (step.kind == LiveStep::Kind::kDone) break;
    const double before = walk.cost;
    if (step.kind == LiveStep::Kind::kReset) {
      walk.edges.push_back(EdgeWalk::kResetEdge);
      walk.nodes.push_back(task.start());
      walk.cost += *request.reset_cost;
    } else {
      walk.nodes.push_back(client.walk(here, step.move, walk));
    }
    cost = walk.cost - before;
  }
  Answer answer = edge_answer(world, task, judge_edges(world, task, request.reset_cost, std::move(walk)),
                              exploration.options().policy);
  answer.reveal = request.reveal;
  answer.discovered = std::move(discovered);
  answer.until_covered = request.until_covered || answer.until_covered;
  if (request.price_s) {
    const Clock thinks = clock.at_most(*request.price_s);
    const EdgeCover known =
        cover_edges(world, task, request.reset_cost, [&](const World& halved, const Task& halved_task) {
          return make_plan(halved, halved_task, {.seed = request.seed}, thinks).plan;
        });
    answer.known = Plan{.walk = known.walk.nodes, .prize = known.prize, .cost = known.walk.cost};
  }
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
