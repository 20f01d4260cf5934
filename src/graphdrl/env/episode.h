// The decision process of the paper, section 1: one walk through a world under a budget.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "graphdrl/env/discovery.h"
#include "graphdrl/env/observation.h"

namespace graphdrl {

enum class RewardKind {
  kVisitPenalty,  // [paper, eq. 3]
  kCoverageGain,  // [paper, eq. 2]; where there are prizes, their share of all; where what is seen counts, of that
};

// The defaults are the paper's.
struct EpisodeOptions {
  double budget = 25;         // in units of cost
  End end = End::anywhere();  // moves after which it cannot be reached within the budget are masked
  ActionSpace action_space = ActionSpace::kDirections;
  RewardKind reward = RewardKind::kVisitPenalty;
  // Differs from the paper: its author's code ends an episode at full coverage, with a bonus …
  bool end_at_full_coverage = false;
  // … and punishes a blocked move by a further 0.1 per visit of the node before it.
  bool punish_blocked_by_visits = false;
  Reveal reveal = {};  // what is not known beforehand is explored by neighbours
  Score score = Score::kVisited;
  std::shared_ptr<const BelievedMap> believed = {};  // of an unknown world; null without an old map
  std::uint64_t numbers_seed = 1;                    // of the numbers by which an unknown world's nodes are known
};

inline constexpr double kFirstVisitReward = 0.1;   // eq. 3
inline constexpr double kRevisitReward = -0.1;     // eq. 3, times the visits before this one
inline constexpr double kBlockedReward = -0.5;     // eq. 3
inline constexpr double kFullCoverageBonus = 1.0;  // the author's code; with end_at_full_coverage

// A way to an unvisited node, or to the end, takes fewer moves than there are nodes. Ten times as many leave room for
// policies that look for one at random.
inline constexpr int kFreeMovesPerNode = 10;

struct StepResult {
  double reward;
  bool blocked;      // the move led into an obstacle or off the map
  bool first_visit;  // the node entered was unvisited
};

// One walk. Not thread safe. On a known map step() is O(1) and allocates nothing but the growing walk.
//
// On an unknown map [EpisodeOptions::reveal] view, task, observations and walk know nodes by the numbers of their
// discovery; in_world() gives those of the world. What is owed to an end that is a node is the way back to the start,
// until that node has been seen and what is left pays for the way there. Plain copies share what is known: fork() or
// reset() them.
class Episode {
 public:
  // A walk of a task, begun at its start. Budget and end are the task's, not the options'. Throws Error on directions
  // in a world that is no grid, or not known; on a reveal that the world does not have; on an old map where nodes seen
  // count: plans visit.
  Episode(const World& world, const Task& task, const EpisodeOptions& options = {});
  // The same, not begun: the task is made with each start. Throws Error on a bad budget or end, too.
  Episode(const World& world, const EpisodeOptions& options);

  // Begins a new walk. Throws Error as a task's start_at(). number: of the walk; an unknown world's nodes get other
  // numbers in each.
  void reset(NodeId start, std::uint64_t number = 0);

  // A copy that goes on alone.
  Episode fork() const;

  // REQUIRES: !done(), 0 <= action < observation().action_count(), and the action can be paid for.
  StepResult step(int action);

  // Where actions are neighbours, what a blocked direction is on a grid: pays for an edge of mean cost and stays.
  // REQUIRES: can_stay().
  StepResult stay();
  bool can_stay() const;  // what is left pays for it

  // The budget is spent, or the state is terminal, or there is nowhere to go: a walk that must end at a node is there
  // then. Or the walk is too_long(), wherever it is.
  bool done() const;

  // The walk has kMaxSteps steps, or goes round for nothing: its last kFreeMovesPerNode · N moves cost nothing and
  // visited nothing new. Only done() heeds this: a walk that is given may be followed farther.
  bool too_long() const { return std::ssize(walk_) > kMaxSteps || free_moves_ >= most_free_moves_; }

  // Reached full coverage with end_at_full_coverage: nothing follows. A spent budget is no terminal state, only a
  // truncation: eq. 5 bootstraps there.
  bool terminal() const { return options_.end_at_full_coverage && visited_count_ == world_.valid_count(); }

  const World& world() const { return world_; }
  const Task& task() const { return task_; }
  const View& view() const { return task_.view(); }  // what policies may see of the world
  Observation observation() const;
  NodeId position() const { return position_; }
  const std::vector<std::uint32_t>& visits() const { return visits_; }
  const std::vector<NodeId>& walk() const { return walk_; }
  int visited_count() const { return visited_count_; }
  double coverage() const { return static_cast<double>(visited_count_) / world_.valid_count(); }  // eq. 1
  double prize() const { return counts_seen() ? view().total_prize() : prize_; }  // of nodes visited, or seen
  double spent() const { return spent_; }                                         // units of cost

  bool hidden() const { return hidden_ != nullptr; }  // the map was not known beforehand
  // A node's number in the world; kNoNode stays.
  NodeId in_world(NodeId node) const { return hidden() && node != kNoNode ? hidden_->in_world(node) : node; }
  std::vector<NodeId> walk_in_world() const;

 private:
  bool counts_seen() const { return hidden() && options_.score == Score::kSeen; }
  void begin_hidden(std::uint64_t number);
  void settle_end();
  StepResult enter(NodeId next, double cost);
  double visit_first();
  double reward_of(bool blocked, std::uint32_t visits_before, double gained) const;

  // What every step touches comes first, up to most_free_moves_: it then lies in few lines of the cache.
  std::shared_ptr<HiddenWorld> hidden_;  // null where the map is known
  const KnownGrid* grid_;                // of directions; else null
  NodeId position_ = kNoNode;
  int visited_count_ = 0;
  std::vector<std::uint32_t> visits_;  // [N]
  std::vector<NodeId> walk_;
  std::uint64_t walk_hash_ = 0;
  double prize_ = 0;
  double spent_ = 0;
  std::int64_t free_moves_ = 0;  // since the last first visit or the last cost
  std::int64_t most_free_moves_;
  NodeSet visited_;  // of a known map
  EpisodeOptions options_;
  Task task_;  // what was asked for, on what is known
  World world_;
  Task asked_;  // in the world's numbers
};

// Leads a fresh episode along a walk of node ids, the start first; a repeated node is a blocked move. Calls `at_node`
// at every one, the start included. Throws Error where a node is no valid node or not one step from the one before it,
// or the budget does not last.
void follow_walk(Episode& episode, std::span<const NodeId> walk,
                 const std::function<void(const Observation&)>& at_node = {});

}  // namespace graphdrl
