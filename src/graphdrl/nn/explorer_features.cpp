#include "graphdrl/nn/explorer_features.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace graphdrl {
namespace {

constexpr double kFar = 32;  // mean edges; what is farther looks as far
constexpr int kMany = 64;    // nodes; more look as many
constexpr std::size_t kLeastVisits = 3;
constexpr double kInfinite = std::numeric_limits<double>::infinity();

bool has(const std::uint64_t* set, NodeId node) {
  return (set[node / 64] >> (node % 64) & 1) != 0;
}

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
      : per_work(static_cast<float>(std::min(budget / std::max(work, 1.0), 3.0))),
        slack(static_cast<float>(std::clamp(budget - work, -16.0, 16.0) / 8)) {}
  float per_work;
  float slack;
};

}  // namespace

void ExplorerBatch::clear() {
  graphs.clear();
  for (auto* values : {&node_x, &visit_x}) values->clear();
  for (auto* values : {&current, &target, &state}) values->clear();
  for (auto* values : {&ceiling, &unseen, &budget_per_work}) values->clear();
  parts.clear();
}

std::vector<std::uint64_t> bits_of(const std::vector<bool>& visited) {
  std::vector<std::uint64_t> bits((visited.size() + 63) / 64);
  for (std::size_t node = 0; node < visited.size(); ++node)
    bits[node / 64] |= std::uint64_t{visited[node]} << (node % 64);
  return bits;
}

double leftover_penalty(int unvisited_neighbours) {
  return unvisited_neighbours == 0 ? 4.0 : unvisited_neighbours == 1 ? 2.0 : 0.0;
}

double change_of_penalties(const Graph& open, const Graph& into, const std::uint64_t* visited, NodeId node) {
  const auto unvisited_neighbours = [&](NodeId of) {
    int count = 0;
    for (const NodeId next : open.neighbours(of)) count += !has(visited, next);
    return count;
  };
  double change = -leftover_penalty(unvisited_neighbours(node));
  for (const NodeId other : into.neighbours(node)) {
    if (has(visited, other)) continue;
    const int neighbours = unvisited_neighbours(other);
    change += leftover_penalty(neighbours - 1) - leftover_penalty(neighbours);
  }
  return change;
}

ExplorerEncoder::ExplorerEncoder(const World& world)
    : world_(&world),
      into_(world.open().reversed()),
      row_of_(world.open().node_count(), -1),
      unit_(world.open().mean_cost()),
      nearest_(world.open()),
      from_visit_(world.open()) {
  const Graph& open = world.open();
  const std::span<const NodeId> nodes = world.valid_nodes();
  for (std::size_t row = 0; row < nodes.size(); ++row) row_of_[nodes[row]] = static_cast<int>(row);
  std::vector<Edge> edges = open.edges();
  for (Edge& edge : edges) edge = {row_of_[edge.a], row_of_[edge.b], 1};
  graph_ = Graph::from_edges(world.valid_count(), edges);
  for (const NodeId node : nodes) {
    double cost = 0;
    for (int i = 0; i < open.degree(node); ++i) cost += open.cost(node, i);
    const int degree = graph_.degree(row_of_[node]);
    fixed_.push_back(log_scale(degree));
    fixed_.push_back(static_cast<float>(std::min(cost / unit_ / std::max(open.degree(node), 1), 4.0) - 1));
    const int both_ways = open.degree(node) + into_.degree(node) - degree;
    fixed_.push_back(degree == 0 ? 0.0f : 1 - static_cast<float>(both_ways) / static_cast<float>(degree));
  }
  const auto rows = static_cast<std::size_t>(world.valid_count());
  number_.assign(rows, kNoNode);
  all_rows_.resize(rows);
  std::iota(all_rows_.begin(), all_rows_.end(), 0);
  distance_.resize(rows);
  visit_cost_.resize(rows);
  unvisited_neighbours_.resize(rows);
  work_distance_.resize(rows);
  part_size_.resize(rows);
  ties_.resize(rows);
  hanging_size_.resize(rows);
  hanging_height_.resize(rows);
  queue_.reserve(rows);
}

