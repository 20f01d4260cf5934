#include "graphdrl/planners/baselines.h"

#include <algorithm>
#include <vector>

namespace graphdrl {
namespace {

constexpr int kVisitsPerTick = 256;
constexpr double kWalkingOn = 2;  // of the time that the nearest walk took, kept for walking on

// A depth-first walk under way. The trail leads from the start to where it stands.
class DepthFirstWalk {
 public:
  DepthFirstWalk(const Task& task, NearestFirst& search)
      : task_(task),
        open_(task.view().open()),
        search_(search),
        spendable_(task.limit()),
        visited_(task.ground()),
        next_(open_.node_count()),
        walk_{task.start()},
        trail_{task.start()} {}

  // Goes on by one first visit. False where there is none left, or none can be paid for.
  bool advance() { return open_.directed() ? advance_one_way() : advance_both_ways(); }

  int visits() const { return visits_; }

  std::vector<NodeId> take_walk() && {
    walk_.resize(last_visit_);
    return std::move(walk_);
  }

 private:
  // The place of a node's first unvisited neighbour, -1 where there is none. What is visited stays visited, so each
  // list is gone through once.
  int first_unvisited(NodeId node) {
    const auto neighbours = open_.neighbours(node);
    int& place = next_[node];
    while (place < std::ssize(neighbours) && visited_.contains(neighbours[place])) ++place;
    return place < std::ssize(neighbours) ? place : -1;
  }

  bool advance_both_ways() {
    while (!trail_.empty()) {
      if (const int next = first_unvisited(trail_.back()); next >= 0) return enter(trail_.back(), next);
      trail_.pop_back();
      if (!trail_.empty() && !step_to(trail_.back())) return false;
    }
    return false;
  }

  // One-way edges cannot be stepped back. A node that cannot be had from here may be had later: it stays on the trail.
  bool advance_one_way() {
    std::vector<NodeId> cut_off;
    for (; !trail_.empty(); trail_.pop_back()) {
      const NodeId node = trail_.back();
      if (first_unvisited(node) < 0) continue;
      if (node != walk_.back() && !find_way(open_, walk_.back(), node, visited_, search_)) {
        cut_off.push_back(node);
        continue;
      }
      trail_.insert(trail_.end(), cut_off.rbegin(), cut_off.rend());
      return walk_back_to(node);
    }
    return false;
  }

  // Along the way that find_way() found last, to the first node of it from which something is left, and there on.
  bool walk_back_to(NodeId goal) {
    std::vector<NodeId> way;
    if (goal != walk_.back()) search_.append_path_to(goal, way);
    for (const NodeId node : way) {
      if (first_unvisited(walk_.back()) >= 0) break;
      if (!step_to(node)) return false;
    }
    return enter(walk_.back(), first_unvisited(walk_.back()));
  }

  // Takes the step to the neighbour at a place, which is unvisited.
  bool enter(NodeId from, int place) {
    const NodeId node = open_.neighbours(from)[place];
    if (!step_to(node)) return false;
    visited_.insert(node);
    trail_.push_back(node);
    last_visit_ = walk_.size();
    ++visits_;
    return true;
  }

  // False where it cannot be paid for.
  bool step_to(NodeId next) {
    spendable_ -= open_.cost(walk_.back(), open_.index_of(walk_.back(), next));
    if (spendable_ < task_.cost_to_end(next)) return false;
    walk_.push_back(next);
    return true;
  }

  const Task& task_;
  const Graph& open_;
  NearestFirst& search_;
  double spendable_;
  NodeSet visited_;
  std::vector<int> next_;  // [N], the place among a node's neighbours to look from
  std::vector<NodeId> walk_;
  std::vector<NodeId> trail_;
  std::size_t last_visit_ = 1;  // length of the walk up to it
  int visits_ = 1;
};

// A plan that was cut short, walked on by the nearest rule.
Plan walked_on(const Task& task, const Plan& plan, const Clock& clock) {
  NodeSet visited = task.ground();
  for (const NodeId node : plan.walk) visited.insert(node);
  const Plan more = NearestPlanner().plan(
      task.rest(plan.walk.back(), std::max(0.0, task.budget() - plan.cost), std::move(visited)), clock);
  if (more.walk.size() == 1) return plan;
  std::vector<NodeId> walk = plan.walk;
  walk.insert(walk.end(), more.walk.begin() + 1, more.walk.end());
  return plan_of_walk(task, std::move(walk));
}

}  // namespace

void RandomPolicy::act(std::span<const Observation> observations, std::span<int> actions, const Clock& /*clock*/) {
  for (std::size_t i = 0; i < observations.size(); ++i) {
    const Observation& now = observations[i];
    std::vector<int> allowed;
    for (int action = 0; action < now.action_count(); ++action) {
      if (blocked_too_ ? now.affordable(action) : now.legal(action)) allowed.push_back(action);
    }
    actions[i] = allowed.empty() ? kStop : allowed[rng_.below(static_cast<std::uint32_t>(allowed.size()))];
  }
}

Plan DepthFirstPlanner::plan(const Task& task, const Clock& clock) {
  Ticker ticker(clock, kVisitsPerTick);
  DepthFirstWalk walk(task, search_);
  while (walk.advance()) {
    if (ticker.tick(walk.visits())) break;
  }
  std::vector<NodeId> steps = std::move(walk).take_walk();
  append_way_to_end(task, steps, search_);
  return plan_of_walk(task, std::move(steps));
}

Plan NearestPlanner::plan(const Task& task, const Clock& clock) {
  using Next = NearestFirst::Next;
  Ticker ticker(clock, kVisitsPerTick);
  NodeSet visited = task.ground();
  int visits = visited.count();
  double spendable = task.limit();
  std::vector<NodeId> walk = {task.start()};
  int met = 0;
  do {
    NodeId goal = kNoNode;
    met = 0;
    search_.run(task.view().open(), walk.back(), spendable, [&](NodeId node, double cost) {
      ++met;
      if (visited.contains(node) || task.prize(node) <= 0) return Next::kThrough;
      if (cost + task.cost_to_end(node) > spendable) return Next::kPast;
      goal = node;
      spendable -= cost;
      return Next::kEnd;
    });
    if (goal == kNoNode) break;
    search_.append_path_to(goal, walk);
    visited.insert(goal);
    ++visits;
  } while (!ticker.tick(visits, 1 + met / Ticker::kNodesPerUnit));
  append_way_to_end(task, walk, search_);
  return plan_of_walk(task, std::move(walk));
}

Plan plan_by_deadline(const Task& task, const Clock& clock, const std::function<Plan(const Clock& until)>& search) {
  if (!clock.has_deadline()) return search(clock);
  const Stopwatch watch;
  Plan nearest = NearestPlanner().plan(task, clock);
  if (clock.passed()) return nearest;
  // Walking on takes about as long again, and mostly less.
  const Plan found = search(clock.sooner(kWalkingOn * watch.seconds()));
  Plan best = walked_on(task, found, clock);
  return better(nearest, best) ? nearest : best;
}

}  // namespace graphdrl
