#include "graphdrl/env/episode.h"

#include <fmt/format.h>

#include <algorithm>

#include "graphdrl/base/error.h"

namespace graphdrl {
namespace {

// A start from which the end is in reach: the end itself.
NodeId any_start(const World& world, const End& end) {
  const NodeId start = world.valid_nodes().front();
  const NodeId at = end.of(start);
  return at >= 0 && at < world.node_count() && !world.is_blocked(at) ? at : start;
}

}  // namespace

Episode::Episode(const World& world, const Task& task, const EpisodeOptions& options)
    : grid_(options.action_space == ActionSpace::kDirections && world.is_grid() ? &world.view().grid() : nullptr),
      visits_(world.node_count()),
      most_free_moves_(kFreeMovesPerNode * std::int64_t{world.node_count()}),
      visited_(world.node_count()),
      options_(options),
      task_(task),
      world_(world),
      asked_(task) {
  if (options.action_space == ActionSpace::kDirections && (grid_ == nullptr || !options.reveal.all())) {
    throw Error({.what = "directions need a grid map that is known", .where = world.name()});
  }
  if (options.believed != nullptr && options.score == Score::kSeen) {
    throw Error({.what = "an old map goes with the score visited", .got = "seen", .where = world.name()});
  }
  reset(task.start());
}

Episode::Episode(const World& world, const EpisodeOptions& options)
    : Episode(world, Task(world, any_start(world, options.end), options.budget, options.end), options) {}

void Episode::reset(NodeId start, std::uint64_t number) {
  if (options_.reveal.all()) {
    task_.start_at(start);
    std::fill(visits_.begin(), visits_.end(), 0);
    visited_.clear();
    visited_.insert(start);
  } else {
    asked_.start_at(start);
    begin_hidden(number);
    start = task_.start();
  }
  walk_.assign(1, start);
  walk_hash_ = extended_walk_hash(kEmptyWalkHash, start);
  position_ = start;
  visits_[start] = 1;
  visited_count_ = 1;
  prize_ = view().prize(start);
  spent_ = 0;
  free_moves_ = 0;
  settle_end();
}

void Episode::begin_hidden(std::uint64_t number) {
  const std::uint64_t seed = derive_seed(options_.numbers_seed, number);
  hidden_ =
      std::make_shared<HiddenWorld>(world_, options_.reveal, options_.score, asked_.start(), seed, options_.believed);
  const NodeId start = hidden_->known_as(asked_.start());
  task_ = asked_.ends_anywhere() ? asked_.on(hidden_->view(), start, kNoNode, nullptr)
                                 : asked_.on(hidden_->view(), start, start, hidden_->discovery().keep_costs_to(start));
  visits_.assign(view().node_count(), 0);
}

Episode Episode::fork() const {
  Episode copy = *this;
  if (!hidden()) return copy;
  copy.hidden_ = std::make_shared<HiddenWorld>(*hidden_);
  copy.task_ = asked_.on(copy.hidden_->view(), task_.start(), task_.end(), copy.hidden_->discovery().costs_kept());
  return copy;
}

std::vector<NodeId> Episode::walk_in_world() const {
  std::vector<NodeId> walk(walk_.size());
  std::ranges::transform(walk_, walk.begin(), [&](NodeId node) { return in_world(node); });
  return walk;
}

// An end that is a node becomes the end once the walk knows it and can pay for the way there.
void Episode::settle_end() {
  if (!hidden() || asked_.ends_anywhere()) return;
  const NodeId end = hidden_->known_as(asked_.end());
  if (end == kNoNode || end == task_.end()) return;
  const auto costs = hidden_->discovery().keep_costs_to(end);
  if ((*costs)[position_] <= task_.limit() - spent_) {
    task_ = asked_.on(view(), task_.start(), end, costs);
  } else {
    task_ = asked_.on(view(), task_.start(), task_.end(), hidden_->discovery().keep_costs_to(task_.end()));
  }
}

StepResult Episode::step(int action) {
  if (grid_ != nullptr) return enter(grid_->direction_target(position_, action), 1.0);
  return enter(view().open_neighbours(position_)[action], view().open().cost(position_, action));
}

bool Episode::can_stay() const {
  return view().open().mean_cost() + task_.cost_to_end(position_) <= task_.limit() - spent_;
}

StepResult Episode::stay() {
  return enter(position_, view().open().mean_cost());
}

StepResult Episode::enter(NodeId next, double cost) {
  const bool blocked = next == position_;
  const std::uint32_t visits_before = visits_[next]++;
  const bool first_visit = visits_before == 0;
  position_ = next;
  walk_.push_back(next);
  walk_hash_ = extended_walk_hash(walk_hash_, next);
  const double spent_before = spent_;
  spent_ += cost;
  free_moves_ = first_visit || spent_ > spent_before ? 0 : free_moves_ + 1;
  const double gained = first_visit ? visit_first() : 0;
  return {.reward = reward_of(blocked, visits_before, gained), .blocked = blocked, .first_visit = first_visit};
}

// The first visit of the position. Returns what it gains of what is counted.
double Episode::visit_first() {
  ++visited_count_;
  prize_ += view().prize(position_);
  if (!hidden()) {
    visited_.insert(position_);
    return view().prize(position_);
  }
  const double seen_before = view().total_prize();
  hidden_->visit(position_);
  visits_.resize(view().node_count());
  settle_end();
  return counts_seen() ? view().total_prize() - seen_before : view().prize(position_);
}

double Episode::reward_of(bool blocked, std::uint32_t visits_before, double gained) const {
  const bool first_visit = visits_before == 0;
  const double bonus = first_visit && terminal() ? kFullCoverageBonus : 0.0;
  if (options_.reward == RewardKind::kCoverageGain) {
    return world_.total_prize() > 0 ? gained / world_.total_prize() + bonus : bonus;
  }
  if (first_visit) return kFirstVisitReward + bonus;
  if (!blocked) return kRevisitReward * visits_before;
  return kBlockedReward + (options_.punish_blocked_by_visits ? kRevisitReward * visits_before : 0.0);
}

bool Episode::done() const {
  if (terminal() || too_long()) return true;
  if (grid_ != nullptr && task_.ends_anywhere()) return task_.limit() - spent_ < 1;
  const Observation now = observation();
  for (int action = 0; action < now.action_count(); ++action) {
    if (now.affordable(action)) return false;
  }
  return true;
}

Observation Episode::observation() const {
  return {.task = &task_,
          .action_space = options_.action_space,
          .position = position_,
          .visits = visits_,
          .ground_nodes = hidden() ? &hidden_->ground() : &visited_,
          .walk = walk_,
          .walk_hash = walk_hash_,
          .visited_count = visited_count_,
          .spent = spent_,
          .spendable = task_.limit() - spent_};
}

void follow_walk(Episode& episode, std::span<const NodeId> walk,
                 const std::function<void(const Observation&)>& at_node) {
  if (walk.empty()) throw Error({.what = "the walk is empty", .expected = "at least a start"});
  episode.reset(walk.front());
  if (at_node) at_node(episode.observation());
  for (std::size_t i = 1; i < walk.size(); ++i) {
    const int action = episode.observation().action_to(walk[i]);
    if (action == kNoAction) {
      throw Error({.what = "no such step in the walk",
                   .expected = fmt::format("a valid neighbour of node {}, or the node again for a blocked move",
                                           episode.position()),
                   .got = fmt::format("{} at place {}", walk[i], i),
                   .where = episode.world().name()});
    }
    if (!episode.observation().affordable(action)) {
      throw Error({.what = "the walk costs more than the budget",
                   .got = fmt::format("step {} from {} to {}", i, episode.position(), walk[i]),
                   .where = episode.world().name()});
    }
    episode.step(action);
    if (at_node) at_node(episode.observation());
  }
}

}  // namespace graphdrl
