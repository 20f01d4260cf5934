#include "graphdrl/planners/beam.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "graphdrl/base/error.h"
#include "graphdrl/planners/baselines.h"
#include "graphdrl/planners/best_states.h"
#include "graphdrl/planners/visited_sets.h"

namespace graphdrl {
namespace {

// Each level keeps a third by each ranking. They differ in their share of the penalties: 1 serves mazes best, a quarter
// graphs without dead ends, 0 budgets too small for everything, where leftovers cost nothing.
constexpr std::array<double, kRankings> kPenaltyShares = {1, 0.25, 0};
constexpr double kUnscored = 1e9;  // ranks first visits behind all that were scored
constexpr int kExpansionsPerTick = 64;

// How many partial walks of a level the scorer sees: in loop mazes, 6 of 50 serve as well as all (docs/explorer.md). It
// grows by the root, since a wide beam is to look beyond the network.
int scored_per_level(int width) {
  return static_cast<int>(std::ceil(0.75 * std::sqrt(width)));
}

struct Partial {
  NodeId position;
  std::int64_t trail;  // its last first visit in the list of all kept ones
  double spent;
  double prize;      // of its first visits; 0 where all prizes are 1
  double penalties;  // sum over the unvisited nodes
  std::uint64_t hash;
};

struct Link {
  NodeId node;
  std::int64_t before;  // place of the first visit before it
};

// The same number for the same node, spread over 64 bits [Steele et al. 2014].
std::uint64_t spread(std::uint64_t node) {
  std::uint64_t z = (node + 1) * 0x9e3779b97f4a7c15ULL;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  return z ^ (z >> 31);
}

class Beam {
 public:
  Beam(const Task& task, const BeamOptions& options, FirstVisitScorer* scorer)
      : task_(task),
        view_(task.view()),
        limit_(task.limit()),
        unit_(view_.open().mean_cost()),
        branching_(options.branching),
        most_branches_(kTiesPerBranch * options.branching),
        scorer_(scorer),
        scored_per_level_(scorer == nullptr ? 0 : scored_per_level(options.width)),
        visited_(0),
        visited_sets_(task.ground(), view_.node_count()),
        candidates_(static_cast<std::size_t>(options.width)) {
    Partial root{.position = task.start(), .trail = -1, .spent = 0, .prize = 0, .penalties = 0, .hash = 0};
    if (task_.has_prizes() && view_.total_prize() > 0) {
      worth_ = limit_ / view_.total_prize();
      mean_prize_ = view_.total_prize() / view_.valid_count();
      for (const NodeId node : view_.valid_nodes()) most_prize_ = std::max(most_prize_, task_.prize(node));
    }
    const NodeSetView visited = visited_sets_[0];
    for (const NodeId node : view_.valid_nodes()) {
      if (visited.contains(node)) {
        ++visited_;
        continue;
      }
      root.penalties += leftover_penalty(unvisited_neighbours_up_to_three(view_, visited, node));
    }
    level_.assign(1, root);
    best_ = root;
  }

  Plan run(const Clock& clock) {
    Ticker ticker(clock, kExpansionsPerTick);
    // All partial walks of a level have visited the same number of nodes. So without prizes the cheapest of the last
    // level is the answer.
    for (;;) {
      note_best();
      candidates_.clear();
      if (!expand_level(ticker)) return best_plan(/*complete=*/false);
      if (candidates_.empty()) return best_plan(/*complete=*/true);
      keep_best();
      ++visited_;
    }
  }

