#include "graphdrl/train/teacher.h"

#include <algorithm>
#include <cmath>

#include "graphdrl/nn/explorer_network.h"
#include "graphdrl/planners/baselines.h"

namespace graphdrl {
namespace {

// Chosen by how often the best first visit, by long searches, is the one labelled best (docs/explorer.md, "Training").
constexpr double kLookShare = 7.5;  // steps of a look, in those of a label
constexpr double kBeginShare = 20;  // of the first one
constexpr double kBeginFrom = 0.3;  // of the annealing's schedule: how hot a search begins
constexpr double kLookFrom = 0.5;
constexpr double kLabelFrom = 0.9;  // cold: so that labels differ by what first visits do, and not by chance
constexpr int kFewSteps = 60;
constexpr int kManySteps = 1500;

}  // namespace

Tour Teacher::improve(const Targets& targets, double limit, double share, double from) {
  std::vector<int> order;
  double cost = 0;
  int last = 0;
  for (const NodeId node : best_) {
    const int target = targets.target_of(node);
    if (target <= 0) continue;
    const double there = cost + targets.cost(last, target);
    if (there + targets.cost(target, targets.end()) > limit) continue;
    order.push_back(target);
    cost = there;
    last = target;
  }
  const std::size_t links = order.size() + 1;
  Annealing annealing(targets, limit, rng_.next(),
                      {.order = std::move(order), .links = std::vector<double>(links, kNoLimit)});
  const auto steps = static_cast<std::int64_t>(share * std::clamp(steps_ * targets.end(), kFewSteps, kManySteps));
  for (std::int64_t step = 0; step < steps; ++step) {
    annealing.step(from + (1 - from) * static_cast<double>(step) / static_cast<double>(steps));
  }
  return annealing.best();
}

void Teacher::search(const Task& task, double share, double from) {
  targets_.clear();
  const Targets& targets = targets_.emplace_back(task);
  const Tour found = improve(targets, task.limit(), share, from);
  best_.clear();
  for (const int target : found.order) best_.push_back(targets.node(target));
}

void Teacher::begin(const Task& task) {
  NearestPlanner nearest;
  const std::vector<NodeId> walk = nearest.plan(task).walk;
  NodeSet visited = task.ground();
  best_.clear();
  for (const NodeId node : walk) {
    if (visited.contains(node)) continue;
    visited.insert(node);
    best_.push_back(node);
  }
  search(task, kBeginShare, kBeginFrom);
}

void Teacher::look(const Task& task) {
  search(task, kLookShare, kLookFrom);
}

NodeId Teacher::next_visit(const Task& task) {
  while (!best_.empty()) {
    const NodeId goal = best_.front();
    bool found = false;
    search_.run(task.view().open(), task.start(), kNoLimit, [&](NodeId node, double /*cost*/) {
      found = node == goal;
      return found ? NearestFirst::Next::kEnd : NearestFirst::Next::kThrough;
    });
    if (found) {
      std::vector<NodeId> way;
      search_.append_path_to(goal, way);
      const NodeSet ground = task.ground();
      return *std::find_if(way.begin(), way.end(), [&](NodeId node) { return !ground.contains(node); });
    }
    best_.erase(best_.begin());  // one way edges left it behind
  }
  return kNoNode;
}

double Teacher::value(const Task& task, const FirstVisit& first) {
  const Targets& before = targets_.front();
  const Targets targets = before.after(before.target_of(first.node));
  const Tour found = improve(targets, task.limit() - first.cost, 1, kLabelFrom);
  const double visits = 1 + found.prize;
  const double edges = (first.cost + found.cost) / task.view().open().mean_cost();
  return visits - kWorthOfCost * (edges - visits);
}

}  // namespace graphdrl
