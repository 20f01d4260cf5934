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

float logarithm(double count) {
  return static_cast<float>(std::log1p(std::max(count, 0.0)));
}

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
  if (visits.size() < 2) return;
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
  visits.resize(std::min<std::size_t>(visits.size(), kOnlineVisits));
}

// What all rows of a decision share.
struct Common {
  double unit;         // a mean edge
  double free;         // to spend
  bool unlimited;      // no budget
  double mean_degree;  // seen so far
  double nearest;      // cost
  int least_met;       // visited neighbours of a first visit
  int most_met;
};

std::vector<Around> look_around(const Exploration& now, OnlineScratch& scratch) {
  const std::vector<FirstVisit>& visits = scratch.visits;
  std::vector<Around> around;
  around.reserve(visits.size());
  Surroundings surroundings(now, scratch);
  for (const FirstVisit& visit : visits) around.push_back(surroundings.of(visit.node));
  for (std::size_t i = 0; i < visits.size(); ++i) {
    if (around[i].part > 0) continue;
    const int part = surroundings.part_of(visits[i].node);
    for (std::size_t j = i; j < visits.size(); ++j) {
      if (around[j].part == 0 && surroundings.in_part(visits[j].node)) around[j].part = part;
    }
  }
  return around;
}

Common measure(const Exploration& now, double budget, std::span<const FirstVisit> visits,
               std::span<const Around> around) {
  const Census& census = now.view().census();
  const double unit = now.view().open().mean_cost();
  Common common{.unit = unit,
                .free = now.free_to_spend(),
                .unlimited = budget >= 0.01 * kMaxSteps * unit,  // as Task makes it of an infinite one
                .mean_degree = std::max(census.degrees / std::max(census.nodes, 1), 1.0),
                .nearest = kNoLimit,
                .least_met = around.front().met,
                .most_met = around.front().met};
  for (std::size_t i = 0; i < visits.size(); ++i) {
    common.nearest = std::min(common.nearest, visits[i].cost);
    common.least_met = std::min(common.least_met, around[i].met);
    common.most_met = std::max(common.most_met, around[i].met);
  }
  return common;
}

void add_map_features(const Exploration& now, double budget, double spent, const Common& common,
                      std::span<const FirstVisit> visits, std::vector<float>& row) {
  const View& view = now.view();
  const Census& census = view.census();
  const double nodes = std::max(census.nodes, 1);
  const double degree = common.mean_degree;
  const double variance = std::max(0.0, census.squared_degrees / nodes - degree * degree);
  const double visited = now.ground_count();
  const auto version = static_cast<double>(view.version());
  double oldest = version;
  for (const FirstVisit& visit : visits) oldest = std::min<double>(oldest, view.first_seen(visit.node));
  const auto add = [&](double value) { row.push_back(static_cast<float>(value)); };
  add(common.unlimited || budget <= 0 ? 1 : common.free / budget);
  add(std::log(degree) - 1);
  add(std::sqrt(variance) / degree);
  add(census.pairs > 0 ? census.closed_pairs / census.pairs : 0);
  add(census.dead_ends / nodes);
  add((census.met - nodes + 1) / nodes / degree);
  add(logarithm(view.frontier_count() / visited));
  add(spent > 0 ? std::min(visited * common.unit / spent, 2.0) : 1);
  add(logarithm(visited) / 5);
  add(census.low / nodes);
  add(common.unlimited ? 1.2 : logarithm(common.free / common.unit) / 6);
  add(census.meetings / nodes);
  add((version - oldest) / version);
  add(common.unlimited);
  add(!now.task().ends_anywhere());
}

void add_visit_features(const Exploration& now, const Common& common, const FirstVisit& visit, const Around& near,
                        std::span<const FirstVisit> visits, std::vector<float>& row) {
  const View& view = now.view();
  const double unit = common.unit;
  const double first_seen = view.first_seen(visit.node);
  const double seen = view.seen_at(visit.node);
  const auto version = static_cast<double>(view.version());
  int later = 0;
  int found_later = 0;
  for (const FirstVisit& other : visits) {
    later += view.seen_at(other.node) > seen;
    found_later += view.first_seen(other.node) > first_seen;
  }
  const double least = 1e-9 * unit;
  const int spread = common.most_met - common.least_met;
  const auto add = [&](double value) { row.push_back(static_cast<float>(value)); };
  add(std::min((visit.cost - common.nearest) / unit, 10.0) / 3);
  add(std::min(std::log(std::max(visit.cost, least) / std::max(common.nearest, least)), 4.0));
  add(visit.cost <= common.nearest * kAboutAsNear);
  add(std::log(std::max(near.met, 1)));
  add(spread > 0 ? static_cast<double>(near.met - common.least_met) / spread : 0);
  add(near.met / common.mean_degree);
  add(std::max(0.0, common.mean_degree - near.met) / 3);
  add(1.0 / (1 + later));
  add(1.0 / (1 + found_later));
  add(logarithm(version - seen) / 2);
  add(logarithm(version - first_seen) / 2);
  add(first_seen == version);
  add(logarithm(near.near_2) / 2);
  add(logarithm(near.near_4) / 2);
  add(near.to_next / 5.0);
  add(std::log(near.part) / 3);
  add(std::min(1.0, static_cast<double>(near.part) / std::max(view.frontier_count(), 1)));
  add(std::log(std::max(near.least_degree, 1)));
  add(std::log(std::max(near.most_siblings, 1)) / 2);
  add(logarithm(near.dense) / 2);
  add(common.unlimited || common.free <= 0 ? 0 : std::min(visit.cost / common.free, 1.0));
  add(std::tanh((first_seen - view.first_seen(now.position())) / 8));
}

}  // namespace

std::span<const FirstVisit> encode_online(const Exploration& now, double budget, double spent, OnlineScratch& scratch,
                                          NearestFirst& search, std::vector<float>& rows) {
  find_visits(now, search, scratch);
  const std::span<const FirstVisit> visits = scratch.visits;
  if (visits.empty()) return visits;
  const std::vector<Around> around = look_around(now, scratch);
  const Common common = measure(now, budget, visits, around);
  std::vector<float> of_map;
  add_map_features(now, budget, spent, common, visits, of_map);
  for (std::size_t i = 0; i < visits.size(); ++i) {
    add_visit_features(now, common, visits[i], around[i], visits, rows);
    rows.insert(rows.end(), of_map.begin(), of_map.end());
  }
  return visits;
}

}  // namespace graphdrl
