#include "graphdrl/planners/beam.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_map>

#include "graphdrl/base/error.h"
#include "graphdrl/base/random.h"
#include "graphdrl/graph/search.h"
#include "graphdrl/planners/bound.h"

namespace graphdrl {
namespace {

constexpr std::uint64_t kHashSeed = 1;
// A third of a level is kept by each of three measures, for none is right everywhere. They differ in their share of the
// penalties: all of them serve mazes best, a quarter graphs without dead ends, none budgets that will not do for
// everything, where what is left over costs nothing.
constexpr std::array<double, 3> kPenaltyShares = {1, 0.25, 0};
using Ranks = std::array<double, kPenaltyShares.size()>;  // lower is better
constexpr double kUnscored = 1e9;                         // ranks first visits behind all that the network scored
constexpr int kBlockNodes = 8192;                         // of states scored at once

// How many partial walks of a level the guide scores. Of 50, 6 serve as well as all in loop mazes (docs/explorer.md);
// by the root, for a wide beam is there to look beyond the network.
int scored_per_level(int width) {
  return static_cast<int>(std::ceil(0.75 * std::sqrt(width)));
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
  Ranks ranks;
  std::uint64_t hash;
};

struct Link {
  NodeId node;
  std::int64_t before;  // place of the first visit before it
};

class Beam {
 public:
  Beam(const SearchStart& start, const BeamOptions& options, ExplorerGuide* guide)
      : world_(*start.world),
        open_(world_.open()),
        into_(open_.reversed()),
        start_(start),
        width_(options.width),
        branching_(options.branching),
        cut_ties_(options.cut_ties),
        guide_(guide),
        scored_per_level_(guide == nullptr ? 0 : scored_per_level(width_)),
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

  // The candidates of every partial walk of the level; false where the time is up.
  bool expand_level(Deadline deadline);
  void expand(int parent);
  void expand_guided(int first, int end);
  Ranks ranks_of(double spent, double penalties) const;
  void add(const Candidate& candidate);
  void keep_best();
  std::vector<NodeId> unroll(std::int64_t trail) const;

  const World& world_;
  const Graph& open_;
  Graph into_;  // open_ turned round
  const SearchStart& start_;
  int width_;
  int branching_;
  bool cut_ties_;
  ExplorerGuide* guide_;  // null where partial walks are ranked by penalties
  int scored_per_level_;  // partial walks that the guide scores, from the front of a level; 0 without one
  bool dropped_ = false;
  std::size_t words_;
  double unit_;
  NearestFirst nearest_;
  std::vector<std::uint64_t> visit_hash_;
  std::vector<std::uint64_t> position_hash_;

