#include "graphdrl/nn/explorer_features.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace graphdrl {
namespace {

constexpr double kFar = 32;        // mean edges; what is farther looks as far
constexpr int kMany = 64;          // nodes; more look as many
constexpr double kDear = 4;        // mean edges; a node of dearer edges looks as dear
constexpr double kAmple = 3;       // mean edges an unvisited node; a larger budget looks as large
constexpr double kMostSlack = 16;  // mean edges

float near_scale(double cost) {
  return static_cast<float>(std::min(cost, kFar) / 8);
}

float log_scale(int count) {
  static const auto table = [] {
    std::array<float, kMany + 1> values{};
    for (int i = 0; i <= kMany; ++i) values[i] = static_cast<float>(std::log1p(i) / 4);
    return values;
  }();
  return table[std::min(count, kMany)];
}

// The share of a budget that work takes, seen from both sides of "just enough".
struct BudgetView {
  BudgetView(double budget, double work)
      : per_work(static_cast<float>(std::min(budget / std::max(work, 1.0), kAmple))),
        slack(static_cast<float>(std::clamp(budget - work, -kMostSlack, kMostSlack) / 8)) {}
  float per_work;
  float slack;
};

// The features by name, in the order of kExplorerNodeFeatures and kExplorerVisitFeatures.
struct NodeFeatures {
  float unvisited, current, candidate, degree, unvisited_neighbours, isolated, dead_end, distance, visit_cost,
      out_of_scope, distance_to_work, part_size, part_share, edge_cost, budget_per_work, slack, hanging, hanging_size,
      hanging_height, one_way;
};

struct VisitFeatures {
  float cost, change_of_penalties, unvisited_neighbours, next_cost, budget_per_work, slack, work, hanging, hanging_size,
      hanging_height, work_in_scope;
};

template <typename Features>
void append_row(const Features& features, std::vector<float>& rows) {
  const auto row = std::bit_cast<std::array<float, sizeof(Features) / sizeof(float)>>(features);
  rows.insert(rows.end(), row.begin(), row.end());
}
static_assert(sizeof(NodeFeatures) == kExplorerNodeFeatureCount * sizeof(float));
static_assert(sizeof(VisitFeatures) == kExplorerVisitFeatureCount * sizeof(float));

constexpr float flag(bool value) {
  return value ? 1.0f : 0.0f;
}

}  // namespace

void ExplorerBatch::clear() {
  graphs.clear();
  for (auto* values : {&node_x, &visit_x}) values->clear();
  for (auto* values : {&current, &target, &state}) values->clear();
  for (auto* values : {&ceiling, &unseen, &budget_per_work}) values->clear();
  scopes.clear();
}

// Breadth first, whichever way edges lead.
void ExplorerEncoder::gather_horizon(const Exploration& state) {
  const View& view = state.view();
  const Graph& graph = view.both_ways();
  if (place_.size() < static_cast<std::size_t>(graph.node_count())) place_.resize(graph.node_count());
  if (++call_ == 0) {
    std::fill(place_.begin(), place_.end(), Place());
    call_ = 1;
  }
  nodes_.assign(1, state.position());
  place_[state.position()] = {call_, 0};
  steps_to_horizon_ = 0;
  std::size_t next_ring = 1;  // where nodes one step farther begin
  for (std::size_t head = 0; head < nodes_.size() && nodes_.size() < kExplorerHorizon; ++head) {
    if (head == next_ring) {
      next_ring = nodes_.size();
      ++steps_to_horizon_;
    }
    for (const NodeId next : graph.neighbours(nodes_[head])) {
      if (local(next) >= 0) continue;
      if (nodes_.size() == kExplorerHorizon) break;
      place_[next] = {call_, static_cast<int>(nodes_.size())};
      nodes_.push_back(next);
    }
  }
  ++steps_to_horizon_;

  const std::size_t count = nodes_.size();
  unvisited_.resize(count);
  degree_.resize(count);
  unvisited_neighbours_.resize(count);
  for (std::size_t i = 0; i < count; ++i) unvisited_[i] = state.is_new(nodes_[i]);
  offsets_.assign(1, 0);
  neighbours_.clear();
  whole_component_ = true;
  for (std::size_t i = 0; i < count; ++i) {
    int unvisited = 0;
    for (const NodeId next : graph.neighbours(nodes_[i])) {
      const int index = local(next);
      if (index >= 0) {
        neighbours_.push_back(index);
        unvisited += unvisited_[index];
      } else {
        whole_component_ = false;
        unvisited += state.is_new(next);
      }
    }
    degree_[i] = graph.degree(nodes_[i]);
    unvisited_neighbours_[i] = unvisited;
    offsets_.push_back(std::ssize(neighbours_));
  }
}

