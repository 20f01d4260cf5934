#include "graphdrl/live/live_exploration.h"

#include <algorithm>
#include <utility>
#include <variant>

#include "graphdrl/base/error.h"
#include "graphdrl/live/live_states.h"
#include "graphdrl/planners/registry.h"

namespace graphdrl {
namespace {

// Of a way: first visits where something is known beforehand of what they show, and nodes in all.
constexpr int kMostFirstVisits = 32;
constexpr std::size_t kLongestWay = 10'000;

PolicySpec policy_that_explores(const std::string& name) {
  PolicySpec spec = parse_policy(name);
  if (spec.kind == PolicyKind::kExact || spec.kind == PolicyKind::kRandom) {
    throw Error({.what = "the policy does not explore what it does not know", .got = in_quotes(name, 200)});
  }
  if (std::holds_alternative<PaperParameters>(spec.trained)) {
    throw Error({.what = "the paper's networks walk on grids", .got = in_quotes(name, 200)});
  }
  return spec;
}

}  // namespace

LiveExploration::LiveExploration(LiveOptions options) : options_(std::move(options)) {
  if (options_.budget < kNoLimit) check_amount(options_.budget, "budget");
  if (options_.reset_cost) check_amount(*options_.reset_cost, "reset_cost");
  if (!options_.policy.empty() && options_.policy != kNovelty) policy_that_explores(options_.policy);
}

// What can be said once it is known what is explored.
void LiveExploration::begin(const LiveObservation& first) {
  std::unique_ptr<LiveMap> map = make_live_map(options_, first);
  const std::string name = options_.policy.empty() ? map->default_policy() : options_.policy;
  std::unique_ptr<Policy> policy = map->own_policy(name);
  if (policy == nullptr) {
    const PolicySpec spec = policy_that_explores(name);
    policy = make_online_policy(spec, options_.seed);
    stops_ = spec.kind != PolicyKind::kRandomWalk;
  }
  map->check(first);
  options_.policy = name;
  policy_ = std::move(policy);
  map_ = std::move(map);
}

void LiveExploration::observe(const LiveObservation& seen) {
  if (seen.cost) check_amount(*seen.cost, "cost");
  if (map_ == nullptr) {
    begin(seen);
  } else {
    map_->check(seen);
  }
  step_.reset();
  const LiveMap::Moved moved = map_->take(seen);
  spent_ += moved.cost;
  visits_.resize(map_->view().node_count());
  if (moved.way.empty()) ++visits_[position_];
  const int seen_before = seen_after_.empty() ? 0 : seen_after_.back();
  for (const NodeId node : moved.way) {
    enter(node);
    seen_after_.push_back(seen_before);
  }
  seen_after_.back() = map_->seen_count();
  if (task_) return;
  task_.emplace(map_->view(), position_, options_.budget, End::anywhere());
  if (!options_.end_at_start) return;
  way_home_ = map_->discovery().keep_costs_to(position_);
  if (options_.budget < kNoLimit) task_ = task_->on(map_->view(), position_, position_, way_home_);
}

void LiveExploration::enter(NodeId node) {
  position_ = node;
  ++visits_[node];
  walk_.push_back(node);
  walk_hash_ = extended_walk_hash(walk_hash_, node);
}

Observation LiveExploration::observation(const NodeSet& ground, int visited_count) const {
  return {.task = &*task_,
          .action_space = ActionSpace::kNeighbours,
          .position = position_,
          .visits = visits_,
          .ground_nodes = &ground,
          .walk = walk_,
          .walk_hash = walk_hash_,
          .visited_count = visited_count,
          .spent = spent_,
          .spendable = map_->view().spending_limit(options_.budget) - spent_};
}

const LiveStep& LiveExploration::next() {
  if (step_) return *step_;
  std::optional<LiveStep> step;
  while (!step && !ends_) {
    step = explore();
    if (!step && !map_->retry()) break;
  }
  if (!step) step = go_home();
  return step_.emplace(step ? *std::move(step) : done_now());
}

void LiveExploration::next_was(const LiveStep& step) {
  if (step.kind != LiveStep::Kind::kDone) map_->told(step);
  step_ = step;
}

// A step, or a way, of nodes that are chosen one by one, as if it had gone where it is sent. A way ends where more
// will be seen. Empty where it would not go on.
std::optional<LiveStep> LiveExploration::go(const std::function<NodeId(const Observation&)>& choose) {
  visits_.resize(map_->view().node_count());
  std::vector<NodeId> way;
  NodeSet ground;  // with what the way visits
  int visited_count = map_->visited_count();
  const auto now = [&] { return observation(ground.empty() ? map_->ground() : ground, visited_count); };
  const NodeId position = position_;
  const std::uint64_t hash = walk_hash_;
  const std::size_t walked = walk_.size();
  const double spent = spent_;
  for (int first_visits = 0; way.size() < kLongestWay;) {
    const NodeId next = choose(now());
    if (next == kNoNode) break;
    way.push_back(next);
    if (!map_->goes_far() || !stops_) break;
    if (!now().ground().contains(next)) {
      if (map_->view().is_frontier(next) || ++first_visits == kMostFirstVisits) break;
      if (ground.empty()) ground = map_->ground();
      ground.insert(next);
      ++visited_count;
    }
    spent_ += now().cost(now().action_to(next));
    enter(next);
  }
  for (; walk_.size() > walked; walk_.pop_back()) --visits_[walk_.back()];
  position_ = position;
  walk_hash_ = hash;
  spent_ = spent;
  if (way.empty() || map_->given_up(way.back())) return std::nullopt;
  return map_->tell(way);
}

// As the policy chooses. Empty where it would not go on.
std::optional<LiveStep> LiveExploration::explore() {
  const Clock clock = Clock().at_most(options_.think_s);
  return go([&](const Observation& now) {
    if (now.action_count() == 0) return kNoNode;
    if (must_go_home(now)) return next_home(now);
    if (now.spendable < 0 || nothing_left(now)) return kNoNode;
    int action = kStop;
    policy_->act({&now, 1}, {&action, 1}, clock);
    return action == kStop ? kNoNode : now.target(action);
  });
}

// By the cheapest way. Empty where it need not end there, is there, or knows no way.
std::optional<LiveStep> LiveExploration::go_home() {
  return go([&](const Observation& now) { return next_home(now); });
}

// The first node of the cheapest way to the start.
NodeId LiveExploration::next_home(const Observation& now) const {
  if (way_home_ == nullptr || now.position == walk_.front() || (*way_home_)[now.position] == kNoLimit) return kNoNode;
  NodeId next = kNoNode;
  double least = kNoLimit;
  for (int action = 0; action < now.action_count(); ++action) {
    const double cost = now.cost(action) + (*way_home_)[now.target(action)];
    if (cost >= least) continue;
    next = now.target(action);
    least = cost;
  }
  return next;
}

// Steps cost more than was said, so that what is left does not pay for the way home any more.
bool LiveExploration::must_go_home(const Observation& now) const {
  return way_home_ != nullptr && (*way_home_)[now.position] < kNoLimit && (*way_home_)[now.position] > now.spendable;
}

// Asked only of policies that would not stop by themselves: those that walk on, and those that owe a way home that is
// not known.
bool LiveExploration::nothing_left(const Observation& now) {
  if (stops_ && task_->cost_to_end(now.position) < kNoLimit) return false;
  return Exploration(now, now.ground()).nearest_first_visit(look_).node == kNoNode;
}

// Why there is no next step.
LiveStep LiveExploration::done_now() const {
  LiveStep step;
  if (!map_->is_left()) return step;
  step.done = LiveStep::Done::kUnreachable;
  // Whether a way leads there for more than is left.
  NearestFirst().run(map_->view().open(), position_, kNoLimit, [&](NodeId node, double) {
    if (map_->ground().contains(node)) return NearestFirst::Next::kThrough;
    if (task_->cost_to_end(node) < kNoLimit) step.done = LiveStep::Done::kBudget;
    return NearestFirst::Next::kPast;
  });
  return step;
}

LiveReport LiveExploration::report() const {
  LiveReport report;
  report.cost = spent_;
  if (map_ != nullptr) map_->add_to(report);
  return report;
}

Answer LiveExploration::answer(const std::string& name) const {
  LiveMap::Picture picture = map_->picture(name, walk_, seen_after_);
  picture.plan.cost = spent_ / picture.unit;
  const NodeId start = picture.plan.walk.front();
  // The world may have no way to the end any more, and what was spent may be more than the budget.
  Answer answer{.world = picture.world,
                .task = Task(picture.world, start, std::max(options_.budget, spent_) / picture.unit),
                .policy = options_.policy,
                .plan = std::move(picture.plan),
                .reveal = picture.reveal,
                .score = picture.score,
                .until_covered = options_.budget == kNoLimit};
  answer.discovered.nodes = std::move(picture.seen);
  answer.discovered.after_step = std::move(picture.after);
  return answer;
}

}  // namespace graphdrl
