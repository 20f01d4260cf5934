#include "graphdrl/answer/least_budget.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "graphdrl/base/parallel.h"
#include "graphdrl/graph/search.h"
#include "graphdrl/planners/bound.h"

namespace graphdrl {
namespace {

constexpr double kPrecision = 1e-10;  // relative, of a budget where costs are no whole numbers
constexpr int kDigits = 9;            // told of such a budget

// Down to kDigits digits; what is within rounding of the next number up is that number.
double rounded_down(double value) {
  if (value <= 0) return 0;
  const double unit = std::pow(10, std::abs(kDigits - 1 - std::floor(std::log10(value))));
  const bool fraction = value < std::pow(10, kDigits - 1);
  const double digits = std::floor((fraction ? value * unit : value / unit) + 0.01);
  return fraction ? digits / unit : digits * unit;
}

// Empty where a node that is worth nothing is out of reach: then the bound does not count edges from there.
std::optional<double> least_of_complete(const World& world, NodeId start,
                                        const std::function<void(double share)>& progress) {
  const Graph& graph = world.open();
  const int count = graph.node_count();
  std::vector<double> arrival(count);  // [N], the cheapest edge into a node
  const auto find_arrival = [&](NodeId node) {
    double least = std::numeric_limits<double>::infinity();
    for (int i = 0; i < graph.degree(node); ++i) least = std::min(least, graph.cost(node, i));
    arrival[node] = least;
  };
  constexpr int kBatch = 256;  // of nodes, after which progress is told
  for (int begin = 0; begin < count; begin += kBatch) {
    const int end = std::min(begin + kBatch, count);
    parallel_for(end - begin, [&](int i) { find_arrival(begin + i); });
    if (progress) progress(static_cast<double>(end) / count);
  }
  const auto counts = [&](NodeId node) { return node != start && world.prize(node) > 0; };
  double sum = 0;
  double farthest = 0;  // of straight ways; the cheapest ones are no longer
  for (NodeId node = 0; node < count; ++node) {
    if (counts(node)) sum += arrival[node];
    if (node != start) farthest = std::max(farthest, graph.cost(start, graph.index_of(start, node)));
  }
  if (farthest <= sum) return sum;
  double least = sum;
  farthest = 0;
  NearestFirst().run_cheapest(graph, start, kNoLimit, [&](NodeId node, double cost) {
    farthest = std::max(farthest, cost);
    if (counts(node)) least = std::max(least, cost);
    return NearestFirst::Next::kThrough;
  });
  return farthest <= least ? std::optional(least) : std::nullopt;
}

}  // namespace

std::optional<double> least_budget(const World& world, NodeId start,
                                   const std::function<void(double share)>& progress) {
  const auto least = world.open().is_complete() ? least_of_complete(world, start, progress) : std::nullopt;
  if (!least) return least_budget_by_bounds(world, start);
  return world.open().integer_costs() ? *least : rounded_down(*least);
}

std::optional<double> least_budget_by_bounds(const World& world, NodeId start) {
  const auto may_visit_all = [&](double budget) {
    return max_prize(Task(world, start, budget)) >= world.total_prize() * (1 - kPrizeRounding);
  };
  const Graph& open = world.open();
  double high = 2.0 * world.valid_count() * open.max_cost();  // a tour along a spanning tree
  if (open.directed()) high *= world.valid_count();
  if (may_visit_all(0)) return 0;
  if (high == 0 || !std::isfinite(high) || !may_visit_all(high)) return std::nullopt;
  double too_little = 0;
  const bool whole = open.integer_costs();
  while (high - too_little > (whole ? 1 : kPrecision * high)) {
    double middle = std::midpoint(too_little, high);
    if (whole) middle = std::floor(middle);
    (may_visit_all(middle) ? high : too_little) = middle;
  }
  return whole ? high : rounded_down(world.spending_limit(high));
}

}  // namespace graphdrl
