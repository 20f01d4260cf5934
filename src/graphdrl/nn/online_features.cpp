#include "graphdrl/nn/online_features.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace graphdrl {
namespace {

constexpr int kMostScanned = 100;  // edges looked at around a first visit
constexpr int kMostScannedOfPart = 400;
constexpr int kMostOfPart = 64;  // frontier nodes of a part that are counted
constexpr int kFarthest = 4;     // known steps from a first visit that are looked at
constexpr double kAboutAsNear = 1 + 1e-9;

float logarithm(double count) {
  return static_cast<float>(std::log1p(std::max(count, 0.0)));
}

// A row under way.
class FeatureRow {
 public:
  FeatureRow(std::vector<float>& rows, int width) : rows_(rows), first_(rows.size()) { rows.reserve(first_ + width); }
  void add(double value) { rows_.push_back(static_cast<float>(value)); }
  std::size_t size() const { return rows_.size() - first_; }

 private:
  std::vector<float>& rows_;
  std::size_t first_;
};

// What is known around a first visit.
struct Around {
  int met = 0;
  int least_degree = 0;
  int most_siblings = 0;
  int near_2 = 0;
  int near_4 = 0;
  int to_next = kFarthest + 1;
  int dense = 0;
  int part = 0;
};

class Surroundings {
 public:
  Surroundings(const Exploration& now, OnlineScratch& scratch)
      : now_(now), graph_(now.view().both_ways()), scratch_(scratch) {
    scratch.marks.resize(std::max<std::size_t>(scratch.marks.size(), graph_.node_count()));
  }

  Around of(NodeId node) {
    Around around;
    for (const NodeId next : graph_.neighbours(node)) {
      if (!now_.ground().contains(next)) continue;
      const int degree = graph_.degree(next);
      around.least_degree = around.met == 0 ? degree : std::min(around.least_degree, degree);
      around.most_siblings = std::max(around.most_siblings, now_.view().frontier_neighbours(next));
      ++around.met;
    }
    look_around(node, around);
    return around;
  }

  // A part of the frontier: frontier nodes with visited neighbours that are the same, or next to each other. Gives how
  // many; in_part() tells of which part until the next call of anything else.
  int part_of(NodeId node) {
    begin();
    meet(node, 0);
    int part = 1;
    int scanned = 0;
    for (std::size_t head = 0; head < scratch_.queue.size() && scanned < kMostScannedOfPart; ++head) {
      const NodeId here = scratch_.queue[head];
      for (const NodeId next : graph_.neighbours(here)) {
        ++scanned;
        if (now_.is_new(next)) {
          part += meet(next, 0);
        } else if (now_.view().frontier_neighbours(next) > 0) {
          meet(next, 0);
        }
      }
      if (part >= kMostOfPart) break;
    }
    return part;
  }
  bool in_part(NodeId node) const { return scratch_.marks[node] == scratch_.mark; }

 private:
  void begin() {
    if (++scratch_.mark == 0) {
      std::ranges::fill(scratch_.marks, 0);
      scratch_.mark = 1;
    }
    scratch_.queue.clear();
    scratch_.steps.clear();
  }
  bool meet(NodeId node, int steps) {
    if (scratch_.marks[node] == scratch_.mark) return false;
    scratch_.marks[node] = scratch_.mark;
    scratch_.queue.push_back(node);
    scratch_.steps.push_back(steps);
    return true;
  }

  // Breadth first through ground.
  void look_around(NodeId node, Around& around) {
    begin();
    meet(node, 0);
    int scanned = 0;
    for (std::size_t head = 0; head < scratch_.queue.size() && scanned < kMostScanned; ++head) {
      const int steps = scratch_.steps[head];
      if (steps == kFarthest) break;
      if (head > 0 && now_.is_new(scratch_.queue[head])) continue;
      for (const NodeId next : graph_.neighbours(scratch_.queue[head])) {
        ++scanned;
        if (!meet(next, steps + 1)) continue;
        if (!now_.is_new(next)) {
          around.dense += steps + 1 <= 2;
          continue;
        }
        ++around.near_4;
        around.near_2 += steps + 1 <= 2;
        around.to_next = std::min(around.to_next, steps + 1);
      }
    }
  }

  const Exploration& now_;
  const Graph& graph_;
  OnlineScratch& scratch_;
};

// The nearest first visits; see kOnlineVisits.
void find_visits(const Exploration& now, NearestFirst& search, OnlineScratch& scratch) {
  std::vector<FirstVisit>& visits = scratch.visits;
  visits.clear();
  now.for_first_visits(
      search,
      [&](NodeId node, double cost) {
        if (std::ssize(visits) >= kOnlineVisits && cost > visits[kOnlineVisits - 1].cost * kAboutAsNear) return false;
        visits.push_back({node, cost});
        return true;
      },
      [](double) { return true; });
  if (std::ssize(visits) <= kOnlineVisits) return;
  const View& view = now.view();
  const auto met = [&](NodeId node) {
    return std::ranges::count_if(view.into().neighbours(node),
                                 [&](NodeId next) { return now.ground().contains(next); });
  };
  for (int sign : {1, -1}) {
    const std::size_t place = sign == 1 ? 0 : 1;
    std::size_t best = place;
    for (std::size_t i = place; i < visits.size() && visits[i].cost <= visits[0].cost * kAboutAsNear; ++i) {
      const auto rank = [&](std::size_t at) {
        return std::pair(sign * met(visits[at].node), view.seen_at(visits[at].node));
      };
      if (rank(i) > rank(best)) best = i;
    }
    std::swap(visits[place], visits[best]);
  }
  visits.resize(kOnlineVisits);
}

}  // namespace

