#include "graphdrl/answer/answer.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "graphdrl/base/error.h"
#include "graphdrl/env/episode.h"
#include "graphdrl/eval/comparison.h"
#include "graphdrl/eval/rollout.h"
#include "graphdrl/planners/bound.h"
#include "graphdrl/planners/exact.h"
#include "graphdrl/planners/planner_policy.h"

namespace graphdrl {
namespace {

// Of the time: the bound may take a share of it before planning, and what comes after planning has the rest.
constexpr double kBoundShare = 0.3;
constexpr double kPlanShare = 0.97;

// Of linear programs for a walk of any origin, as of a search without a deadline.
constexpr double kCutWork = 1e7;
constexpr double kBranchWork = 2e6;

const char* usual_policy(const PlanRequest& request, const World& world) {
  if (request.reveal.all()) return kPlanPolicy;
  if (request.believed) return kBelievingPolicy;
  const bool sees_far = request.reveal.kind() != Reveal::Kind::kEdges;
  return request.score == Score::kSeen && sees_far && world.has_cells() ? kSeeingPolicy : kOnlinePolicy;
}

PolicySpec spec_of(const PlanRequest& request, const World& world) {
  PolicySpec spec = parse_policy(request.policy.empty() ? usual_policy(request, world) : request.policy);
  if (!request.iterations) return spec;
  if (spec.kind != PolicyKind::kSearch) {
    throw Error({.what = "--iterations goes with the policy search", .got = in_quotes(request.policy, 200)});
  }
  return parse_policy(fmt::format("search:{}", *request.iterations));
}

int count_unreachable(const World& world, NodeId start) {
  int reached = 1;
  NearestFirst().run(world.open(), start, kNoLimit, [&](NodeId, double) {
    ++reached;
    return NearestFirst::Next::kThrough;
  });
  return world.valid_count() - reached;
}

// Walks the plan through an episode before it is believed.
void check_plan(const World& world, const Task& task, const Plan& plan) {
  Episode episode(world, task, {.action_space = action_space_of(world)});
  follow_walk(episode, plan.walk);
  const bool ends_well = task.ends_anywhere() || episode.position() == task.end();
  if (!ends_well || episode.visited_count() != plan.visited) throw std::logic_error("the plan is not what it says");
}

// What makes the walk: one of the two.
struct Chosen {
  std::unique_ptr<Planner> planner = {};
  std::unique_ptr<Policy> policy = {};
};

// label: what the policy is called; changed where it has a name here.
Chosen choose(const PlanRequest& request, const World& world, std::string& label) {
  Chosen made;
  if (request.believed != nullptr) {
    if (request.reveal.all() || request.own_policy) {
      throw Error({.what = "an old map goes with a map that is not known, and with a policy that plans"});
    }
    if (request.own_planner) {
      made.policy = make_believing_policy(request.own_planner(), request.believed);
    } else {
      const PolicySpec spec = spec_of(request, world);
      label = spec.label;
      made.policy = make_believing_policy(spec, request.seed, request.believed);
    }
  } else if (request.own_planner && request.reveal.all()) {
    made.planner = request.own_planner();
  } else if (request.own_planner) {
    made.policy = std::make_unique<PlannerPolicy>(request.own_planner());  // on what is known
  } else if (request.own_policy) {
    made.policy = request.own_policy();
  } else {
    const PolicySpec spec = spec_of(request, world);
    label = spec.label;
    if (request.reveal.all()) made.planner = make_planner(spec, request.seed);
    if (made.planner == nullptr) {
      made.policy = request.reveal.all() ? make_policy(spec, request.seed) : make_online_policy(spec, request.seed);
    }
  }
  return made;
}

// The world with the resets of a walk as edges.
World with_resets(const World& world, const EdgeWalk& walk, double reset_cost) {
  std::vector<Edge> edges = world.graph().edges();
  const std::size_t before = edges.size();
  for (std::size_t i = 0; i < walk.edges.size(); ++i) {
    if (walk.edges[i] == EdgeWalk::kResetEdge) edges.push_back({walk.nodes[i], walk.nodes[i + 1], reset_cost});
  }
  if (edges.size() == before) return world;
  GraphMap map = world.to_map();
  map.multigraph = std::make_shared<const Multigraph>(all_edges(map));  // which resets are none of
  map.graph = Graph::from_edges(world.node_count(), edges, EdgeKind::kDirected);
  return World(world.name(), std::move(map));
}

std::vector<std::string> edge_summary(const Answer& answer) {
  const EdgeCover& edges = *answer.edges;
  const auto resets = std::ranges::count(edges.walk.edges, EdgeWalk::kResetEdge);
  std::string first = fmt::format(
      "walked {} of {} edges, {:.1f} %, for {}{}", edges.walked, edges.edges,
      edges.edges == 0 ? 100.0 : 100.0 * static_cast<double>(edges.walked) / static_cast<double>(edges.edges),
      decimal(edges.walk.cost),
      answer.until_covered ? "" : fmt::format(" of a budget of {}", decimal(answer.task.budget())));
  if (resets > 0) first += fmt::format(", {} reset{} among it", resets, resets == 1 ? "" : "s");
  std::vector<std::string> lines = {std::move(first)};
  if (edges.has_prizes) {
    lines.push_back(fmt::format("prize {} of {}, {:.1f} %", decimal(edges.prize), decimal(edges.total_prize),
                                edges.percent(edges.prize)));
  }
  if (!answer.reveal.all()) {
    lines.push_back(
        fmt::format("seen {} of {} nodes, {:.1f} %", answer.discovered.nodes.size(), answer.world.valid_count(),
                    100.0 * static_cast<double>(answer.discovered.nodes.size()) / answer.world.valid_count()));
  }
  if (answer.known) {
    const auto price = answer.price_of_ignorance();
    lines.push_back(fmt::format("a walk that knows the map {} {}{} for {}{}", edges.has_prizes ? "is worth" : "has",
                                decimal(answer.known->prize), edges.has_prizes ? "" : " edges",
                                decimal(answer.known->cost),
                                price ? fmt::format(": the price of ignorance is {:.3f}", *price) : ""));
  }
  if (edges.all_cheapest) {
    lines.emplace_back("optimal: no walk over all edges is cheaper");
  } else if (edges.least_cost > 0) {
    lines.push_back(fmt::format("no walk over all edges costs less than {}", decimal(edges.least_cost)));
  } else if (edges.optimal()) {
    lines.emplace_back(edges.has_prizes ? "optimal: no walk is worth more" : "optimal: no walk has more edges");
  } else {
    lines.push_back(fmt::format("no walk {} than {}{}, {:.1f} %: the gap is {:.1f} points",
                                edges.has_prizes ? "is worth more" : "has more", decimal(edges.bound),
                                edges.has_prizes ? "" : " edges", edges.percent(edges.bound),
                                edges.percent(edges.bound - edges.prize)));
  }
  if (answer.unreachable > 0) {
    lines.push_back(fmt::format("{} node{} cannot be reached from the start", answer.unreachable,
                                answer.unreachable == 1 ? "" : "s"));
  }
  return lines;
}

}  // namespace

Answer edge_answer(const World& world, const Task& task, EdgeCover cover, const std::string& policy) {
  Answer answer{.world = with_resets(world, cover.walk, cover.reset_cost.value_or(0)),
                .task = task,
                .policy = policy,
                .plan = {},
                .until_covered = !task.has_budget()};
  std::vector<bool> visited(world.node_count());
  for (const NodeId node : cover.walk.nodes) {
    if (answer.plan.walk.empty() || answer.plan.walk.back() != node) answer.plan.walk.push_back(node);
    if (visited[node]) continue;
    visited[node] = true;
    ++answer.plan.visited;
    answer.plan.prize += world.prize(node);
  }
  answer.plan.cost = cover.walk.cost;
  answer.edges = std::move(cover);
  answer.unreachable = count_unreachable(world, task.start());
  return answer;
}

namespace {

Answer plan_edges(const World& world, const Task& task, const PlanRequest& request, const Clock& clock) {
  if (!request.reveal.all() || request.own_policy) {
    throw Error({.what = "edges are covered on maps that are known, by planners"});
  }
  if (request.reset_cost && !world.open().directed()) {
    throw Error({.what = "resets go with edges that lead one way", .where = world.name()});
  }
  const Stopwatch watch;
  PlanRequest nodes = request;
  nodes.cover = Cover::kNodes;
  nodes.reset_cost.reset();
  std::string policy;
  EdgeCover cover = cover_edges(world, task, request.reset_cost, [&](const World& halved, const Task& halved_task) {
    Answer made = make_plan(halved, halved_task, nodes, clock.share(kPlanShare));
    policy = made.policy;
    return std::move(made.plan);
  });
  if (!cover.policy.empty()) policy = cover.policy;
  if (policy.empty()) policy = "nearest";
  Answer answer = edge_answer(world, task, std::move(cover), policy);
  answer.elapsed_s = watch.seconds();
  return answer;
}

}  // namespace

Answer make_plan(const World& world, const Task& task, const PlanRequest& request, const Clock& clock) {
  if (request.price_s && (request.reveal.all() || request.score == Score::kSeen)) {
    throw Error({.what = "the price of ignorance is that of nodes visited on maps that are not known"});
  }
  if (request.cover == Cover::kEdges) return plan_edges(world, task, request, clock);
  if (request.reset_cost) throw Error({.what = "resets go with --cover edges"});
  const Stopwatch watch;
  const Clock bound_clock = clock.share(kBoundShare);
  const Clock plan_clock = clock.share(kPlanShare);
  Answer answer{.world = world,
                .task = task,
                .policy = request.policy,
                .plan = {},
                .reveal = request.reveal,
                .score = request.score,
                .until_covered = request.until_covered || !task.has_budget()};
  const auto [planner, policy] = choose(request, world, answer.policy);
  const bool bounds = planner != nullptr && planner->bounds();
  const double bound = bounds || request.score == Score::kSeen ? kNoLimit : max_prize(task, bound_clock);
  if (planner != nullptr) {
    answer.plan = planner->plan(task, plan_clock);
  } else {
    const EpisodeOptions options{
        .action_space = request.reveal.all() ? action_space_of(world) : ActionSpace::kNeighbours,
        .reveal = request.reveal,
        .score = request.score,
        .believed = request.believed,
        .numbers_seed = request.seed};
    answer.plan = plan_by_steps(world, task, options, *policy, plan_clock, request.think_s, &answer.discovered);
  }
  check_plan(world, task, answer.plan);
  if (request.price_s) {
    answer.known = plan_knowing_the_map(task, request.until_covered, *request.price_s, request.seed, clock);
  }
  answer.plan.settle(bound);
  answer.unreachable = count_unreachable(world, task.start());
  answer.elapsed_s = watch.seconds();
  return answer;
}

std::optional<double> Answer::price_of_ignorance() const {
  if (known && edges) {
    if (until_covered && known->prize != edges->prize) return std::nullopt;
    return until_covered ? graphdrl::price_of_ignorance(known->cost, plan.cost, /*costs=*/true)
                         : graphdrl::price_of_ignorance(known->prize, edges->prize, /*costs=*/false);
  }
  if (!known || (until_covered && known->visited != plan.visited)) return std::nullopt;
  return until_covered ? graphdrl::price_of_ignorance(known->cost, plan.cost, /*costs=*/true)
                       : graphdrl::price_of_ignorance(known->prize, plan.prize, /*costs=*/false);
}

void judge(Answer& answer) {
  if (answer.edges) {
    answer.edges = judge_edges(answer.world, answer.task, answer.edges->reset_cost, std::move(answer.edges->walk));
    return;
  }
  const Task& task = answer.task;
  Plan& plan = answer.plan;
  plan.bound = kNoLimit;
  plan.optimal = false;
  plan.settle(max_prize(task));
  if (const auto lp = plan.optimal ? nullptr : make_lp_bound(task, plan.bound)) {
    lp->cut(plan.prize, {.work = kCutWork});
    if (!meets(plan.prize, lp->bound())) lp->branch(plan.prize, {.work = kBranchWork});
    plan.settle(lp->bound());
  }
  if (!plan.optimal) plan.settle(exact_prize(task).value_or(kNoLimit));
  answer.unreachable = count_unreachable(answer.world, task.start());
}

std::vector<std::string> plan_summary(const Answer& answer) {
  if (answer.edges) return edge_summary(answer);
  const World& world = answer.world;
  const Plan& plan = answer.plan;
  std::string length;
  if (world.has_cells() && world.map()->frame) {
    length = fmt::format(" ({:.4g} {})", plan.cost * world.map()->frame->cell_size, world.unit());
  }
  std::vector<std::string> lines = {
      fmt::format("visited {} of {} nodes, {:.1f} %, for {}{}{}", plan.visited, world.valid_count(),
                  100.0 * plan.visited / world.valid_count(), decimal(plan.cost), length,
                  answer.until_covered ? "" : fmt::format(" of a budget of {}", decimal(answer.task.budget())))};
  if (world.has_prizes()) {
    lines.push_back(fmt::format("prize {} of {}, {:.1f} %", decimal(plan.prize), decimal(world.total_prize()),
                                world.percent_of_all(plan.prize)));
  }
  const bool hidden = !answer.reveal.all();
  if (hidden) {
    lines.push_back(fmt::format("seen {} of {} nodes, {:.1f} %", answer.discovered.nodes.size(), world.valid_count(),
                                100.0 * static_cast<double>(answer.discovered.nodes.size()) / world.valid_count()));
  }
  if (const int left = answer.discovered.no_way_back; left > 0) {
    lines.push_back(fmt::format("{} node{} not entered: no way back is known", left, left == 1 ? " was" : "s were"));
  }
  if (answer.known) {
    const auto price = answer.price_of_ignorance();
    lines.push_back(fmt::format("a walk that knows the map visits {} for {}{}", answer.known->visited,
                                decimal(answer.known->cost),
                                price ? fmt::format(": the price of ignorance is {:.3f}", *price) : ""));
  }
  if (answer.score == Score::kSeen) return lines;
  const std::string what =
      fmt::format("{}{}", hidden ? "that knew the map " : "", world.has_prizes() ? "is worth more" : "visits more");
  if (plan.optimal) {
    lines.push_back(fmt::format("optimal: no walk {}", what));
  } else {
    const std::string most = world.has_prizes() ? decimal(plan.bound) : fmt::format("{} nodes", answer.max_visited());
    const double bound_percent = world.percent_of_all(plan.bound);
    lines.push_back(fmt::format("no walk {} than {}, {:.1f} %: the gap is {:.1f} points", what, most, bound_percent,
                                bound_percent - world.percent_of_all(plan.prize)));
  }
  if (answer.unreachable > 0) {
    lines.push_back(fmt::format("{} node{} cannot be reached from the start", answer.unreachable,
                                answer.unreachable == 1 ? "" : "s"));
  }
  return lines;
}

}  // namespace graphdrl