void ExplorerEncoder::measure_distances(const ExplorerState& state) {
  using Next = NearestFirst::Next;
  std::fill(distance_.begin(), distance_.end(), kInfinite);
  std::fill(visit_cost_.begin(), visit_cost_.end(), 0.0);
  visits_.clear();
  distance_[row_of_[state.position]] = 0;
  in_reach_.assign(1, row_of_[state.position]);
  nearest_.run(state.position, state.spendable, [&](NodeId node, double cost) {
    distance_[row_of_[node]] = cost / unit_;
    in_reach_.push_back(row_of_[node]);
    return Next::kThrough;
  });
  nearest_.run(state.position, state.spendable, [&](NodeId node, double cost) {
    if (has(state.visited, node)) return Next::kThrough;
    visits_.push_back({node, cost});
    visit_cost_[row_of_[node]] = cost / unit_;
    return Next::kPast;
  });
}

void ExplorerEncoder::measure_work(const std::vector<bool>& unvisited) {
  // How many steps visited nodes are from an unvisited one.
  const int rows = graph_.node_count();
  queue_.clear();
  for (int row = 0; row < rows; ++row) {
    work_distance_[row] = unvisited[row] ? 0 : -1;
    if (unvisited[row]) queue_.push_back(row);
  }
  for (std::size_t head = 0; head < queue_.size(); ++head) {
    for (const int next : graph_.neighbours(queue_[head])) {
      if (work_distance_[next] >= 0) continue;
      work_distance_[next] = work_distance_[queue_[head]] + 1;
      queue_.push_back(next);
    }
  }
  // Parts: unvisited nodes connected through unvisited ones.
  std::fill(part_size_.begin(), part_size_.end(), 0);
  for (int row = 0; row < rows; ++row) {
    if (!unvisited[row] || part_size_[row] > 0) continue;
    queue_.assign(1, row);
    part_size_[row] = 1;
    for (std::size_t head = 0; head < queue_.size(); ++head) {
      for (const int next : graph_.neighbours(queue_[head])) {
        if (!unvisited[next] || part_size_[next] > 0) continue;
        part_size_[next] = 1;
        queue_.push_back(next);
      }
    }
    for (const int member : queue_) part_size_[member] = static_cast<int>(queue_.size());
  }
  // Hanging trees: unvisited nodes that can be left only by the way one came. Leaves are taken off again and again;
  // visited ground next to a node holds it as one more edge would.
  queue_.clear();
  for (int row = 0; row < rows; ++row) {
    hanging_size_[row] = 0;
    hanging_height_[row] = 0;
    if (!unvisited[row]) continue;
    const bool anchored = unvisited_neighbours_[row] < graph_.degree(row);
    ties_[row] = unvisited_neighbours_[row] + (anchored ? 1 : 0);
    if (ties_[row] <= 1) queue_.push_back(row);
  }
  hanging_.assign(rows, false);
  for (std::size_t head = 0; head < queue_.size(); ++head) {
    const int row = queue_[head];
    hanging_[row] = true;
    ++hanging_size_[row];
    ++hanging_height_[row];
    for (const int next : graph_.neighbours(row)) {
      if (!unvisited[next] || hanging_[next]) continue;
      hanging_size_[next] += hanging_size_[row];
      hanging_height_[next] = std::max(hanging_height_[next], hanging_height_[row]);
      if (--ties_[next] == 1) queue_.push_back(next);
    }
  }
}