std::span<const FirstVisit> encode_online(const Exploration& now, double budget, double spent, OnlineScratch& scratch,
                                          NearestFirst& search, std::vector<float>& rows) {
  find_visits(now, search, scratch);
  const std::vector<FirstVisit>& visits = scratch.visits;
  if (visits.empty()) return visits;
  const View& view = now.view();
  const Census& census = view.census();
  const double unit = view.open().mean_cost();
  const double free = now.free_to_spend();
  const bool unlimited = budget >= 0.01 * kMaxSteps * unit;  // as Task makes it of an infinite one
  const double nodes = std::max(census.nodes, 1);
  const double mean_degree = std::max(census.degrees / nodes, 1.0);
  const auto version = static_cast<double>(view.version());

  double nearest = kNoLimit;
  double oldest = version;
  std::vector<Around> around;
  Surroundings surroundings(now, scratch);
  int least_met = std::numeric_limits<int>::max();
  int most_met = 0;
  for (const FirstVisit& visit : visits) {
    nearest = std::min(nearest, visit.cost);
    around.push_back(surroundings.of(visit.node));
    least_met = std::min(least_met, around.back().met);
    most_met = std::max(most_met, around.back().met);
    oldest = std::min<double>(oldest, view.first_seen(visit.node));
  }
  for (std::size_t i = 0; i < visits.size(); ++i) {
    if (around[i].part > 0) continue;
    const int part = surroundings.part_of(visits[i].node);
    for (std::size_t j = i; j < visits.size(); ++j) {
      if (around[j].part == 0 && surroundings.in_part(visits[j].node)) around[j].part = part;
    }
  }

  std::array<float, kOnlineMapFeatureCount> of_map{};
  {
    const double variance = std::max(0.0, census.squared_degrees / nodes - mean_degree * mean_degree);
    const double visited = now.ground_count();
    std::size_t at = 0;
    const auto add = [&](double value) { of_map[at++] = static_cast<float>(value); };
    add(unlimited || budget <= 0 ? 1 : free / budget);
    add(std::log(mean_degree) - 1);
    add(std::sqrt(variance) / mean_degree);
    add(census.pairs > 0 ? census.closed_pairs / census.pairs : 0);
    add(census.dead_ends / nodes);
    add((census.met - nodes + 1) / nodes / mean_degree);
    add(logarithm(view.frontier_count() / visited));
    add(spent > 0 ? std::min(visited * unit / spent, 2.0) : 1);
    add(logarithm(visited) / 5);
    add(census.low / nodes);
    add(unlimited ? 1.2 : logarithm(free / unit) / 6);
    add(census.meetings / nodes);
    add((version - oldest) / version);
    add(unlimited);
    add(!now.task().ends_anywhere());
  }

  for (std::size_t i = 0; i < visits.size(); ++i) {
    const FirstVisit& visit = visits[i];
    const Around& near = around[i];
    const double first_seen = view.first_seen(visit.node);
    const double seen = view.seen_at(visit.node);
    int later = 0;
    int found_later = 0;
    for (const FirstVisit& other : visits) {
      later += view.seen_at(other.node) > seen;
      found_later += view.first_seen(other.node) > first_seen;
    }
    const double cost = std::max(visit.cost, 1e-9 * unit);
    FeatureRow row(rows, kOnlineFeatureCount);
    row.add(std::min((visit.cost - nearest) / unit, 10.0) / 3);
    row.add(std::min(std::log(cost / std::max(nearest, 1e-9 * unit)), 4.0));
    row.add(visit.cost <= nearest * kAboutAsNear);
    row.add(std::log(std::max(near.met, 1)));
    row.add(most_met > least_met ? static_cast<double>(near.met - least_met) / (most_met - least_met) : 0);
    row.add(near.met / mean_degree);
    row.add(std::max(0.0, mean_degree - near.met) / 3);
    row.add(1.0 / (1 + later));
    row.add(1.0 / (1 + found_later));
    row.add(logarithm(version - seen) / 2);
    row.add(logarithm(version - first_seen) / 2);
    row.add(first_seen == version);
    row.add(logarithm(near.near_2) / 2);
    row.add(logarithm(near.near_4) / 2);
    row.add(near.to_next / 5.0);
    row.add(std::log(near.part) / 3);
    row.add(std::min(1.0, static_cast<double>(near.part) / std::max(view.frontier_count(), 1)));
    row.add(std::log(std::max(near.least_degree, 1)));
    row.add(std::log(std::max(near.most_siblings, 1)) / 2);
    row.add(logarithm(near.dense) / 2);
    row.add(unlimited || free <= 0 ? 0 : std::min(visit.cost / free, 1.0));
    row.add(std::tanh((first_seen - view.first_seen(now.position())) / 8));
    for (const float value : of_map) row.add(value);
  }
  return visits;
}

}  // namespace graphdrl