 private:
  // Makes the candidates of every partial walk of the level; false where the time is up.
  bool expand_level(Ticker& ticker) {
    const int count = static_cast<int>(level_.size());
    const int scored = std::min(scored_per_level_, count);
    for (int first = 0; first < scored;) {
      const int end = std::min(first + scorer_->most_states(), scored);
      expand_scored(first, end);
      first = end;
      if (ticker.tick(visited_, kExpansionsPerTick)) return false;
    }
    // First the visits that cost 1: they tighten the bounds that end the searches below.
    if (!view_.open().weighted()) {
      for (int parent = scored; parent < count; ++parent) {
        const int degree = view_.open().degree(level_[parent].position);
        if (ticker.tick(visited_, 1 + degree / Ticker::kNodesPerUnit)) return false;
        expand_one_step(parent);
      }
    }
    for (int parent = scored; parent < count; ++parent) {
      if (ticker.tick(visited_, 1 + met_ / Ticker::kNodesPerUnit)) return false;
      met_ = 0;
      expand(parent);
    }
    return true;
  }

  // Adds those of expand()'s candidates that cost 1. REQUIRES: every edge costs 1.
  void expand_one_step(int parent) {
    const Partial& from = level_[parent];
    if (from.spent + 1 > limit_) return;
    const NodeSetView visited = visited_sets_[parent];
    candidates_.begin_parent(parent);
    int branches = 0;
    for (const NodeId node : view_.open_neighbours(from.position)) {
      if (visited.contains(node) || from.spent + 1 + task_.cost_to_end(node) > limit_) continue;
      if (++branches > most_branches_) return;
      consider(parent, visited, node, 1);
    }
  }

  void expand(int parent) {
    const Partial& from = level_[parent];
    const Exploration state = exploration(parent);
    const double considered_cost = view_.open().weighted() ? -1 : 1;  // what costs as much was considered before
    int branches = 0;
    double last_cost = 0;
    candidates_.begin_parent(parent);
    double most_useful = most_useful_cost(from);
    const auto visit = [&](NodeId node, double cost) {
      if (branches >= most_branches_ || (branches >= branching_ && cost > last_cost)) {
        dropped_ = true;
        return false;
      }
      ++branches;
      last_cost = cost;
      if (cost == considered_cost) return true;
      consider(parent, state.ground(), node, cost);
      most_useful = most_useful_cost(from);
      return true;
    };
    const auto meet = [&](double cost) {
      ++met_;
      dropped_ = dropped_ || cost > most_useful;
      return cost <= most_useful;
    };
    state.for_first_visits(nearest_, visit, meet);
  }

  // Adds a first visit that is not scored to the candidates, unless it cannot be kept.
  void consider(int parent, const NodeSetView& visited, NodeId node, double cost) {
    const Partial& from = level_[parent];
    const double spent = from.spent + cost;
    const double to_rank = priced(from, node, spent);
    // The node's own penalty goes, others can only rise: most candidates need no closer look.
    const double own = leftover_penalty(unvisited_neighbours_up_to_three(view_, visited, node));
    if (candidates_.is_useless(without_score(to_rank, from.penalties - own))) {
      dropped_ = true;
      return;
    }
    const double penalties = from.penalties + change_of_penalties(view_, visited, node);
    add_candidate(parent, node, spent, penalties, without_score(to_rank, penalties));
  }

  void expand_scored(int first, int end) {
    states_.clear();
    for (int parent = first; parent < end; ++parent) states_.push_back(exploration(parent));
    dropped_ = scorer_->score(states_, scored_) || dropped_;
    for (const auto& [state, visit, score] : scored_) {
      const Partial& from = level_[first + state];
      const double spent = from.spent + visit.cost;
      const double penalties = from.penalties + change_of_penalties(view_, states_[state].ground(), visit.node);
      const double prize = task_.has_prizes() ? (from.prize + task_.prize(visit.node)) / mean_prize_ : 0;
      add_candidate(first + state, visit.node, spent, penalties,
                    by_score(score - prize, priced(from, visit.node, spent), penalties));
    }
  }

  void add_candidate(int parent, NodeId node, double spent, double penalties, const Rankings& rankings) {
    candidates_.add({.parent = parent,
                     .node = node,
                     .spent = spent,
                     .penalties = penalties,
                     .rankings = rankings,
                     .visited_hash = level_[parent].hash ^ spread(node)});
  }

