#include "graphdrl/planners/frontier.h"

#include <algorithm>
#include <numeric>
#include <span>
#include <unordered_map>
#include <utility>

namespace graphdrl {
namespace {

// Of a tour (docs/unknown.md).
constexpr int kMostStepsInPart = 24;    // from its nearest first visit
constexpr std::size_t kMostParts = 40;  // the nearest ones
constexpr double kStraightShare = 0.5;  // of the cost of a way; the rest is that of the ways known
constexpr double kLess = 1 - 1e-9;      // of a cost: better, and not by rounding alone
constexpr int kMostPasses = 50;         // of improvements

// A way from the position, and what it costs up to each node of it.
struct Way {
  std::vector<NodeId> nodes;
  std::vector<double> costs;
  double length = 0;  // where nodes have places
};

Way way_to(const Exploration& now, NodeId node, const NearestFirst& search) {
  Way way{.nodes = {now.position()}, .costs = {0}};
  search.append_path_to(node, way.nodes);
  const Graph& open = now.view().open();
  const std::span<const Point> places = now.view().places();
  for (std::size_t i = 1; i < way.nodes.size(); ++i) {
    const NodeId from = way.nodes[i - 1];
    way.costs.push_back(way.costs.back() + open.cost(from, open.index_of(from, way.nodes[i])));
    if (!places.empty()) way.length += length_between(places[from], places[way.nodes[i]]);
  }
  return way;
}

// cost_of_length: by what the ways cost; 0 where nodes have no places.
double cost_between(std::span<const Point> places, double cost_of_length, const Way& one, const Way& other) {
  const auto [fork, _] = std::ranges::mismatch(one.nodes, other.nodes);
  const double shared = one.costs[static_cast<std::size_t>(fork - one.nodes.begin()) - 1];
  const double known = one.costs.back() + other.costs.back() - 2 * shared;
  if (cost_of_length == 0) return known;
  const double straight = cost_of_length * length_between(places[one.nodes.back()], places[other.nodes.back()]);
  return kStraightShare * straight + (1 - kStraightShare) * known;
}

// Stop 0 is the position.
struct TourCosts {
  std::vector<std::vector<double>> between;  // [stops, stops]
  std::vector<double> to_end;                // [stops], 0 where the walk may end anywhere
};

double cost_of(const std::vector<int>& tour, const TourCosts& costs) {
  double cost = 0;
  int at = 0;
  for (const int stop : tour) cost += costs.between[std::exchange(at, stop)][stop];
  return cost + costs.to_end[at];
}

// All stops but the position: nearest neighbour, then 2-opt and single stops moved, while they help.
std::vector<int> short_tour(const TourCosts& costs) {
  const int stops = static_cast<int>(costs.to_end.size()) - 1;
  std::vector<int> tour(stops);
  std::iota(tour.begin(), tour.end(), 1);
  for (int i = 0, at = 0; i < stops; at = tour[i++]) {
    std::iter_swap(tour.begin() + i, std::min_element(tour.begin() + i, tour.end(), [&](int a, int b) {
                     return costs.between[at][a] < costs.between[at][b];
                   }));
  }
  double least = cost_of(tour, costs);
  bool better = true;
  std::vector<int> tried;
  const auto try_it = [&] {
    const double cost = cost_of(tried, costs);
    if (cost >= least * kLess) return;
    least = cost;
    tour = tried;
    better = true;
  };
  for (int pass = 0; better && pass < kMostPasses; ++pass) {
    better = false;
    for (int i = 0; i < stops; ++i) {
      for (int j = 0; j < stops; ++j) {
        tried = tour;
        if (i < j) {
          std::reverse(tried.begin() + i, tried.begin() + j + 1);
          try_it();
          tried = tour;
        }
        tried.erase(tried.begin() + i);
        tried.insert(tried.begin() + j, tour[i]);
        try_it();
      }
    }
  }
  return tour;
}

}  // namespace

std::vector<FrontierPart> frontier_parts(const Exploration& now, NearestFirst& search, int most_steps) {
  std::vector<FirstVisit> visits;
  std::unordered_map<NodeId, int> index_of;
  now.for_first_visits(
      search,
      [&](NodeId node, double cost) {
        index_of.emplace(node, static_cast<int>(visits.size()));
        visits.push_back({node, cost});
        return true;
      },
      [](double /*cost*/) { return true; });
  const Graph& both_ways = now.view().both_ways();
  std::vector<FrontierPart> parts;
  std::vector<bool> met(visits.size());
  std::vector<std::pair<int, int>> part;           // visits by index, and steps from the first
  NodeSet looked_around(now.view().node_count());  // ground whose neighbours are met
  for (int first = 0; first < std::ssize(visits); ++first) {
    if (met[first]) continue;
    met[first] = true;
    part.assign(1, {first, 0});
    for (std::size_t i = 0; i < part.size(); ++i) {
      const int visit = part[i].first;
      const int steps = part[i].second;
      if (steps >= most_steps) continue;
      const auto meet = [&](NodeId node) {
        const auto other = index_of.find(node);
        if (other == index_of.end() || met[other->second]) return;
        met[other->second] = true;
        part.emplace_back(other->second, steps + 1);
      };
      for (const NodeId next : both_ways.neighbours(visits[visit].node)) {
        meet(next);
        if (!now.ground().contains(next) || looked_around.contains(next)) continue;
        looked_around.insert(next);
        for (const NodeId beside : both_ways.neighbours(next)) meet(beside);
      }
    }
    parts.push_back({.nearest = visits[first], .size = static_cast<int>(part.size())});
  }
  return parts;
}

NodeId first_stop_of_frontier_tour(const Exploration& now, NearestFirst& search, int smallest_part) {
  std::vector<FrontierPart> parts = frontier_parts(now, search, kMostStepsInPart);
  const auto is_small = [&](const FrontierPart& part) { return part.size < smallest_part; };
  if (!std::ranges::all_of(parts, is_small)) std::erase_if(parts, is_small);
  if (parts.empty()) return kNoNode;
  parts.resize(std::min(parts.size(), kMostParts));

  std::vector<Way> ways = {way_to(now, now.position(), search)};
  for (const FrontierPart& part : parts) ways.push_back(way_to(now, part.nearest.node, search));
  double cost = 0;
  double length = 0;
  for (const Way& way : ways) {
    cost += way.costs.back();
    length += way.length;
  }
  const double cost_of_length = length > 0 ? cost / length : 0;
  TourCosts costs{.between = {ways.size(), std::vector<double>(ways.size())}, .to_end = {}};
  for (std::size_t a = 0; a < ways.size(); ++a) {
    costs.to_end.push_back(now.task().cost_to_end(ways[a].nodes.back()));
    for (std::size_t b = 0; b < a; ++b) {
      costs.between[a][b] = costs.between[b][a] =
          b == 0 ? ways[a].costs.back() : cost_between(now.view().places(), cost_of_length, ways[a], ways[b]);
    }
  }
  return parts[short_tour(costs).front() - 1].nearest.node;
}

}  // namespace graphdrl
