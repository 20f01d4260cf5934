#include "graphdrl/planners/beam.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "graphdrl/base/random.h"
#include "graphdrl/graph/search.h"
#include "graphdrl/planners/bound.h"

namespace graphdrl {
namespace {

// What an unvisited node is feared to cost on top of one step, by its unvisited neighbours: one without any must be
// left again by the way one came; one with a single neighbour is a dead end. In mean edges.
constexpr double kIsolated = 4;
constexpr double kDeadEnd = 2;

double fear(int unvisited_neighbours) {
  return unvisited_neighbours == 0 ? kIsolated : unvisited_neighbours == 1 ? kDeadEnd : 0.0;
}

// A partial walk. Its visited nodes are a row of words in the level's memory.
struct Partial {
  NodeId position;
  std::int64_t trail;  // its last first visit in the list of all kept ones
  double spent;
  double fears;  // sum over the unvisited nodes
  std::uint64_t hash;
};

// A partial walk with one more first visit, not built yet.
struct Candidate {
  int parent;
  NodeId node;
  double spent;
  double fears;
  double rank;  // lower is better
  std::uint64_t hash;
};

struct FirstVisit {
  NodeId node;
  std::int64_t before;  // place of the first visit before it
};

class Beam {
 public:
  Beam(const SearchStart& start, const BeamOptions& options)
      : world_(*start.world),
        open_(world_.open()),
        into_(open_.reversed()),
        start_(start),
        width_(options.width),
        words_((static_cast<std::size_t>(open_.node_count()) + 63) / 64),
        unit_(open_.mean_cost()),
        nearest_(open_) {
    Rng rng(0x6265616d);
    for (NodeId node = 0; node < open_.node_count(); ++node) {
      visit_hash_.push_back(rng.next());
      position_hash_.push_back(rng.next());
    }
  }

  // Empty where the time is up.
  std::vector<NodeId> run(Deadline deadline);

 private:
  const std::uint64_t* visited_of(int partial) const { return visited_.data() + partial * words_; }
  static bool has(const std::uint64_t* set, NodeId node) { return (set[node / 64] >> (node % 64) & 1) != 0; }

  int unvisited_neighbours(const std::uint64_t* visited, NodeId node) const {
    int count = 0;
    for (const NodeId next : open_.neighbours(node)) count += !has(visited, next);
    return count;
  }

  void expand(int parent);
  void keep_best();
  std::vector<NodeId> unroll(std::int64_t trail) const;

  const World& world_;
  const Graph& open_;
  Graph into_;  // open_ turned round
  const SearchStart& start_;
  int width_;
  std::size_t words_;
  double unit_;
  NearestFirst nearest_;
  std::vector<std::uint64_t> visit_hash_;
  std::vector<std::uint64_t> position_hash_;

