#include "graphdrl/nn/explorer_features.h"

#include <algorithm>
#include <cmath>

namespace graphdrl {
namespace {

float scaled(const FeatureScale& scale, double value) {
  static const auto logarithms = [] {
    std::array<float, static_cast<int>(scale::kCount.most) + 1> values{};
    for (std::size_t i = 0; i < values.size(); ++i) {
      values[i] = static_cast<float>(std::log1p(i) / scale::kCount.divisor);
    }
    return values;
  }();
  const double cut = std::clamp(value, scale.least, scale.most);
  return scale.is_count ? logarithms[static_cast<int>(cut)] : static_cast<float>((cut - scale.less) / scale.divisor);
}

// A new row at the end of `rows`. The name of no feature does not compile.
template <const auto& features>
class Row {
 public:
  explicit Row(std::vector<float>& rows) : rows_(rows), first_(rows.size()) { rows.resize(first_ + features.size()); }

  struct Column {
    consteval Column(const char* name) : index(feature_column(features, name)) {}
    std::size_t index;
  };
  void set(Column column, double value) { rows_[first_ + column.index] = scaled(features[column.index].scale, value); }

 private:
  std::vector<float>& rows_;
  std::size_t first_;
};

// The scope with the edges among its nodes, neighbours by ascending id: sums over them do not depend on directions.
Graph scope_graph(const View& view, const Horizon& horizon, const Scope& scope) {
  std::vector<std::int64_t> offsets = {0};
  std::vector<NodeId> lists;
  std::vector<NodeId> ids;
  for (const int i : scope.nodes) {
    const auto all = view.both_ways().neighbours(horizon.node(i));
    ids.assign(all.begin(), all.end());
    if (!std::is_sorted(ids.begin(), ids.end())) std::sort(ids.begin(), ids.end());
    for (const NodeId id : ids) {
      if (const int index = horizon.index_of(id); scope.holds(index)) lists.push_back(scope.row[index]);
    }
    offsets.push_back(std::ssize(lists));
  }
  return Graph::from_lists(std::move(offsets), std::move(lists));
}

double mean_edge_cost(const Graph& graph, NodeId node) {
  double cost = 0;
  for (int k = 0; k < graph.degree(node); ++k) cost += graph.cost(node, k);
  return cost / graph.mean_cost() / std::max(graph.degree(node), 1);
}

void append_nodes(const Exploration& state, const ExplorerScratch& seen, ExplorerBatch& batch) {
  const Horizon& horizon = seen.horizon;
  const Scope& scope = seen.scope;
  const View& view = state.view();
  const double budget = scope.share_of_work * state.free_to_spend() / view.open().mean_cost();
  const double work = scope.share_of_work * seen.nearby.work;
  const Graph& graph = batch.scopes.emplace_back(scope_graph(view, horizon, scope));
  batch.graphs.add(graph);
  for (std::size_t at = 0; at < scope.nodes.size(); ++at) {
    const int i = scope.nodes[at];
    const NodeId node = horizon.node(i);
    const bool unvisited = horizon.is_unvisited(i);
    const int unvisited_neighbours = horizon.unvisited_neighbours(i);
    const int degree = horizon.degree(i);
    const int both_ways = view.open().degree(node) + view.into().degree(node) - degree;
    const auto share = [&](int part) { return static_cast<float>(part) / static_cast<float>(std::max(degree, 1)); };
    Row<kExplorerNodeFeatures> row(batch.node_x);
    row.set("unvisited", unvisited);
    row.set("current", i == 0);
    row.set("candidate", seen.visits.lead_to(i));
    row.set("degree", degree);
    row.set("unvisited_neighbours", unvisited_neighbours);
    row.set("isolated", unvisited && unvisited_neighbours == 0);
    row.set("dead_end", unvisited && unvisited_neighbours == 1);
    row.set("distance", std::min(seen.nearby.distance[i], seen.visits.cost[i]));
    row.set("visit_cost", seen.visits.lead_to(i) ? seen.visits.cost[i] : 0);
    row.set("out_of_scope", share(degree - graph.degree(static_cast<NodeId>(at))));
    row.set("distance_to_work", seen.steps_to_work[i] < 0 ? kNoLimit : seen.steps_to_work[i]);
    row.set("part_size", seen.part_size[i]);
    row.set("part_share", std::min(seen.part_size[i] / std::max(seen.nearby.work, 1.0), 1.0));
    row.set("edge_cost", mean_edge_cost(view.open(), node));
    row.set("budget_per_work", budget / std::max(work, 1.0));
    row.set("slack", budget - work);
    row.set("hanging", seen.trees.hanging[i]);
    row.set("hanging_size", seen.trees.size[i]);
    row.set("hanging_height", seen.trees.height[i]);
    row.set("one_way", degree == 0 ? 0 : 1 - share(both_ways));
  }
}

// What it costs to get from a first visit to the next unvisited node, as far as features tell costs apart.
double next_cost(const Exploration& state, const FirstVisit& visit, NearestFirst& search) {
  const Graph& open = state.view().open();
  double next = kNoLimit;
  const double most = std::min(state.spendable() - visit.cost, scale::kCost.most * open.mean_cost());
  search.run(open, visit.node, most, [&](NodeId node, double cost) {
    if (state.ground().contains(node)) return NearestFirst::Next::kThrough;
    next = cost / open.mean_cost();
    return NearestFirst::Next::kEnd;
  });
  return next;
}

void append_visits(const Exploration& state, ExplorerScratch& seen, ExplorerBatch& batch) {
  const Horizon& horizon = seen.horizon;
  const Scope& scope = seen.scope;
  const double budget = state.free_to_spend() / state.view().open().mean_cost();
  const int graph = batch.graphs.graph_count() - 1;
  const int first_row = batch.graphs.first_node(graph);
  for (const FirstVisit& visit : seen.visits.all) {
    const int i = horizon.index_of(visit.node);
    const double budget_after = scope.share_of_work * (budget - seen.visits.cost[i]);
    const double work_after = scope.share_of_work * (seen.nearby.work - 1);
    Row<kExplorerVisitFeatures> row(batch.visit_x);
    row.set("cost", seen.visits.cost[i]);
    row.set("change_of_penalties", change_of_penalties(state.view(), state.ground(), visit.node));
    row.set("unvisited_neighbours", horizon.unvisited_neighbours(i));
    row.set("next_cost", next_cost(state, visit, seen.search));
    row.set("budget_per_work", budget_after / std::max(work_after, 1.0));
    row.set("slack", budget_after - work_after);
    row.set("work", seen.nearby.work);
    row.set("hanging", seen.trees.hanging[i]);
    row.set("hanging_size", seen.trees.size[i]);
    row.set("hanging_height", seen.trees.height[i]);
    row.set("work_in_scope", scope.share_of_work);
    batch.target.push_back(first_row + scope.row[i]);
    batch.state.push_back(graph);
  }
  batch.current.push_back(first_row + scope.row[0]);
  batch.ceiling.push_back(std::min(seen.nearby.work, budget));
  batch.unseen.push_back(1 - scope.share_of_work);
}

}  // namespace

void ExplorerBatch::clear() {
  graphs.clear();
  for (auto* values : {&node_x, &visit_x}) values->clear();
  for (auto* values : {&current, &target, &state}) values->clear();
  for (auto* values : {&ceiling, &unseen}) values->clear();
  scopes.clear();
}

SeenVisits encode(const Exploration& state, ExplorerScratch& scratch, ExplorerBatch& batch, int scope) {
  const View& view = state.view();
  const Horizon& horizon = scratch.horizon;
  scratch.horizon.gather(state);
  measure_nearby(state, horizon, scope, scratch.search, scratch.nearby);
  find_first_visits(state, horizon, scratch.nearby, scratch.search, scratch.visits);
  choose_scope(view, horizon, scratch.nearby, scratch.visits, scope, scratch.scope);
  std::vector<FirstVisit>& visits = scratch.visits.all;
  const auto out_of_scope = std::erase_if(
      visits, [&](const FirstVisit& visit) { return !scratch.scope.holds(horizon.index_of(visit.node)); });
  measure_steps_to_work(horizon, scratch.queue, scratch.steps_to_work);
  const int unvisited_beyond = state.new_count() - horizon.unvisited_count();
  measure_parts(horizon, scratch.scope, unvisited_beyond, scratch.queue, scratch.part_size);
  measure_hanging_trees(horizon, scratch.queue, scratch.trees);
  append_nodes(state, scratch, batch);
  append_visits(state, scratch, batch);
  return {.visits = visits, .left_out = scratch.visits.left_out || out_of_scope > 0};
}

}  // namespace graphdrl
