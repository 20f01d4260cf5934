#include "graphdrl/planners/believing_policy.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "graphdrl/base/error.h"

namespace graphdrl {
namespace {

constexpr std::size_t kMostBeliefs = 64;  // as many as the episodes of a block in eval/rollout
// An old map is given up once more than this share of the edges looked at is wrong, of a few at least.
constexpr double kMostWrong = 0.3;
constexpr int kFewestCompared = 20;
constexpr double kSameCost = 1e-9;  // relative

using Ways = std::vector<std::pair<NodeId, double>>;

Ways::iterator find_way_to(Ways& ways, NodeId to) {
  return std::ranges::find(ways, to, [](const auto& way) { return way.first; });
}

void put(Ways& ways, NodeId to, double cost) {
  const auto way = find_way_to(ways, to);
  if (way == ways.end()) {
    ways.emplace_back(to, cost);
  } else {
    way->second = cost;
  }
}

void take(Ways& ways, NodeId to) {
  if (const auto way = find_way_to(ways, to); way != ways.end()) ways.erase(way);
}

// The first visits of a walk, as far as they can still be made: those without a way, or too dear, are left out.
std::vector<NodeId> repaired(const Task& task, std::span<const NodeId> rest, NearestFirst& search) {
  const Graph& open = task.view().open();
  NodeSet ground = task.ground();
  std::vector<NodeId> walk = {task.start()};
  double left = task.limit();
  for (const NodeId next : rest) {
    if (ground.contains(next) || !find_way(open, walk.back(), next, ground, search)) continue;
    std::vector<NodeId> way = {walk.back()};
    search.append_path_to(next, way);
    double cost = 0;
    for (std::size_t i = 1; i < way.size(); ++i) cost += open.cost(way[i - 1], open.index_of(way[i - 1], way[i]));
    if (cost + task.cost_to_end(next) > left) continue;
    left -= cost;
    walk.insert(walk.end(), way.begin() + 1, way.end());
    ground.insert(next);
  }
  append_way_to_end(task, walk, search);
  return walk;
}

}  // namespace

void BelievingPolicy::act(std::span<const Observation> observations, std::span<int> actions, const Clock& clock) {
  for (std::size_t i = 0; i < observations.size(); ++i) actions[i] = act_on(observations[i], clock);
}

BelievingPolicy::Belief& BelievingPolicy::belief_of(const View& view) {
  const auto known = std::ranges::find_if(beliefs_, [&](const Belief& belief) { return belief.view == view; });
  if (known != beliefs_.end()) return *known;
  Belief belief{.view = view};
  const Graph& open = old_->world.open();
  belief.seen_as.assign(open.node_count(), kNoNode);
  belief.ways.resize(open.node_count());
  for (NodeId node = 0; node < open.node_count(); ++node) {
    for (int i = 0; i < open.degree(node); ++i)
      belief.ways[node].emplace_back(open.neighbours(node)[i], open.cost(node, i));
  }
  if (beliefs_.size() < kMostBeliefs) return beliefs_.emplace_back(std::move(belief));
  return beliefs_[oldest_++ % kMostBeliefs] = std::move(belief);
}

// Takes in what has become known.
void BelievingPolicy::learn(Belief& belief) {
  const View& view = belief.view;
  if (belief.version == view.version()) return;
  belief.version = view.version();
  for (auto node = static_cast<NodeId>(belief.believed_as.size()); node < view.node_count(); ++node) {
    NodeId as = view.believed_as(node);
    if (as == kNoNode) {
      as = static_cast<NodeId>(belief.ways.size());
      belief.ways.emplace_back();
      belief.seen_as.push_back(kNoNode);
    }
    belief.believed_as.push_back(as);
    belief.seen_as[as] = node;
    belief.open.push_back(node);
    const World& old = old_->world;
    const double prize_before = as < old.node_count() && !old.is_blocked(as) ? old.prize(as) : 0;
    if (view.prize(node) == prize_before) continue;
    belief.map = nullptr;
    belief.news = true;
  }
  std::vector<NodeId> open;
  for (const NodeId node : std::exchange(belief.open, {})) {
    if (view.is_frontier(node)) {
      open.push_back(node);
      take_in_edges(belief, node);
    } else {
      correct(belief, node);
    }
  }
  belief.open = std::move(open);
}

// Some of the edges that lead on from a node may be known.
void BelievingPolicy::take_in_edges(Belief& belief, NodeId node) {
  const Graph& open = belief.view.open();
  Ways& ways = belief.ways[belief.believed_as[node]];
  for (int i = 0; i < open.degree(node); ++i) {
    const NodeId to = belief.believed_as[open.neighbours(node)[i]];
    const auto way = find_way_to(ways, to);
    if (way != ways.end() && way->second == open.cost(node, i)) continue;
    put(ways, to, open.cost(node, i));
    belief.map = nullptr;
  }
}

// All edges that lead on from a node are known.
void BelievingPolicy::correct(Belief& belief, NodeId node) {
  const Graph& open = belief.view.open();
  const NodeId as = belief.believed_as[node];
  const auto is_settled = [&](NodeId believed) {
    const NodeId seen = belief.seen_as[believed];
    return !open.directed() && seen != kNoNode && seen != node && !belief.view.is_frontier(seen);
  };
  Ways truth;
  for (int i = 0; i < open.degree(node); ++i)
    truth.emplace_back(belief.believed_as[open.neighbours(node)[i]], open.cost(node, i));
  const Ways before = belief.ways[as];
  for (const auto& [to, cost] : before) {
    const auto now = find_way_to(truth, to);
    const bool same = now != truth.end() && std::abs(now->second - cost) <= kSameCost * std::max(now->second, cost);
    if (!is_settled(to)) ++(same ? belief.right : belief.wrong);
    if (same) continue;
    belief.map = nullptr;
    if (now == truth.end() && !open.directed()) take(belief.ways[to], as);
  }
  for (const auto& [to, cost] : truth) {
    if (find_way_to(belief.ways[as], to) == belief.ways[as].end()) {
      ++belief.wrong;
      belief.map = nullptr;
    }
    if (!open.directed()) put(belief.ways[to], as, cost);
  }
  if (belief.map == nullptr) belief.ways[as] = std::move(truth);
  const int compared = belief.right + belief.wrong;
  if (compared >= kFewestCompared && belief.wrong > kMostWrong * compared) belief.trusted = false;
}

void BelievingPolicy::plan_anew(Belief& belief, const Observation& now, const Clock& clock) {
  const auto count = static_cast<NodeId>(belief.ways.size());
  if (belief.map == nullptr) {
    const World& old = old_->world;
    Known known{.name = belief.view.name(), .open = {}, .blocked = std::vector<bool>(count)};
    std::vector<Edge> edges;
    for (NodeId node = 0; node < count; ++node) {
      for (const auto& [to, cost] : belief.ways[node]) edges.push_back({node, to, cost});
      known.blocked[node] = node < old.node_count() && old.is_blocked(node) && belief.seen_as[node] == kNoNode;
    }
    const bool directed = belief.view.open().directed();
    known.open = Graph::from_edges(count, edges, directed ? EdgeKind::kDirected : EdgeKind::kUndirected);
    if (old.has_prizes() || belief.view.has_prizes()) {
      for (NodeId node = 0; node < count; ++node) {
        const NodeId seen = belief.seen_as[node];
        known.prizes.push_back(seen != kNoNode ? belief.view.prize(seen) : old.prize(node));
      }
    }
    belief.map = make_known(std::move(known));
  }
  const NodeId position = belief.believed_as[now.position];
  const NodeId end = now.task->end();
  NodeSet ground(count);
  for (NodeId node = 0; node < belief.view.node_count(); ++node) {
    if (now.ground().contains(node)) ground.insert(belief.believed_as[node]);
  }
  const double budget = now.task->budget();
  const Task whole(View(belief.map), position, budget,
                   end == kNoNode ? End::anywhere() : End::at(belief.believed_as[end]));
  const Task task = whole.rest(position, std::max(0.0, budget - now.spent), std::move(ground));
  const auto rest = std::span(belief.plan).subspan(belief.step);
  const bool holds = rest.size() > 1 && can_walk(task, rest);
  if (holds && !belief.news) return;
  std::vector<NodeId> walk = holds ? std::vector<NodeId>(rest.begin(), rest.end()) : repaired(task, rest, search_);
  belief.plan = planner_->plan_from(task, plan_of_walk(task, std::move(walk)), clock).walk;
  belief.step = 0;
  belief.news = false;
}

int BelievingPolicy::act_on(const Observation& now, const Clock& clock) {
  if (!now.task->ends_anywhere() && now.task->has_budget()) {
    throw Error({.what = "an old map helps no walk that must end at a node within a budget",
                 .expected = "an end anywhere, or no budget: ways back must be known",
                 .where = now.view().name()});
  }
  Belief& belief = belief_of(now.view());
  if (belief.trusted) {
    const bool follows = belief.hash == now.walk_hash && belief.version > 0 && belief.end == now.task->end();
    if (!follows) {
      belief.plan.clear();
      belief.step = 0;
    }
    belief.end = now.task->end();
    learn(belief);
    const bool at_end = belief.step + 1 >= belief.plan.size();
    if (belief.trusted && (at_end || belief.map == nullptr)) plan_anew(belief, now, clock);
  }
  if (belief.trusted) {
    if (belief.step + 1 >= belief.plan.size()) return kStop;
    const NodeId next = belief.seen_as[belief.plan[belief.step + 1]];
    const int action = next == kNoNode ? kNoAction : now.action_to(next);
    if (action != kNoAction && now.affordable(action)) {
      ++belief.step;
      belief.hash = extended_walk_hash(now.walk_hash, next);
      return action;
    }
    belief.trusted = false;  // the way to the end must be known
  }
  int action = kStop;
  without_->act({&now, 1}, {&action, 1}, clock);
  return action;
}

}  // namespace graphdrl
