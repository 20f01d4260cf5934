#include "graphdrl/planners/exact.h"

#include <fmt/format.h>

#include <algorithm>

#include "graphdrl/graph/search.h"
#include "graphdrl/planners/exact_search.h"
#include "graphdrl/planners/bound.h"

namespace graphdrl {

SmallWorld::SmallWorld(const Task& task) {
  const Graph& open = task.view().open();
  nodes = {task.start()};
  NearestFirst().run_cheapest(open, task.start(), task.limit(), [&](NodeId node, double) {
    nodes.push_back(node);
    return nodes.size() > kExactMaxNodes ? NearestFirst::Next::kEnd : NearestFirst::Next::kThrough;
  });
  if (nodes.size() > kExactMaxNodes) return;
  std::sort(nodes.begin(), nodes.end());
  const auto local = [&](NodeId node) {
    const auto place = std::lower_bound(nodes.begin(), nodes.end(), node);
    return place == nodes.end() || *place != node ? -1 : static_cast<int>(place - nodes.begin());
  };
  neighbours.resize(nodes.size());
  costs.assign(nodes.size(), std::vector<double>(nodes.size()));
  const NodeSet visited = task.ground();
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    for (int k = 0; k < open.degree(nodes[i]); ++k) {
      const int next = local(open.neighbours(nodes[i])[k]);
      if (next < 0) continue;  // beyond the budget
      neighbours[i] |= bit(next);
      costs[i][next] = open.cost(nodes[i], k);
    }
    prizes.push_back(task.prize(nodes[i]));
    cost_to_end.push_back(task.cost_to_end(nodes[i]));
    if (visited.contains(nodes[i])) state.visited |= bit(static_cast<int>(i));
  }
  state.position = local(task.start());
  end = task.ends_anywhere() ? -1 : local(task.end());
}

namespace {

bool is_plain(const Task& task) {
  return task.ends_anywhere() && !task.has_prizes() && !task.view().open().weighted();
}

constexpr double kSearchShare = 0.5;     // of the time left, for the search
constexpr double kIncumbentShare = 0.1;  // likewise, for a walk to begin branch and cut with

// The walk that goes straight to where it must end.
Plan straight_plan(const Task& task) {
  NearestFirst search;
  std::vector<NodeId> walk = {task.start()};
  append_way_to_end(task, walk, search);
  return plan_of_walk(task, std::move(walk));
}

}  // namespace

std::optional<double> exact_prize(const Task& task) {
  if (is_plain(task)) {
    const auto gain = plain_exact_gain(task);
    return gain ? std::optional(*gain + task.prize(task.start())) : std::nullopt;
  }
  auto walk = general_exact_walk(task, {});
  return walk ? std::optional(plan_of_walk(task, *std::move(walk)).prize) : std::nullopt;
}

std::optional<std::vector<NodeId>> exact_walk(const Task& task, const Clock& clock) {
  return is_plain(task) ? plain_exact_walk(task, clock) : general_exact_walk(task, clock);
}

Plan ExactPlanner::plan(const Task& task, const Clock& clock) {
  if (auto walk = exact_walk(task, clock.share(kSearchShare))) {
    return plan_of_walk(task, *std::move(walk), /*optimal=*/true);
  }
  const bool ends_early = clock.has_deadline() || clock.stopped();
  const auto lp = make_lp_bound(task, kNoLimit);
  if (lp != nullptr || ends_early) {
    const Clock until = lp == nullptr ? clock : clock.share(kIncumbentShare);
    Plan best = incumbent_ == nullptr ? straight_plan(task) : incumbent_->plan(task, until);
    if (best.optimal) return best;
    if (lp != nullptr) {
      const LpBound::Effort effort{.clock = clock, .work = clock.has_deadline() ? kNoLimit : kExactMaxWork};
      lp->cut(best.prize, effort);
      lp->branch(best.prize, effort);
      improve(*lp, task, best);
    }
    if (best.optimal || ends_early || clock.stopped()) return best;
  }
  const std::size_t reached = SmallWorld(task).nodes.size();
  const bool many = reached > kExactMaxNodes;
  throw SearchOutOfReach(
      {.what = "exact search is out of reach",
       .expected = fmt::format("at most {} nodes in reach and {} states{}", kExactMaxNodes, kExactMaxStates,
                               has_lp_bound() ? ", or a proof by branch and cut" : ""),
       .got =
           many ? fmt::format("more than {} nodes", kExactMaxNodes) : fmt::format("{} nodes, too many states", reached),
       .where = task.view().name()});
}

}  // namespace graphdrl