// Distances of what a scope may hold, and the work in reach. Work beyond the horizon is taken to be in reach.
void ExplorerEncoder::measure_distances(const Exploration& state, int scope) {
  const View& view = state.view();
  const Graph& open = view.open();
  const std::size_t most = 2 * static_cast<std::size_t>(scope);
  const double farthest = steps_to_horizon_ * open.max_cost();
  const bool all_in_reach = whole_component_ && !open.directed() && farthest <= state.spendable();
  const bool beyond_in_reach = !whole_component_ && !open.directed() && farthest <= state.spendable();
  distance_.assign(nodes_.size(), kNoLimit);
  distance_[0] = 0;
  in_reach_.assign(1, 0);
  int reached = 1;
  double work = unvisited_[0];
  bool reached_all = true;
  search_.run(open, state.position(), state.spendable(), [&](NodeId node, double cost) {
    const int index = local(node);
    if (index < 0 || reached == kExplorerHorizon || ((all_in_reach || beyond_in_reach) && in_reach_.size() == most)) {
      reached_all = false;
      return NearestFirst::Next::kEnd;
    }
    ++reached;
    work += unvisited_[index];
    distance_[index] = cost / unit_;
    if (in_reach_.size() < most) in_reach_.push_back(index);
    return NearestFirst::Next::kThrough;
  });
  in_reach_is_all_ = reached_all && reached == std::ssize(in_reach_);
  if (!reached_all && all_in_reach) {
    work = static_cast<double>(std::count(unvisited_.begin(), unvisited_.end(), 1));
  } else if (!reached_all) {
    work = view.valid_count() - state.ground_count();
  }
  work_ = work;
}

// All that a scope may hold, and at least kLeastVisits. Stops after kExplorerHorizon searched nodes once it has one.
void ExplorerEncoder::find_first_visits(const Exploration& state) {
  const View& view = state.view();
  int possible = 0;  // first visits that may be in scope
  number_.assign(nodes_.size(), -1);
  for (const int index : in_reach_) {
    number_[index] = 0;
    const auto from = view.into().neighbours(nodes_[index]);
    possible += unvisited_[index] != 0 &&
                std::any_of(from.begin(), from.end(), [&](NodeId node) { return state.ground().contains(node); });
  }
  visit_cost_.assign(nodes_.size(), 0.0);
  visits_.clear();
  overlooked_ = false;
  int in_scope = 0;
  int searched = 0;
  const auto visit = [&](NodeId node, double cost) {
    visits_.push_back({node, cost});
    if (const int index = local(node); index >= 0) {
      visit_cost_[index] = cost / unit_;
      in_scope += number_[index] == 0;
      distance_[index] = std::min(distance_[index], cost / unit_);
    }
    return true;
  };
  const auto meet = [&](double /*cost*/) {
    const bool enough = (in_scope == possible && std::ssize(visits_) >= kLeastVisits) ||
                        (searched >= kExplorerHorizon && !visits_.empty());
    if (enough) overlooked_ = in_scope < possible || !in_reach_is_all_;
    ++searched;
    return !enough;
  };
  state.for_first_visits(search_, visit, meet);
}

void ExplorerEncoder::choose_scope(const View& view, int scope) {
  const std::size_t wanted = std::min<std::size_t>(visits_.size(), kLeastVisits);
  std::size_t size = 0;
  std::size_t visits = 0;
  while (size < in_reach_.size() && (size < static_cast<std::size_t>(scope) || visits < wanted)) {
    visits += visit_cost_[in_reach_[size]] > 0;
    ++size;
  }
  seen_.assign(in_reach_.begin(), in_reach_.begin() + static_cast<std::ptrdiff_t>(size));
  number_.assign(nodes_.size(), -1);
  for (std::size_t i = 0; i < size; ++i) number_[seen_[i]] = static_cast<int>(i);
  for (std::size_t i = 0; i < visits_.size() && visits < wanted; ++i) {
    const int index = local(visits_[i].node);
    if (index < 0 || number_[index] >= 0) continue;
    number_[index] = static_cast<int>(seen_.size());
    seen_.push_back(index);
    ++visits;
  }
  if (std::ssize(seen_) == view.valid_count()) {
    std::sort(seen_.begin(), seen_.end(), [&](int a, int b) { return nodes_[a] < nodes_[b]; });
    for (std::size_t i = 0; i < seen_.size(); ++i) number_[seen_[i]] = static_cast<int>(i);
  }
  double work_in_scope = 0;
  for (const int index : seen_) work_in_scope += unvisited_[index];
  share_ = work_ > 0 ? std::min(work_in_scope / work_, 1.0) : 1;
  overlooked_ = std::erase_if(visits_,
                              [&](const FirstVisit& visit) {
                                const int index = local(visit.node);
                                return index < 0 || number_[index] < 0;
                              }) > 0 ||
                overlooked_;
}