  std::vector<Partial> level_;
  std::vector<std::uint64_t> visited_;  // [level_.size(), words_]
  std::vector<Candidate> candidates_;
  std::vector<FirstVisit> trail_;
  std::unordered_map<std::uint64_t, std::size_t> best_of_state_;
  std::vector<Partial> next_level_;
  std::vector<std::uint64_t> next_visited_;
};

std::vector<NodeId> Beam::run(Deadline deadline) {
  visited_.assign(words_, 0);
  Partial root{.position = start_.position, .trail = -1, .spent = 0, .fears = 0, .hash = 0};
  for (const NodeId node : world_.valid_nodes()) {
    if (!start_.visited[node]) continue;
    visited_[node / 64] |= std::uint64_t{1} << (node % 64);
    root.hash ^= visit_hash_[node];
  }
  for (const NodeId node : world_.valid_nodes()) {
    if (!start_.visited[node]) root.fears += fear(unvisited_neighbours(visited_.data(), node));
  }
  level_.assign(1, root);
  std::int64_t best = -1;
  while (!level_.empty()) {
    // Every partial walk of a level has visited as many nodes: the cheapest of the last level is the answer.
    best = std::min_element(level_.begin(), level_.end(), [](const Partial& a, const Partial& b) {
             return a.spent < b.spent;
           })->trail;
    if (passed(deadline)) return {};
    candidates_.clear();
    best_of_state_.clear();
    for (int parent = 0; parent < std::ssize(level_); ++parent) expand(parent);
    keep_best();
  }
  return unroll(best);
}

void Beam::expand(int parent) {
  using Next = NearestFirst::Next;
  const Partial& from = level_[parent];
  const std::uint64_t* const visited = visited_of(parent);
  const double left = start_.budget_left - from.spent;
  nearest_.run(from.position, left + 1e-9 * (1 + left), [&](NodeId node, double cost) {
    if (has(visited, node)) return Next::kThrough;
    Candidate candidate{.parent = parent,
                        .node = node,
                        .spent = from.spent + cost,
                        .fears = from.fears - fear(unvisited_neighbours(visited, node)),
                        .rank = 0,
                        .hash = from.hash ^ visit_hash_[node]};
    for (const NodeId other : into_.neighbours(node)) {
      if (has(visited, other)) continue;
      const int neighbours = unvisited_neighbours(visited, other);
      candidate.fears += fear(neighbours - 1) - fear(neighbours);
    }
    candidate.rank = candidate.spent + unit_ * candidate.fears;
    const auto [known, fresh] = best_of_state_.try_emplace(candidate.hash ^ position_hash_[node], candidates_.size());
    if (fresh) {
      candidates_.push_back(candidate);
    } else if (candidate.spent < candidates_[known->second].spent) {
      candidates_[known->second] = candidate;
    }
    return Next::kPast;
  });
}

void Beam::keep_best() {
  const auto better = [](const Candidate& a, const Candidate& b) {
    if (a.rank != b.rank) return a.rank < b.rank;
    return a.parent != b.parent ? a.parent < b.parent : a.node < b.node;
  };
  const std::size_t kept = std::min(candidates_.size(), static_cast<std::size_t>(width_));
  std::nth_element(candidates_.begin(), candidates_.begin() + static_cast<std::ptrdiff_t>(kept), candidates_.end(),
                   better);
  candidates_.resize(kept);
  std::sort(candidates_.begin(), candidates_.end(), better);
  next_level_.clear();
  next_visited_.resize(kept * words_);
  for (std::size_t i = 0; i < kept; ++i) {
    const Candidate& candidate = candidates_[i];
    std::copy_n(visited_of(candidate.parent), words_, next_visited_.data() + i * words_);
    next_visited_[i * words_ + candidate.node / 64] |= std::uint64_t{1} << (candidate.node % 64);
    trail_.push_back({candidate.node, level_[candidate.parent].trail});
    next_level_.push_back({.position = candidate.node,
                           .trail = std::ssize(trail_) - 1,
                           .spent = candidate.spent,
                           .fears = candidate.fears,
                           .hash = candidate.hash});
  }
  level_.swap(next_level_);
  visited_.swap(next_visited_);
}

// The walk of a chain of first visits, every step of it.
std::vector<NodeId> Beam::unroll(std::int64_t trail) const {
  std::vector<NodeId> order;
  for (; trail >= 0; trail = trail_[trail].before) order.push_back(trail_[trail].node);
  std::reverse(order.begin(), order.end());
  std::vector<NodeId> walk = {start_.position};
  std::vector<bool> visited = start_.visited;
  for (const NodeId node : order) {
    const std::vector<NodeId> path = path_to_nearest(
        open_, walk.back(), [&](NodeId other) { return other == node; },
        [&](NodeId other) { return visited[other] || other == node; });
    walk.insert(walk.end(), path.begin(), path.end());
    visited[node] = true;
  }
  return walk;
}

}  // namespace

std::vector<NodeId> beam_walk(const SearchStart& start, const BeamOptions& options, Deadline deadline) {
  return Beam(start, options).run(deadline);
}

Plan BeamPolicy::plan(const SearchStart& start) {
  const Deadline deadline = deadline_after(limit_);
  const int most = max_visited(start);
  BeamOptions options = options_;
  Plan best{.walk = beam_walk(start, options)};
  for (;;) {
    best.optimal = visited_after(start, best.walk) >= most;
    if (!deadline || best.optimal || options.width > kMaxBeamWidth / 2) return best;
    options.width *= 2;
    std::vector<NodeId> walk = beam_walk(start, options, deadline);
    if (walk.empty()) return best;
    const int gain = visited_after(start, walk) - visited_after(start, best.walk);
    const bool cheaper = walk_cost(*start.world, walk) < walk_cost(*start.world, best.walk) - 1e-9;
    if (gain > 0 || (gain == 0 && cheaper)) best.walk = std::move(walk);
  }
}

}  // namespace graphdrl
