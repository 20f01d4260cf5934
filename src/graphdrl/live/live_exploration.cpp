#include "graphdrl/live/live_exploration.h"

#include <algorithm>
#include <cmath>
#include <unordered_set>
#include <utility>
#include <variant>

#include "graphdrl/base/error.h"
#include "graphdrl/planners/registry.h"

namespace graphdrl {
namespace {

constexpr const char* kNovelty = "novelty";

constexpr double kMostAmount = 1e15;  // sums of so large ones are still exact to a tenth

void check_amount(double amount, const char* field) {
  if (amount >= 0 && amount <= kMostAmount) return;
  throw FieldError(field, {.what = "bad amount", .expected = "a number from 0 to 1e15", .got = decimal(amount)});
}

void check_name(const std::string& name, const char* field) {
  if (name.empty()) throw FieldError(field, {.what = "a name is empty"});
}

ErrorParts at_field(ErrorParts parts, const std::string& field) {
  parts.where = field;
  return parts;
}

}  // namespace

FieldError::FieldError(std::string field, ErrorParts parts)
    : Error(at_field(std::move(parts), field)), field_(std::move(field)) {}

const char* name_of(LiveStep::Done done) {
  switch (done) {
    case LiveStep::Done::kCovered:
      return "covered";
    case LiveStep::Done::kBudget:
      return "budget";
    case LiveStep::Done::kUnreachable:
      return "unreachable";
    case LiveStep::Done::kClosed:
      break;
  }
  return "closed";
}

LiveExploration::LiveExploration(LiveOptions options)
    : options_(std::move(options)), graph_(options_.cover, options_.reset_cost, options_.end_at_start) {
  if (options_.budget < kNoLimit) check_amount(options_.budget, "budget");
  if (options_.reset_cost) check_amount(*options_.reset_cost, "reset_cost");
  if (options_.policy.empty() || options_.policy == kNovelty) {
    options_.policy = kNovelty;
    auto novelty = std::make_unique<NoveltyPolicy>(graph_);
    novelty_ = novelty.get();
    policy_ = std::move(novelty);
    return;
  }
  const PolicySpec spec = parse_policy(options_.policy);
  if (spec.kind == PolicyKind::kExact || spec.kind == PolicyKind::kRandom) {
    throw Error({.what = "the policy does not explore what it does not know", .got = in_quotes(options_.policy, 200)});
  }
  if (std::holds_alternative<PaperParameters>(spec.trained)) {
    throw Error({.what = "the paper's networks walk on grids", .got = in_quotes(options_.policy, 200)});
  }
  policy_ = make_online_policy(spec, options_.seed);
  stops_ = spec.kind != PolicyKind::kRandomWalk;
}

LiveExploration::~LiveExploration() = default;

void LiveExploration::check(const LiveObservation& seen) const {
  check_name(seen.state, "state");
  if (seen.cost) check_amount(*seen.cost, "cost");
  check_amount(seen.prize, "prize");
  if (seen.failed && !pending_) throw FieldError("failed", {.what = "nothing was asked for that could fail"});
  if (!seen.moves) return;
  std::unordered_set<std::string_view> names;
  for (const OfferedMove& move : *seen.moves) {
    check_name(move.name, "moves");
    if (move.to) check_name(*move.to, "moves");
    if (move.cost) check_amount(*move.cost, "moves");
    if (!names.insert(move.name).second) {
      throw FieldError("moves", {.what = "a move stands there twice", .got = in_quotes(move.name)});
    }
  }
}

void LiveExploration::observe(const LiveObservation& seen) {
  check(seen);
  graph_.begin_visit();
  const std::optional<Pending> step = std::exchange(pending_, std::nullopt);
  step_.reset();
  if (step) {
    settle(*step, seen);
  } else if (seen.cost) {
    spent_ += *seen.cost;
    graph_.change();
  }
  const std::int32_t state = graph_.enter(seen.state, seen.prize, kNoNode);
  if (seen.moves) graph_.offer(state, *seen.moves);
  graph_.discovery().close(graph_.node(state));
  stand_at(state);
}

// What became of a step.
void LiveExploration::settle(const Pending& step, const LiveObservation& seen) {
  ++so_far_.steps;
  const double cost = seen.cost.value_or(step.cost);
  spent_ += cost;
  const bool reset = step.move == StateGraph::kReset;
  const std::int32_t known = graph_.find(seen.state);
  if (step.expects >= 0 && step.expects != known && !seen.failed) {
    ++so_far_.surprise_count;
    if (so_far_.surprises.size() < kMostSurprisesKept) {
      so_far_.surprises.push_back({.step = so_far_.steps,
                                   .state = graph_.name(step.state),
                                   .move = reset ? "" : graph_.move_name(graph_.moves(step.state)[step.move].name),
                                   .expected = graph_.name(step.expects),
                                   .got = seen.state});
    }
  }
  if (cost != step.cost || seen.failed) graph_.change();  // policies counted on other sums
  if (reset) return settle_reset(seen, cost);
  if (seen.failed) return graph_.failed(step.state, step.move);
  const StateMove move = graph_.moves(step.state)[step.move];
  const bool is_new = known < 0 || !graph_.visited(known);
  // A state not heard of takes the number that the next one has.
  if (novelty_ != nullptr && !move.tried) {
    novelty_->learn(step.state, step.move, known < 0 ? graph_.state_count() : known, is_new);
  }
  const std::int32_t state = graph_.enter(seen.state, seen.prize, known < 0 ? move.untried_node : kNoNode);
  graph_.done(step.state, step.move, state, cost);
}

void LiveExploration::settle_reset(const LiveObservation& seen, double cost) {
  if (!seen.failed) {
    reset_failures_ = 0;
    ++so_far_.resets;
    return graph_.reset_done(graph_.enter(seen.state, seen.prize, kNoNode), cost);
  }
  graph_.change();
  if (++reset_failures_ >= StateGraph::kMostFailures) graph_.give_up_resets();
}

void LiveExploration::stand_at(std::int32_t state) {
  const NodeId node = graph_.node(state);
  position_ = state;
  visits_.resize(graph_.view().node_count());
  ++visits_[node];
  if (walk_.empty() || walk_.back() != node) {
    walk_.push_back(node);
    walk_hash_ = extended_walk_hash(walk_hash_, node);
    seen_after_.push_back(0);
  }
  while (std::ssize(seen_) < graph_.state_count()) seen_.push_back(graph_.node(static_cast<int>(seen_.size())));
  seen_after_.back() = static_cast<int>(seen_.size());
  if (task_) return;
  task_.emplace(graph_.view(), node, options_.budget, End::anywhere());
  if (!options_.end_at_start) return;
  way_home_ = graph_.discovery().keep_costs_to(node);
  if (options_.budget < kNoLimit) task_ = task_->on(graph_.view(), node, node, way_home_);
}

Observation LiveExploration::observation() const {
  return {.task = &*task_,
          .action_space = ActionSpace::kNeighbours,
          .position = graph_.node(position_),
          .visits = visits_,
          .ground_nodes = &graph_.ground(),
          .walk = walk_,
          .walk_hash = walk_hash_,
          .visited_count = graph_.visited_count(),
          .spent = spent_,
          .spendable = graph_.view().spending_limit(options_.budget) - spent_};
}

const LiveStep& LiveExploration::next() {
  if (step_) return *step_;
  std::optional<LiveStep> step = choose();
  while (!step && graph_.retry()) step = choose();
  if (!step) step = step_home();
  return step_.emplace(step ? *std::move(step) : done_now());
}

// Empty where the policy would not go on.
std::optional<LiveStep> LiveExploration::choose() {
  visits_.resize(graph_.view().node_count());
  const Observation now = observation();
  if (now.action_count() == 0) return std::nullopt;
  if (must_go_home(now)) return step_home();
  if (nothing_left(now)) return std::nullopt;
  int action = kStop;
  policy_->act({&now, 1}, {&action, 1}, Clock().at_most(options_.think_s));
  if (action == kStop) return std::nullopt;
  return tell(graph_.move_to(position_, now.target(action)));
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

// The first step of the cheapest way to the first state. Empty where it need not end there, is there, or knows no way.
std::optional<LiveStep> LiveExploration::step_home() {
  const Observation now = observation();
  if (way_home_ == nullptr || now.position == walk_.front() || (*way_home_)[now.position] == kNoLimit) {
    return std::nullopt;
  }
  NodeId next = kNoNode;
  double least = kNoLimit;
  for (int action = 0; action < now.action_count(); ++action) {
    const double cost = now.cost(action) + (*way_home_)[now.target(action)];
    if (cost >= least) continue;
    next = now.target(action);
    least = cost;
  }
  return tell(graph_.move_to(position_, next));
}

LiveStep LiveExploration::tell(std::int32_t move) {
  if (move == StateGraph::kReset) {
    pending_ = Pending{.state = position_, .move = move, .expects = graph_.reset_target(), .cost = graph_.reset_cost()};
    return {.kind = LiveStep::Kind::kReset, .expects = graph_.name(graph_.reset_target())};
  }
  const StateMove& told = graph_.moves(position_)[move];
  pending_ = Pending{.state = position_, .move = move, .cost = told.cost};
  LiveStep step{.kind = LiveStep::Kind::kMove, .move = graph_.move_name(told.name)};
  if (told.to != kNoNode) {
    pending_->expects = graph_.place(told.to).state;
    step.expects = graph_.name(pending_->expects);
  }
  return step;
}

void LiveExploration::next_was(const LiveStep& step) {
  if (step.kind == LiveStep::Kind::kDone) {
    step_ = step;
    return;
  }
  std::int32_t move = StateGraph::kReset;
  if (step.kind == LiveStep::Kind::kMove) {
    const auto& moves = graph_.moves(position_);
    const auto found = std::ranges::find_if(
        moves, [&](const StateMove& one) { return !one.gone && graph_.move_name(one.name) == step.move; });
    if (found == moves.end()) throw Error({.what = "the state has no such move", .got = in_quotes(step.move)});
    move = static_cast<std::int32_t>(found - moves.begin());
  } else if (!graph_.resets()) {
    throw Error({.what = "there are no resets"});
  }
  step_ = tell(move);
}

// Why there is no next step.
LiveStep LiveExploration::done_now() const {
  LiveStep step;
  bool left = false;
  for (std::int32_t state = 0; state < graph_.state_count(); ++state) {
    left = left || !graph_.visited(state) || graph_.untried_count(state) > 0;
    left = left || std::ranges::any_of(graph_.moves(state), [&](const StateMove& move) {
             const bool counts = graph_.cover() == Cover::kEdges || move.to == kNoNode;
             return counts && !move.gone && StateGraph::given_up(move) && !move.tried;
           });
  }
  if (!left) return step;
  step.done = LiveStep::Done::kUnreachable;
  // Whether a way leads there for more than is left.
  NearestFirst().run(graph_.view().open(), graph_.node(position_), kNoLimit, [&](NodeId node, double) {
    if (graph_.ground().contains(node)) return NearestFirst::Next::kThrough;
    if (task_->cost_to_end(node) < kNoLimit) step.done = LiveStep::Done::kBudget;
    return NearestFirst::Next::kPast;
  });
  return step;
}

LiveReport LiveExploration::report() const {
  LiveReport report = so_far_;
  report.cost = spent_;
  if (position_ >= 0) report.state = graph_.name(position_);
  if (reset_failures_ > 0) report.failed.push_back({.state = "", .move = "", .failures = reset_failures_});
  report.states = graph_.visited_count();
  report.transitions = graph_.tried_count();
  for (std::int32_t state = 0; state < graph_.state_count(); ++state) {
    if (!graph_.visited(state)) report.unreachable.push_back(graph_.name(state));
    for (const StateMove& move : graph_.moves(state)) {
      if (move.failures == 0 || (move.gone && !StateGraph::given_up(move))) continue;
      report.failed.push_back(
          {.state = graph_.name(state), .move = graph_.move_name(move.name), .failures = move.failures});
    }
  }
  return report;
}

GraphMap LiveExploration::map() const {
  GraphMap map;
  Multigraph all;
  for (std::int32_t state = 0; state < graph_.state_count(); ++state) {
    map.labels.push_back(graph_.name(state));
    if (graph_.prize(state) != 1 && map.prizes.empty()) map.prizes.assign(state, 1);
    if (!map.prizes.empty()) map.prizes.push_back(graph_.prize(state));
    for (const StateMove& move : graph_.moves(state)) {
      if (move.to == kNoNode || (move.gone && !move.tried)) continue;
      all.edges.push_back({state, graph_.place(move.to).state, move.cost});
      all.labels.push_back(graph_.move_name(move.name));
    }
  }
  map.graph = Graph::from_edges(graph_.state_count(), all.edges, EdgeKind::kDirected);
  map.blocked.resize(graph_.state_count());
  map.multigraph = std::make_shared<const Multigraph>(std::move(all));
  map.task.start = graph_.place(walk_.front()).state;
  return map;
}

Answer LiveExploration::answer(const std::string& name) const {
  // States by their own numbers: nodes of untried moves are none.
  const auto number = [&](NodeId node) { return static_cast<NodeId>(graph_.place(node).state); };
  GraphMap map = this->map();
  std::vector<Edge> edges = map.multigraph->edges;
  map.multigraph = nullptr;  // of pictures
  std::unordered_set<std::uint64_t> joined;
  const auto join = [&](NodeId from, NodeId to) {
    return joined.insert(static_cast<std::uint64_t>(from) << 32 | static_cast<std::uint32_t>(to)).second;
  };
  for (const Edge& edge : edges) join(edge.a, edge.b);
  for (std::size_t i = 1; i < walk_.size(); ++i) {
    const NodeId from = number(walk_[i - 1]);
    const NodeId to = number(walk_[i]);
    if (!join(from, to)) continue;
    const bool reset = options_.reset_cost && to == graph_.reset_target();
    edges.push_back({from, to, reset ? *options_.reset_cost : 1});
  }
  map.graph = Graph::from_edges(graph_.state_count(), edges, EdgeKind::kDirected);
  World world(name, std::move(map));

  Plan plan;
  for (const NodeId node : walk_) plan.walk.push_back(number(node));
  for (std::int32_t state = 0; state < graph_.state_count(); ++state) {
    if (graph_.visited(state)) plan.prize += graph_.prize(state);
  }
  plan.visited = graph_.visited_count();
  plan.cost = spent_;
  const NodeId start = plan.walk.front();
  // The world may have no way to the end any more, and what was spent may be more than the budget.
  Answer answer{.world = world,
                .task = Task(world, start, std::max(options_.budget, spent_)),
                .policy = options_.policy,
                .plan = std::move(plan),
                .reveal = Reveal::parse("edges"),
                .until_covered = options_.budget == kNoLimit};
  for (const NodeId node : seen_) answer.discovered.nodes.push_back(number(node));
  answer.discovered.after_step = seen_after_;
  return answer;
}

}  // namespace graphdrl