  std::vector<Partial> level_;
  std::vector<std::uint64_t> visited_;  // [level_.size(), words_]
  std::vector<Candidate> candidates_;
  std::vector<Link> trail_;
  std::unordered_map<std::uint64_t, std::size_t> best_of_state_;
  std::vector<Partial> next_level_;
  std::vector<std::uint64_t> next_visited_;
  ExplorerBatch batch_;
  std::vector<NodeId> targets_;
  std::vector<double> costs_;
  std::vector<float> shortfall_;
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
    if (start_.visited[node]) continue;
    int neighbours = 0;
    for (const NodeId next : open_.neighbours(node)) neighbours += !start_.visited[next];
    root.penalties += leftover_penalty(neighbours);
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
    if (!expand_level(deadline)) return std::nullopt;
    keep_best();
  }
  return Plan{.walk = unroll(best), .optimal = !dropped_};
}

bool Beam::expand_level(Deadline deadline) {
  const int count = static_cast<int>(level_.size());
  const int scored = std::min(scored_per_level_, count);
  const int block = std::max(1, kBlockNodes / std::min(world_.valid_count(), kExplorerScope));
  for (int first = 0; first < scored; first += block) {
    if (passed(deadline)) return false;
    expand_guided(first, std::min(first + block, scored));
  }
  for (int parent = scored; parent < count; ++parent) {
    if (parent % 64 == 0 && passed(deadline)) return false;
    expand(parent);
  }
  return true;
}

Ranks Beam::ranks_of(double spent, double penalties) const {
  Ranks ranks{};
  for (std::size_t i = 0; i < ranks.size(); ++i) ranks[i] = spent + kPenaltyShares[i] * unit_ * penalties;
  return ranks;
}

void Beam::expand(int parent) {
  using Next = NearestFirst::Next;
  const Partial& from = level_[parent];
  const std::uint64_t* const visited = visited_of(parent);
  int branches = 0;
  double last_cost = 0;
  nearest_.run(from.position, start_.limit() - from.spent, [&](NodeId node, double cost) {
    if (has(visited, node)) return Next::kThrough;
    if (branches >= branching_ && (cut_ties_ || cost > last_cost)) {
      dropped_ = true;
      return Next::kEnd;
    }
    ++branches;
    last_cost = cost;
    const double spent = from.spent + cost;
    const double penalties = from.penalties + change_of_penalties(open_, into_, visited, node);
    const Ranks plain = ranks_of(spent, penalties);
    add({.parent = parent,
         .node = node,
         .spent = spent,
         .penalties = penalties,
         .ranks = guide_ == nullptr ? plain : Ranks{kUnscored + spent / unit_, plain[0], plain[1]},
         .hash = from.hash ^ visit_hash_[node]});
    return Next::kPast;
  });
}

void Beam::expand_guided(int first, int end) {
  batch_.clear();
  targets_.clear();
  costs_.clear();
  ExplorerEncoder& encoder = guide_->encoder_for(world_);
  for (int parent = first; parent < end; ++parent) {
    const Partial& from = level_[parent];
    const auto visits = encoder.append(
        {.visited = visited_of(parent), .position = from.position, .spendable = start_.limit() - from.spent},
        kExplorerScope, batch_);
    dropped_ = dropped_ || encoder.overlooked();
    for (const FirstVisit& visit : visits) {
      targets_.push_back(visit.node);
      costs_.push_back(visit.cost);
    }
  }
  if (targets_.empty()) return;
  guide_->score(batch_, shortfall_);
  for (std::size_t i = 0; i < targets_.size(); ++i) {
    const int parent = first + batch_.state[i];
    const double spent = level_[parent].spent + costs_[i];
    const double penalties =
        level_[parent].penalties + change_of_penalties(open_, into_, visited_of(parent), targets_[i]);
    const double shortfall = double{shortfall_[i]} - batch_.ceiling[batch_.state[i]];
    const Ranks plain = ranks_of(spent, penalties);
    add({.parent = parent,
         .node = targets_[i],
         .spent = spent,
         .penalties = penalties,
         .ranks = {shortfall, plain[0], plain[1]},
         .hash = level_[parent].hash ^ visit_hash_[targets_[i]]});
  }
}

// Of candidates that lead to the same state, only the cheapest stays; what the guide says of a dearer one holds for it
// at least.
void Beam::add(const Candidate& candidate) {
  const auto [known, fresh] =
      best_of_state_.try_emplace(candidate.hash ^ position_hash_[candidate.node], candidates_.size());
  if (fresh) {
    candidates_.push_back(candidate);
    return;
  }
  Candidate& other = candidates_[known->second];
  const double promise = std::min(candidate.ranks[0], other.ranks[0]);
  if (candidate.spent < other.spent) other = candidate;
  other.ranks[0] = promise;
}

void Beam::keep_best() {
  constexpr std::size_t kRanks = kPenaltyShares.size();
  const auto by = [](std::size_t rank) {
    return [rank](const Candidate& a, const Candidate& b) {
      if (a.ranks[rank] != b.ranks[rank]) return a.ranks[rank] < b.ranks[rank];
      return a.parent != b.parent ? a.parent < b.parent : a.node < b.node;
    };
  };
  const std::size_t kept = std::min(candidates_.size(), static_cast<std::size_t>(width_));
  if (kept < candidates_.size()) {
    dropped_ = true;
    auto chosen = candidates_.begin();
    for (std::size_t rank = 0; rank < kRanks; ++rank) {
      const std::size_t up_to = (kept * (rank + 1) + kRanks - 1) / kRanks;
      const auto end = candidates_.begin() + static_cast<std::ptrdiff_t>(up_to);
      if (chosen < end) std::nth_element(chosen, end, candidates_.end(), by(rank));
      chosen = end;
    }
    candidates_.resize(kept);
  }
  std::sort(candidates_.begin(), candidates_.end(), by(0));
  if (guide_ != nullptr) {
    // To the front of the level, for the guide: its own best, then others that look good without it.
    const int others = scored_per_level_ / 3;
    const std::ptrdiff_t own = std::min<std::ptrdiff_t>(scored_per_level_ - others, std::ssize(candidates_));
    std::sort(candidates_.begin() + own, candidates_.end(), by(1));
  }
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

std::vector<NodeId> Beam::unroll(std::int64_t trail) const {
  std::vector<NodeId> order;
  for (; trail >= 0; trail = trail_[trail].before) order.push_back(trail_[trail].node);
  std::reverse(order.begin(), order.end());
  return walk_through(start_, order);
}

// The most memory a beam can come to need, ties at the last branch aside: every level's chain of first visits, two
// levels of partial walks, and candidates of each; of a guided beam, as if all were scored.
double bytes_needed(const World& world, const BeamOptions& options, bool guided) {
  constexpr double kCandidateBytes = sizeof(Candidate) + 48;  // and its place in best_of_state_
  const double nodes = world.valid_count();
  const double branches =
      std::min<double>(guided ? std::max(options.branching, kExplorerScope) : options.branching, nodes);
  return options.width * (nodes * sizeof(Link) + 2 * (nodes / 8 + sizeof(Partial)) + branches * kCandidateBytes);
}

}  // namespace

std::optional<Plan> beam_plan(const SearchStart& start, const BeamOptions& options, Deadline deadline,
                              ExplorerGuide* guide) {
  const double bytes = bytes_needed(*start.world, options, guide != nullptr);
  if (bytes > kMaxBeamBytes) {
    throw Error({.what = "the beam is too wide for this world",
                 .expected = fmt::format("a width up to {:.0f}", std::floor(kMaxBeamBytes / bytes * options.width)),
                 .got = fmt::format("{}", options.width),
                 .where = start.world->name()});
  }
  return Beam(start, options, guide).run(deadline);
}

bool BeamPolicy::improve(const SearchStart& start, const BeamOptions& options, Deadline deadline,
                         std::optional<Plan>& best) {
  const auto take = [&](std::optional<Plan> next) {
    if (!next) return false;
    const int gain = best ? visited_after(start, next->walk) - visited_after(start, best->walk) : 1;
    const auto cheaper = [&] { return walk_cost(*start.world, next->walk) < walk_cost(*start.world, best->walk); };
    if (gain > 0 || (gain == 0 && (next->optimal || cheaper()))) best = std::move(next);
    return true;
  };
  // The very first search is finished whatever it takes, so that there is a walk.
  const bool first = !best;
  if (!take(beam_plan(start, options, first ? Deadline() : deadline))) return false;
  if (!guide_ || best->optimal) return true;
  if (first && limit_) take(explorer_plan(start, *guide_, deadline));
  return take(beam_plan(start, options, deadline, &*guide_));
}

Plan BeamPolicy::plan(const SearchStart& start) {
  const Deadline deadline = deadline_after(limit_);
  std::optional<Plan> best;
  improve(start, options_, deadline, best);
  const int most = limit_ ? max_visited(start) : 0;
  const auto fits = [&](const BeamOptions& options) {
    return options.width <= kMaxBeamWidth && bytes_needed(*start.world, options, guide_.has_value()) <= kMaxBeamBytes;
  };
  // Each of the two grows as long as there is room.
  for (BeamOptions wider = options_; limit_;) {
    const BeamOptions before = wider;
    wider.branching = std::min(wider.branching, start.world->valid_count()) * 2;
    if (!fits(wider)) wider.branching = before.branching;
    wider.width *= 2;
    if (!fits(wider)) wider.width = before.width;
    const bool grows = wider.width > before.width ||
                       (wider.branching > before.branching && before.branching < start.world->valid_count());
    best->optimal = best->optimal || visited_after(start, best->walk) >= most;
    if (best->optimal || !grows || !improve(start, wider, deadline, best)) break;
  }
  return *std::move(best);
}

}  // namespace graphdrl
