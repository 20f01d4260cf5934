#include "graphdrl/nn/explorer_measures.h"

#include <algorithm>

namespace graphdrl {

void measure_nearby(const Exploration& state, const Horizon& horizon, int scope, NearestFirst& search, Nearby& nearby) {
  const Graph& open = state.view().open();
  const double unit = open.mean_cost();
  const std::size_t most = 2 * static_cast<std::size_t>(scope);
  // Whether all of the horizon is in reach: then the search may end as soon as `nearest` is full.
  const bool all_in_reach = !open.directed() && horizon.most_steps() * open.max_cost() <= state.spendable();
  nearby.distance.assign(horizon.size(), kNoLimit);
  nearby.is_near.assign(horizon.size(), 0);
  nearby.distance[0] = 0;
  nearby.is_near[0] = 1;
  nearby.nearest.assign(1, 0);
  int reached = 1;
  double work = horizon.is_unvisited(0);
  bool reached_all = true;
  search.run(open, state.position(), state.spendable(), [&](NodeId node, double cost) {
    const int index = horizon.index_of(node);
    if (index < 0 || reached == kExplorerHorizon || (all_in_reach && nearby.nearest.size() == most)) {
      reached_all = false;
      return NearestFirst::Next::kEnd;
    }
    ++reached;
    work += horizon.is_unvisited(index);
    nearby.distance[index] = cost / unit;
    if (nearby.nearest.size() < most) {
      nearby.nearest.push_back(index);
      nearby.is_near[index] = 1;
    }
    return NearestFirst::Next::kThrough;
  });
  nearby.nearest_are_all = reached_all && reached == std::ssize(nearby.nearest);
  if (!reached_all) {
    work = all_in_reach && horizon.is_all() ? horizon.unvisited_count() : state.new_count();
  }
  nearby.work = work;
}

void find_first_visits(const Exploration& state, const Horizon& horizon, const Nearby& nearby, NearestFirst& search,
                       FirstVisits& visits) {
  const Graph& into = state.view().into();
  const double unit = state.view().open().mean_cost();
  int possible = 0;  // first visits that may be in scope
  for (const int index : nearby.nearest) {
    const auto from = into.neighbours(horizon.node(index));
    possible += horizon.is_unvisited(index) &&
                std::any_of(from.begin(), from.end(), [&](NodeId node) { return state.ground().contains(node); });
  }
  visits.all.clear();
  visits.cost.assign(horizon.size(), kNoLimit);
  visits.left_out = false;
  int found = 0;  // of the possible ones
  int searched = 0;
  const auto visit = [&](NodeId node, double cost) {
    visits.all.push_back({node, cost});
    if (const int index = horizon.index_of(node); index >= 0) {
      visits.cost[index] = cost / unit;
      found += nearby.is_near[index];
    }
    return true;
  };
  const auto meet = [&](double /*cost*/) {
    const bool enough = (found == possible && std::ssize(visits.all) >= kLeastVisits) ||
                        (searched >= kExplorerHorizon && !visits.all.empty());
    if (enough) visits.left_out = found < possible || !nearby.nearest_are_all;
    ++searched;
    return !enough;
  };
  state.for_first_visits(search, visit, meet);
}

void choose_scope(const View& view, const Horizon& horizon, const Nearby& nearby, const FirstVisits& visits, int size,
                  Scope& scope) {
  const std::size_t wanted = std::min<std::size_t>(visits.all.size(), kLeastVisits);
  std::size_t in_scope = 0;  // first visits
  scope.nodes.clear();
  scope.row.assign(horizon.size(), -1);
  const auto add = [&](int index) {
    scope.row[index] = static_cast<int>(scope.nodes.size());
    scope.nodes.push_back(index);
  };
  for (const int index : nearby.nearest) {
    if (std::ssize(scope.nodes) >= size && in_scope >= wanted) break;
    in_scope += visits.lead_to(index);
    add(index);
  }
  for (std::size_t i = 0; i < visits.all.size() && in_scope < wanted; ++i) {
    const int index = horizon.index_of(visits.all[i].node);
    if (index < 0 || scope.holds(index)) continue;
    add(index);
    ++in_scope;
  }
  // Where all of the world is in scope, rows are in its own order.
  if (std::ssize(scope.nodes) == view.valid_count()) {
    std::sort(scope.nodes.begin(), scope.nodes.end(), [&](int a, int b) { return horizon.node(a) < horizon.node(b); });
    for (std::size_t i = 0; i < scope.nodes.size(); ++i) scope.row[scope.nodes[i]] = static_cast<int>(i);
  }
  const auto work =
      std::count_if(scope.nodes.begin(), scope.nodes.end(), [&](int index) { return horizon.is_unvisited(index); });
  scope.share_of_work = nearby.work > 0 ? std::min(static_cast<double>(work) / nearby.work, 1.0) : 1;
}

void measure_steps_to_work(const Horizon& horizon, std::vector<int>& queue, std::vector<int>& steps) {
  steps.resize(horizon.size());
  queue.clear();
  for (int i = 0; i < horizon.size(); ++i) {
    const bool border = !horizon.is_unvisited(i) && horizon.unvisited_neighbours(i) > 0;
    steps[i] = horizon.is_unvisited(i) ? 0 : border ? 1 : -1;
    if (border) queue.push_back(i);
  }
  for (std::size_t head = 0; head < queue.size(); ++head) {
    for (const int next : horizon.neighbours(queue[head])) {
      if (steps[next] >= 0) continue;
      steps[next] = steps[queue[head]] + 1;
      queue.push_back(next);
    }
  }
}

void measure_parts(const Horizon& horizon, const Scope& scope, int unvisited_beyond, std::vector<int>& queue,
                   std::vector<int>& size) {
  size.assign(horizon.size(), 0);
  for (const int root : scope.nodes) {
    if (!horizon.is_unvisited(root) || size[root] > 0) continue;
    queue.assign(1, root);
    size[root] = 1;
    bool goes_on = false;  // beyond the horizon
    for (std::size_t head = 0; head < queue.size(); ++head) {
      int unvisited = 0;
      for (const int next : horizon.neighbours(queue[head])) {
        if (!horizon.is_unvisited(next)) continue;
        ++unvisited;
        if (size[next] > 0) continue;
        size[next] = 1;
        queue.push_back(next);
      }
      goes_on = goes_on || unvisited < horizon.unvisited_neighbours(queue[head]);
    }
    const int members = static_cast<int>(queue.size()) + (goes_on ? unvisited_beyond : 0);
    for (const int member : queue) size[member] = members;
  }
}

// Takes leaves off again and again.
void measure_hanging_trees(const Horizon& horizon, std::vector<int>& queue, HangingTrees& trees) {
  trees.hanging.assign(horizon.size(), 0);
  for (auto* values : {&trees.size, &trees.height}) values->assign(horizon.size(), 0);
  trees.ties.resize(horizon.size());
  queue.clear();
  for (int i = 0; i < horizon.size(); ++i) {
    if (!horizon.is_unvisited(i)) continue;
    // The ties to nodes beyond the horizon are never taken off.
    const bool anchored = horizon.unvisited_neighbours(i) < horizon.degree(i);
    trees.ties[i] = horizon.unvisited_neighbours(i) + (anchored ? 1 : 0);
    if (trees.ties[i] <= 1) queue.push_back(i);
  }
  for (std::size_t head = 0; head < queue.size(); ++head) {
    const int leaf = queue[head];
    trees.hanging[leaf] = 1;
    ++trees.size[leaf];
    ++trees.height[leaf];
    for (const int next : horizon.neighbours(leaf)) {
      if (!horizon.is_unvisited(next) || trees.hanging[next] != 0) continue;
      trees.size[next] += trees.size[leaf];
      trees.height[next] = std::max(trees.height[next], trees.height[leaf]);
      if (--trees.ties[next] == 1) queue.push_back(next);
    }
  }
}

}  // namespace graphdrl