void ExplorerEncoder::measure_work_distances() {
  const int count = static_cast<int>(nodes_.size());
  work_distance_.resize(nodes_.size());
  queue_.clear();
  for (int i = 0; i < count; ++i) {
    const bool border = unvisited_[i] == 0 && unvisited_neighbours_[i] > 0;
    work_distance_[i] = unvisited_[i] != 0 ? 0 : border ? 1 : -1;
    if (border) queue_.push_back(i);
  }
  for (std::size_t head = 0; head < queue_.size(); ++head) {
    for (const int next : neighbours(queue_[head])) {
      if (work_distance_[next] >= 0) continue;
      work_distance_[next] = work_distance_[queue_[head]] + 1;
      queue_.push_back(next);
    }
  }
}

// Unvisited nodes connected through unvisited ones, of those in scope.
void ExplorerEncoder::measure_parts(int unvisited_in_world) {
  const int beyond = unvisited_in_world - static_cast<int>(std::count(unvisited_.begin(), unvisited_.end(), 1));
  part_size_.assign(nodes_.size(), 0);
  for (const int root : seen_) {
    if (unvisited_[root] == 0 || part_size_[root] > 0) continue;
    queue_.assign(1, root);
    part_size_[root] = 1;
    bool goes_on = false;  // beyond the horizon
    for (std::size_t head = 0; head < queue_.size(); ++head) {
      int unvisited = 0;
      for (const int next : neighbours(queue_[head])) {
        if (unvisited_[next] == 0) continue;
        ++unvisited;
        if (part_size_[next] > 0) continue;
        part_size_[next] = 1;
        queue_.push_back(next);
      }
      goes_on = goes_on || unvisited < unvisited_neighbours_[queue_[head]];
    }
    const int size = static_cast<int>(queue_.size()) + (goes_on ? beyond : 0);
    for (const int member : queue_) part_size_[member] = size;
  }
}

// Unvisited nodes that can be left only by the way one came. Leaves are taken off again and again; visited ground next
// to a node holds it as one more edge would.
void ExplorerEncoder::measure_hanging_trees() {
  const int count = static_cast<int>(nodes_.size());
  for (auto* values : {&hanging_size_, &hanging_height_}) values->assign(nodes_.size(), 0);
  hanging_.assign(nodes_.size(), 0);
  ties_.resize(nodes_.size());
  queue_.clear();
  for (int i = 0; i < count; ++i) {
    if (unvisited_[i] == 0) continue;
    // Nodes beyond the horizon hold too: their ties are never taken off.
    const bool anchored = unvisited_neighbours_[i] < degree_[i];
    ties_[i] = unvisited_neighbours_[i] + (anchored ? 1 : 0);
    if (ties_[i] <= 1) queue_.push_back(i);
  }
  for (std::size_t head = 0; head < queue_.size(); ++head) {
    const int leaf = queue_[head];
    hanging_[leaf] = 1;
    ++hanging_size_[leaf];
    ++hanging_height_[leaf];
    for (const int next : neighbours(leaf)) {
      if (unvisited_[next] == 0 || hanging_[next] != 0) continue;
      hanging_size_[next] += hanging_size_[leaf];
      hanging_height_[next] = std::max(hanging_height_[next], hanging_height_[leaf]);
      if (--ties_[next] == 1) queue_.push_back(next);
    }
  }
}

// The scope with the edges among its nodes, neighbours by ascending id: sums over them do not depend on directions.
Graph ExplorerEncoder::scope_graph(const View& view) const {
  std::vector<std::int64_t> offsets = {0};
  std::vector<NodeId> lists;
  std::vector<NodeId> ids;
  for (const int index : seen_) {
    const auto all = view.both_ways().neighbours(nodes_[index]);
    ids.assign(all.begin(), all.end());
    if (!std::is_sorted(ids.begin(), ids.end())) std::sort(ids.begin(), ids.end());
    for (const NodeId id : ids) {
      const int place = local(id);
      if (place >= 0 && number_[place] >= 0) lists.push_back(number_[place]);
    }
    offsets.push_back(std::ssize(lists));
  }
  return Graph::from_lists(std::move(offsets), std::move(lists));
}