  // The rankings of a beam without a scorer: spent cost and each share of the penalties.
  Rankings by_penalties(double spent, double penalties) const {
    Rankings rankings{};
    for (std::size_t i = 0; i < rankings.size(); ++i) rankings[i] = spent + kPenaltyShares[i] * unit_ * penalties;
    return rankings;
  }

  // The rankings of a beam with one: its score takes the place of the last share.
  Rankings by_score(double score, double spent, double penalties) const {
    const Rankings plain = by_penalties(spent, penalties);
    return {score, plain[0], plain[1]};
  }

  // The rankings of a first visit that no scorer saw.
  Rankings without_score(double spent, double penalties) const {
    return scorer_ == nullptr ? by_penalties(spent, penalties) : by_score(kUnscored + spent / unit_, spent, penalties);
  }

  // A first visit that costs more is behind `width` others by every ranking, however it changes the penalties.
  double most_useful_cost(const Partial& from) const {
    double most = 0;
    const Rankings& worst = candidates_.worst_useful();
    const double spent = from.spent - worth_ * (from.prize + most_prize_);
    const Rankings least = by_penalties(spent, from.penalties - kIsolatedPenalty);
    if (scorer_ == nullptr) {
      for (std::size_t i = 0; i < worst.size(); ++i) most = std::max(most, worst[i] - least[i]);
      return most;
    }
    most = (worst[0] - kUnscored) * unit_ - spent;
    return std::max({most, worst[1] - least[0], worst[2] - least[1]});
  }

  void keep_best() {
    dropped_ = candidates_.keep_best() || dropped_;
    // To the front of the level, for the scorer: its own best, then others that look good without it.
    candidates_.sort(0, 0);
    if (scorer_ != nullptr) candidates_.sort(1, scored_per_level_ - scored_per_level_ / 3);
    next_level_.clear();
    for (const Candidate& candidate : candidates_.all()) {
      trail_.push_back({candidate.node, level_[candidate.parent].trail});
      const double prize = task_.has_prizes() ? level_[candidate.parent].prize + task_.prize(candidate.node) : 0;
      next_level_.push_back({.position = candidate.node,
                             .trail = std::ssize(trail_) - 1,
                             .spent = candidate.spent,
                             .prize = prize,
                             .penalties = candidate.penalties,
                             .hash = candidate.visited_hash});
    }
    visited_sets_.advance(candidates_.all());
    level_.swap(next_level_);
  }

  // Remembers the best partial walk of the level, unless an older one is worth more.
  void note_best() {
    const auto cost = [&](const Partial& partial) { return partial.spent + task_.cost_to_end(partial.position); };
    const auto is_better = [&](const Partial& a, const Partial& b) {
      return a.prize != b.prize ? a.prize > b.prize : cost(a) < cost(b);
    };
    const Partial& level_best = *std::min_element(level_.begin(), level_.end(), is_better);
    if (!task_.has_prizes() || is_better(level_best, best_)) best_ = level_best;
  }

  Plan best_plan(bool complete) {
    std::vector<NodeId> order;
    for (std::int64_t i = best_.trail; i >= 0; i = trail_[i].before) order.push_back(trail_[i].node);
    std::reverse(order.begin(), order.end());
    return plan_of_walk(task_, walk_through(task_, order, nearest_),
                        complete && !dropped_ && view_.open().straight_ways_suffice());
  }

  Exploration exploration(int parent) const {
    return {task_, visited_sets_[parent], visited_, level_[parent].position, limit_ - level_[parent].spent};
  }

  // What rankings count as spent: with prizes, less what those collected are worth.
  double priced(const Partial& from, NodeId node, double spent) const {
    return task_.has_prizes() ? spent - worth_ * (from.prize + task_.prize(node)) : spent;
  }