std::span<const FirstVisit> ExplorerEncoder::append(const ExplorerState& state, int scope, ExplorerBatch& batch) {
  const int rows = graph_.node_count();
  const std::span<const NodeId> nodes = world_->valid_nodes();
  unvisited_.resize(rows);
  for (int row = 0; row < rows; ++row) unvisited_[row] = !has(state.visited, nodes[row]);
  for (int row = 0; row < rows; ++row) {
    int count = 0;
    for (const int next : graph_.neighbours(row)) count += unvisited_[next];
    unvisited_neighbours_[row] = count;
  }
  measure_distances(state);
  measure_work(unvisited_);
  const double budget = state.spendable / unit_;
  double work = 0;
  for (const NodeId row : in_reach_) work += unvisited_[row];

  // What the network looks at.
  std::size_t size = 0;
  std::size_t visits = 0;
  double work_in_scope = 0;
  while (size < in_reach_.size() &&
         (size < static_cast<std::size_t>(scope) || visits < std::min(visits_.size(), kLeastVisits))) {
    visits += visit_cost_[in_reach_[size]] > 0;
    work_in_scope += unvisited_[in_reach_[size]];
    ++size;
  }
  const bool whole = size == static_cast<std::size_t>(rows);
  const std::span<const NodeId> seen = whole ? std::span<const NodeId>(all_rows_) : std::span(in_reach_).first(size);
  if (whole) {
    batch.graphs.add(graph_);
  } else {
    batch.graphs.add(batch.parts.emplace_back(graph_.induced(seen, number_)));
  }
  // As if the rest of the world were as much work for as much of the budget.
  const double share = work > 0 ? work_in_scope / work : 1;
  const BudgetView view(share * budget, share * work);

  const int first_row = batch.graphs.node_count() - static_cast<int>(size);
  for (std::size_t i = 0; i < size; ++i) number_[seen[i]] = first_row + static_cast<int>(i);
  batch.node_x.resize(static_cast<std::size_t>(batch.graphs.node_count()) * kExplorerNodeFeatureCount);
  float* x = batch.node_x.data() + static_cast<std::ptrdiff_t>(first_row) * kExplorerNodeFeatureCount;
  const auto out_of_scope = [&](NodeId row) {
    int count = 0;
    for (const NodeId next : graph_.neighbours(row)) count += number_[next] == kNoNode;
    return static_cast<float>(count) / static_cast<float>(std::max(graph_.degree(row), 1));
  };
  for (const NodeId row : seen) {
    const bool open = unvisited_[row];
    const float* const fixed = fixed_.data() + 3 * static_cast<std::ptrdiff_t>(row);
    x[0] = open;
    x[1] = nodes[row] == state.position;
    x[2] = visit_cost_[row] > 0;
    x[3] = fixed[0];
    x[4] = log_scale(unvisited_neighbours_[row]);
    x[5] = open && unvisited_neighbours_[row] == 0;
    x[6] = open && unvisited_neighbours_[row] == 1;
    x[7] = near_scale(distance_[row]);
    x[8] = near_scale(visit_cost_[row]);
    x[9] = whole ? 0 : out_of_scope(row);
    x[10] = near_scale(work_distance_[row] < 0 ? kFar : work_distance_[row]);
    x[11] = log_scale(part_size_[row]);
    x[12] = static_cast<float>(std::min(part_size_[row] / std::max(work, 1.0), 1.0));
    x[13] = fixed[1];
    x[14] = view.per_work;
    x[15] = view.slack;
    x[16] = hanging_[row];
    x[17] = log_scale(hanging_size_[row]);
    x[18] = near_scale(hanging_height_[row]);
    x[19] = fixed[2];
    x += kExplorerNodeFeatureCount;
  }

  const int index = batch.graphs.graph_count() - 1;
  overlooked_ =
      std::erase_if(visits_, [&](const FirstVisit& visit) { return number_[row_of_[visit.node]] == kNoNode; }) > 0;
  for (const FirstVisit& visit : visits_) {
    const int row = row_of_[visit.node];
    double next_cost = kInfinite;
    from_visit_.run(visit.node, state.spendable - visit.cost, [&](NodeId node, double cost) {
      if (has(state.visited, node)) return NearestFirst::Next::kThrough;
      next_cost = cost / unit_;
      return NearestFirst::Next::kEnd;
    });
    const BudgetView after(share * (budget - visit_cost_[row]), share * (work - 1));
    const double change = change_of_penalties(world_->open(), into_, state.visited, visit.node);
    batch.visit_x.insert(batch.visit_x.end(),
                         {near_scale(visit_cost_[row]), static_cast<float>(change / 4),
                          log_scale(unvisited_neighbours_[row]), near_scale(next_cost), after.per_work, after.slack,
                          log_scale(static_cast<int>(work)), static_cast<float>(hanging_[row]),
                          log_scale(hanging_size_[row]), near_scale(hanging_height_[row]), static_cast<float>(share)});
    batch.target.push_back(number_[row]);
    batch.state.push_back(index);
  }
  batch.current.push_back(number_[row_of_[state.position]]);
  batch.ceiling.push_back(std::min(work, budget));
  batch.unseen.push_back(1 - share);
  batch.budget_per_work.push_back(budget / std::max(work, 1.0));
  for (const NodeId row : seen) number_[row] = kNoNode;
  return visits_;
}

}  // namespace graphdrl
