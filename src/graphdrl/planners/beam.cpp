#include "graphdrl/planners/beam.h"

#include <fmt/format.h>

#include <algorithm>
#include <unordered_map>

#include "graphdrl/base/error.h"
#include "graphdrl/base/random.h"
#include "graphdrl/graph/search.h"
#include "graphdrl/planners/bound.h"

namespace graphdrl {
namespace {

// What an unvisited node is likely to cost on top of one step, by its unvisited neighbours: one without any must be
// left again by the way one came; one with a single neighbour is a dead end. In mean edges; of
// fourteen pairs tried, the one that visits most on random 11×11 mazes at 1.0x.
constexpr double kIsolatedPenalty = 4;
constexpr double kDeadEndPenalty = 2;
constexpr std::uint64_t kHashSeed = 1;

double penalty(int unvisited_neighbours) {
  return unvisited_neighbours == 0 ? kIsolatedPenalty : unvisited_neighbours == 1 ? kDeadEndPenalty : 0.0;
}

// A partial walk. Its visited nodes are a row of words in the level's memory.
struct Partial {
  NodeId position;
  std::int64_t trail;  // its last first visit in the list of all kept ones
  double spent;
  double penalties;  // sum over the unvisited nodes
  std::uint64_t hash;
};

// A partial walk with one more first visit, not built yet.
struct Candidate {
  int parent;
  NodeId node;
  double spent;
  double penalties;
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
    Rng rng(kHashSeed);
    for (NodeId node = 0; node < open_.node_count(); ++node) {
      visit_hash_.push_back(rng.next());
      position_hash_.push_back(rng.next());
    }
  }

  // Empty where the time is up.
  std::optional<Plan> run(Deadline deadline);

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
  bool dropped_ = false;
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

std::optional<Plan> Beam::run(Deadline deadline) {
  visited_.assign(words_, 0);
  Partial root{.position = start_.position, .trail = -1, .spent = 0, .penalties = 0, .hash = 0};
  for (const NodeId node : world_.valid_nodes()) {
    if (!start_.visited[node]) continue;
    visited_[node / 64] |= std::uint64_t{1} << (node % 64);
    root.hash ^= visit_hash_[node];
  }
  for (const NodeId node : world_.valid_nodes()) {
    if (!start_.visited[node]) root.penalties += penalty(unvisited_neighbours(visited_.data(), node));
  }
  level_.assign(1, root);
  std::int64_t best = -1;
  while (!level_.empty()) {
    // Every partial walk of a level has visited as many nodes: the cheapest of the last level is the answer.
    best = std::min_element(level_.begin(), level_.end(), [](const Partial& a, const Partial& b) {
             return a.spent < b.spent;
           })->trail;
    candidates_.clear();
    best_of_state_.clear();
    for (int parent = 0; parent < std::ssize(level_); ++parent) {
      if (parent % 64 == 0 && passed(deadline)) return std::nullopt;
      expand(parent);
    }
    keep_best();
  }
  return Plan{.walk = unroll(best), .optimal = !dropped_};
}

void Beam::expand(int parent) {
  using Next = NearestFirst::Next;
  const Partial& from = level_[parent];
  const std::uint64_t* const visited = visited_of(parent);
  nearest_.run(from.position, start_.limit() - from.spent, [&](NodeId node, double cost) {
    if (has(visited, node)) return Next::kThrough;
    Candidate candidate{.parent = parent,
                        .node = node,
                        .spent = from.spent + cost,
                        .penalties = from.penalties - penalty(unvisited_neighbours(visited, node)),
                        .rank = 0,
                        .hash = from.hash ^ visit_hash_[node]};
    for (const NodeId other : into_.neighbours(node)) {
      if (has(visited, other)) continue;
      const int neighbours = unvisited_neighbours(visited, other);
      candidate.penalties += penalty(neighbours - 1) - penalty(neighbours);
    }
    candidate.rank = candidate.spent + unit_ * candidate.penalties;
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
  dropped_ = dropped_ || kept < candidates_.size();
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
                           .penalties = candidate.penalties,
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

// The most memory a beam can come to need: every level's chain of first visits, and two levels of partial walks with
// some candidates each.
double bytes_needed(const World& world, int width) {
  const double levels = world.valid_count();
  return width * (levels * sizeof(FirstVisit) + 2 * (levels / 8 + sizeof(Partial)) + 8 * sizeof(Candidate));
}

}  // namespace

std::optional<Plan> beam_plan(const SearchStart& start, const BeamOptions& options, Deadline deadline) {
  if (bytes_needed(*start.world, options.width) > kMaxBeamBytes) {
    throw Error({.what = "the beam is too wide for this world",
                 .expected = fmt::format("a width up to {:.0f}", kMaxBeamBytes / bytes_needed(*start.world, 1)),
                 .got = fmt::format("{}", options.width),
                 .where = start.world->name()});
  }
  return Beam(start, options).run(deadline);
}

Plan BeamPolicy::plan(const SearchStart& start) {
  const Deadline deadline = deadline_after(limit_);
  BeamOptions options = options_;
  Plan best = *beam_plan(start, options);
  if (!deadline) return best;
  const int most = max_visited(start);
  for (;;) {
    best.optimal = best.optimal || visited_after(start, best.walk) >= most;
    options.width *= 2;
    const bool too_wide = options.width > kMaxBeamWidth || bytes_needed(*start.world, options.width) > kMaxBeamBytes;
    if (best.optimal || too_wide) return best;
    std::optional<Plan> next = beam_plan(start, options, deadline);
    if (!next) return best;
    const int gain = visited_after(start, next->walk) - visited_after(start, best.walk);
    const bool cheaper = walk_cost(*start.world, next->walk) < walk_cost(*start.world, best.walk);
    if (gain > 0 || (gain == 0 && (cheaper || next->optimal))) best = *std::move(next);
  }
}

}  // namespace graphdrl