  const Task& task_;
  const View& view_;
  double limit_;
  double unit_;
  double worth_ = 0;  // of a unit of prize, in units of cost
  double mean_prize_ = 1;
  double most_prize_ = 0;  // of one node
  int branching_;
  int most_branches_;         // among equally near ones
  FirstVisitScorer* scorer_;  // null where partial walks are ranked by penalties
  int scored_per_level_;      // partial walks that the scorer sees, from the front of a level; 0 without one
  bool dropped_ = false;
  int visited_;  // by each partial walk of the level
  int met_ = 0;  // nodes, by the last expansion
  NearestFirst nearest_;

  std::vector<Partial> level_;
  Partial best_{};
  VisitedSets visited_sets_;
  BestStates candidates_;
  std::vector<Link> trail_;
  std::vector<Partial> next_level_;
  std::vector<Exploration> states_;
  std::vector<ScoredVisit> scored_;
};

// The most memory that a beam may need: every level's chain of first visits, two levels of partial walks with their
// rows of bits, and the candidates of each; of a beam with a scorer, as if all were scored.
double bytes_needed(const View& view, const BeamOptions& options, const FirstVisitScorer* scorer) {
  const double nodes = view.valid_count();
  const double scored = scorer == nullptr ? 0 : scorer->most_visits();
  const double branches = std::min(nodes, std::max(1.0 * kTiesPerBranch * options.branching, scored));
  return options.width * (nodes * sizeof(Link) + 2 * (nodes / 8 + sizeof(Partial)) + branches * kCandidateBytes);
}

}  // namespace

bool beam_fits(const View& view, const BeamOptions& options) {
  return bytes_needed(view, options, nullptr) <= kMaxBeamBytes;
}

Plan beam_plan(const Task& task, const BeamOptions& options, const Clock& clock, FirstVisitScorer* scorer) {
  const double bytes = bytes_needed(task.view(), options, scorer);
  if (bytes > kMaxBeamBytes) {
    throw Error({.what = "the beam is too wide for this world",
                 .expected = fmt::format("a width up to {:.0f}", std::floor(kMaxBeamBytes / bytes * options.width)),
                 .got = fmt::format("{}", options.width),
                 .where = task.view().name()});
  }
  return Beam(task, options, scorer).run(clock);
}

Plan BeamPlanner::search_once(const Task& task, const BeamOptions& options, const Clock& clock) {
  Plan best = beam_plan(task, options, clock);
  if (scorer_ == nullptr || best.optimal) return best;
  return better_of(std::move(best), beam_plan(task, options, clock, scorer_.get()));
}

Plan BeamPlanner::search_until(const Task& task, const Clock& clock) {
  const auto fits = [&](const BeamOptions& options) {
    return options.width <= kMaxBeamWidth && bytes_needed(task.view(), options, scorer_.get()) <= kMaxBeamBytes;
  };
  Plan best = search_once(task, options_, clock);
  if (!clock.has_deadline()) return best;
  if (other_ != nullptr && !best.optimal) best = better_of(std::move(best), other_->plan(task, clock));
  // Width and branching each grow while memory allows.
  for (BeamOptions wider = options_; !best.optimal && !clock.passed();) {
    const BeamOptions before = wider;
    wider.branching = std::min(wider.branching, task.view().valid_count()) * 2;
    if (!fits(wider)) wider.branching = before.branching;
    wider.width *= 2;
    if (!fits(wider)) wider.width = before.width;
    const bool branches_more = wider.branching > before.branching && before.branching < task.view().valid_count();
    if (wider.width == before.width && !branches_more) break;
    best = better_of(std::move(best), search_once(task, wider, clock));
  }
  return best;
}

Plan BeamPlanner::plan(const Task& task, const Clock& clock) {
  return plan_by_deadline(task, clock, [&](const Clock& until) { return search_until(task, until); });
}

}  // namespace graphdrl
