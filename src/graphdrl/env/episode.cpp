#include "graphdrl/env/episode.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "graphdrl/base/error.h"

namespace graphdrl {

Episode::Episode(const World& world, const EpisodeOptions& options)
    : world_(&world), options_(options), visits_(world.graph().node_count()) {
  if (!(options.budget >= 0) || !std::isfinite(options.budget)) {
    throw Error({.what = "bad budget", .expected = "a number from 0 up", .got = fmt::format("{}", options.budget)});
  }
  if (options.action_space == ActionSpace::kDirections && !world.is_grid()) {
    throw Error({.what = "directions need a grid map", .where = world.name()});
  }
}

void Episode::reset(NodeId start) {
  if (start < 0 || start >= world_->graph().node_count()) {
    throw Error({.what = "start outside the world",
                 .expected = fmt::format("a node from 0 to {}", world_->graph().node_count() - 1),
                 .got = fmt::format("{}", start),
                 .where = world_->name()});
  }
  if (world_->is_blocked(start)) {
    throw Error({.what = "start on an obstacle",
                 .expected = "a valid node",
                 .got = fmt::format("node {}", start),
                 .where = world_->name()});
  }
  std::fill(visits_.begin(), visits_.end(), 0);
  walk_.assign(1, start);
  position_ = start;
  visits_[start] = 1;
  visited_count_ = 1;
  spent_ = 0;
}

StepResult Episode::step(int action) {
  const NodeId next = observation().target(action);
  const double cost = observation().cost(action);
  const bool blocked = next == position_;
  const std::uint32_t visits_before = visits_[next]++;
  const bool first_visit = visits_before == 0;
  visited_count_ += first_visit;
  position_ = next;
  walk_.push_back(next);
  spent_ += cost;
  return {.reward = reward_of(blocked, visits_before), .blocked = blocked, .first_visit = first_visit};
}

double Episode::reward_of(bool blocked, std::uint32_t visits_before) const {
  const bool first_visit = visits_before == 0;
  const double bonus = first_visit && terminal() ? kFullCoverageBonus : 0.0;
  if (options_.reward == RewardKind::kCoverageGain) return first_visit ? 1.0 / world_->valid_count() + bonus : 0.0;
  if (first_visit) return kFirstVisitReward + bonus;
  if (!blocked) return kRevisitReward * visits_before;
  return kBlockedReward + (options_.punish_blocked_by_visits ? kRevisitReward * visits_before : 0.0);
}

bool Episode::done() const {
  if (terminal()) return true;
  const double left = spending_limit(options_.budget) - spent_;
  if (options_.action_space == ActionSpace::kDirections) return left < 1;
  const Graph& open = world_->open();
  for (int i = 0; i < open.degree(position_); ++i) {
    if (open.cost(position_, i) <= left) return false;
  }
  return true;
}

Observation Episode::observation() const {
  return {.world = world_,
          .action_space = options_.action_space,
          .position = position_,
          .visits = visits_,
          .walk = walk_,
          .visited_count = visited_count_,
          .budget_left = options_.budget - spent_,
          .spendable = spending_limit(options_.budget) - spent_};
}

}  // namespace graphdrl