void ExplorerEncoder::append_nodes(const Exploration& state, ExplorerBatch& batch) {
  const View& view = state.view();
  const Graph& open = view.open();
  const Graph& into = view.into();
  const BudgetView budget(share_ * state.free_to_spend() / unit_, share_ * work_);
  batch.graphs.add(batch.scopes.emplace_back(scope_graph(view)));
  const Graph& scope = batch.scopes.back();
  for (std::size_t row = 0; row < seen_.size(); ++row) {
    const int i = seen_[row];
    const NodeId node = nodes_[i];
    const bool is_open = unvisited_[i] != 0;
    const int degree = degree_[i];
    const int in_scope = scope.degree(static_cast<NodeId>(row));
    double cost = 0;
    for (int k = 0; k < open.degree(node); ++k) cost += open.cost(node, k);
    const int both_ways = open.degree(node) + into.degree(node) - degree;
    append_row(
        NodeFeatures{
            .unvisited = flag(is_open),
            .current = flag(i == 0),
            .candidate = flag(visit_cost_[i] > 0),
            .degree = log_scale(degree),
            .unvisited_neighbours = log_scale(unvisited_neighbours_[i]),
            .isolated = flag(is_open && unvisited_neighbours_[i] == 0),
            .dead_end = flag(is_open && unvisited_neighbours_[i] == 1),
            .distance = near_scale(distance_[i]),
            .visit_cost = near_scale(visit_cost_[i]),
            .out_of_scope = static_cast<float>(degree - in_scope) / static_cast<float>(std::max(degree, 1)),
            .distance_to_work = near_scale(work_distance_[i] < 0 ? kFar : work_distance_[i]),
            .part_size = log_scale(part_size_[i]),
            .part_share = static_cast<float>(std::min(part_size_[i] / std::max(work_, 1.0), 1.0)),
            .edge_cost = static_cast<float>(std::min(cost / unit_ / std::max(open.degree(node), 1), kDear) - 1),
            .budget_per_work = budget.per_work,
            .slack = budget.slack,
            .hanging = flag(hanging_[i] != 0),
            .hanging_size = log_scale(hanging_size_[i]),
            .hanging_height = near_scale(hanging_height_[i]),
            .one_way = degree == 0 ? 0.0f : 1 - static_cast<float>(both_ways) / static_cast<float>(degree),
        },
        batch.node_x);
  }
}

void ExplorerEncoder::append_visits(const Exploration& state, ExplorerBatch& batch) {
  const View& view = state.view();
  const double budget = state.free_to_spend() / unit_;
  const int first_row = batch.graphs.first_node(batch.graphs.graph_count() - 1);
  for (const FirstVisit& visit : visits_) {
    const int i = local(visit.node);
    double next_cost = kFar;
    const double most = std::min(state.spendable() - visit.cost, kFar * unit_);
    search_.run(view.open(), visit.node, most, [&](NodeId node, double cost) {
      if (state.ground().contains(node)) return NearestFirst::Next::kThrough;
      next_cost = cost / unit_;
      return NearestFirst::Next::kEnd;
    });
    const BudgetView after(share_ * (budget - visit_cost_[i]), share_ * (work_ - 1));
    const double change = change_of_penalties(view, state.ground(), visit.node);
    append_row(
        VisitFeatures{
            .cost = near_scale(visit_cost_[i]),
            .change_of_penalties = static_cast<float>(change / 4),
            .unvisited_neighbours = log_scale(unvisited_neighbours_[i]),
            .next_cost = near_scale(next_cost),
            .budget_per_work = after.per_work,
            .slack = after.slack,
            .work = log_scale(static_cast<int>(std::min(work_, 1e9))),
            .hanging = flag(hanging_[i] != 0),
            .hanging_size = log_scale(hanging_size_[i]),
            .hanging_height = near_scale(hanging_height_[i]),
            .work_in_scope = static_cast<float>(share_),
        },
        batch.visit_x);
    batch.target.push_back(first_row + number_[i]);
    batch.state.push_back(batch.graphs.graph_count() - 1);
  }
  batch.current.push_back(first_row + number_[0]);
  batch.ceiling.push_back(std::min(work_, budget));
  batch.unseen.push_back(1 - share_);
  batch.budget_per_work.push_back(budget / std::max(work_, 1.0));
}

std::span<const FirstVisit> ExplorerEncoder::append(const Exploration& state, int scope, ExplorerBatch& batch) {
  const View& view = state.view();
  unit_ = view.open().mean_cost();
  gather_horizon(state);
  measure_distances(state, scope);
  find_first_visits(state);
  choose_scope(view, scope);
  measure_work_distances();
  measure_parts(view.valid_count() - state.ground_count());
  measure_hanging_trees();
  append_nodes(state, batch);
  append_visits(state, batch);
  return visits_;
}

}  // namespace graphdrl
