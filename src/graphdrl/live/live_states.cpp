#include "graphdrl/live/live_states.h"

#include <algorithm>
#include <unordered_set>
#include <utility>

namespace graphdrl {
namespace {

void check_name(const std::string& name, const char* field) {
  if (name.empty()) throw FieldError(field, {.what = "a name is empty"});
}

}  // namespace

LiveStates::LiveStates(const LiveOptions& options)
    : reset_cost_(options.reset_cost),
      graph_(options.cover, options.directed, options.reset_cost, options.end_at_start) {}

std::unique_ptr<Policy> LiveStates::own_policy(const std::string& name) {
  if (name != kNovelty) return nullptr;
  auto novelty = std::make_unique<NoveltyPolicy>(graph_);
  novelty_ = novelty.get();
  return novelty;
}

void LiveStates::check(const LiveObservation& seen) const {
  if (seen.at) throw FieldError("at", {.what = "the exploration is one of states"});
  if (seen.cells) throw FieldError("cells", {.what = "the exploration is one of states"});
  check_name(seen.state, "state");
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

LiveMap::Moved LiveStates::take(const LiveObservation& seen) {
  graph_.begin_visit();
  Moved moved;
  const std::optional<Pending> step = std::exchange(pending_, std::nullopt);
  if (step) {
    moved.cost = settle(*step, seen);
  } else if (seen.cost) {
    moved.cost = *seen.cost;
    graph_.change();
  }
  const std::int32_t state = graph_.enter(seen.state, seen.prize, kNoNode);
  if (seen.moves) graph_.offer(state, *seen.moves);
  graph_.discovery().close(graph_.node(state));
  if (state != position_) moved.way.push_back(graph_.node(state));
  position_ = state;
  return moved;
}

// What became of a step: what it cost.
double LiveStates::settle(const Pending& step, const LiveObservation& seen) {
  ++so_far_.steps;
  const double cost = seen.cost.value_or(step.cost);
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
  if (reset) {
    settle_reset(seen, cost);
    return cost;
  }
  if (seen.failed) {
    graph_.failed(step.state, step.move);
    return cost;
  }
  const StateMove move = graph_.moves(step.state)[step.move];
  const bool is_new = known < 0 || !graph_.visited(known);
  // A state not heard of takes the number that the next one has.
  if (novelty_ != nullptr && !move.tried) {
    novelty_->learn(step.state, step.move, known < 0 ? graph_.state_count() : known, is_new);
  }
  const std::int32_t state = graph_.enter(seen.state, seen.prize, known < 0 ? move.untried_node : kNoNode);
  graph_.done(step.state, step.move, state, cost);
  return cost;
}

void LiveStates::settle_reset(const LiveObservation& seen, double cost) {
  if (!seen.failed) {
    reset_failures_ = 0;
    ++so_far_.resets;
    return graph_.reset_done(graph_.enter(seen.state, seen.prize, kNoNode), cost);
  }
  graph_.change();
  if (++reset_failures_ >= StateGraph::kMostFailures) graph_.give_up_resets();
}

LiveStep LiveStates::tell(std::span<const NodeId> way) {
  return tell_move(graph_.move_to(position_, way.front()));
}

LiveStep LiveStates::tell_move(std::int32_t move) {
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

void LiveStates::told(const LiveStep& step) {
  if (step.kind == LiveStep::Kind::kGoto) throw Error({.what = "states have no way to go"});
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
  tell_move(move);
}

bool LiveStates::is_left() const {
  for (std::int32_t state = 0; state < graph_.state_count(); ++state) {
    if (!graph_.visited(state) || graph_.untried_count(state) > 0) return true;
    const bool given_up = std::ranges::any_of(graph_.moves(state), [&](const StateMove& move) {
      const bool counts = graph_.cover() == Cover::kEdges || move.to == kNoNode;
      return counts && !move.gone && StateGraph::given_up(move) && !move.tried;
    });
    if (given_up) return true;
  }
  return false;
}

void LiveStates::add_to(LiveReport& report) const {
  const double cost = report.cost;
  report = so_far_;
  report.cost = cost;
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
}

// Whether a move is the way back of another one that a map has for both.
bool LiveStates::is_way_back(std::int32_t state, const StateMove& move) const {
  const std::int32_t other = graph_.place(move.to).state;
  if (graph_.directed() || state <= other) return false;
  return std::ranges::any_of(graph_.moves(other), [&](const StateMove& twin) {
    return twin.name == move.name && twin.to == graph_.node(state) && (!twin.gone || twin.tried);
  });
}

// States are nodes, by name; moves that were done, or are said to lead somewhere, are edges, by name.
GraphMap LiveStates::graph_map() const {
  GraphMap map;
  Multigraph all;
  for (std::int32_t state = 0; state < graph_.state_count(); ++state) {
    map.labels.push_back(graph_.name(state));
    if (graph_.prize(state) != 1 && map.prizes.empty()) map.prizes.assign(state, 1);
    if (!map.prizes.empty()) map.prizes.push_back(graph_.prize(state));
    for (const StateMove& move : graph_.moves(state)) {
      if (move.to == kNoNode || (move.gone && !move.tried) || is_way_back(state, move)) continue;
      all.edges.push_back({state, graph_.place(move.to).state, move.cost});
      all.labels.push_back(graph_.move_name(move.name));
    }
  }
  map.graph = Graph::from_edges(graph_.state_count(), all.edges, kind());
  map.blocked.resize(graph_.state_count());
  map.multigraph = std::make_shared<const Multigraph>(std::move(all));
  map.task.start = 0;  // the first state that was heard of
  return map;
}

AnyMap LiveStates::map() const {
  return graph_map();
}

// With the resets that were made as edges, and the steps that no move makes any more.
LiveMap::Picture LiveStates::picture(const std::string& name, std::span<const NodeId> walk,
                                     std::span<const int> seen_after) const {
  // States by their own numbers: nodes of untried moves are none.
  const auto number = [&](NodeId node) { return static_cast<NodeId>(graph_.place(node).state); };
  GraphMap map = graph_map();
  std::vector<Edge> edges = map.multigraph->edges;
  map.multigraph = nullptr;
  std::unordered_set<std::uint64_t> joined;
  const auto join = [&](NodeId from, NodeId to) {
    return joined.insert(static_cast<std::uint64_t>(from) << 32 | static_cast<std::uint32_t>(to)).second;
  };
  for (const Edge& edge : edges) {
    join(edge.a, edge.b);
    if (!graph_.directed()) join(edge.b, edge.a);
  }
  for (std::size_t i = 1; i < walk.size(); ++i) {
    const NodeId from = number(walk[i - 1]);
    const NodeId to = number(walk[i]);
    if (!join(from, to)) continue;
    const bool reset = reset_cost_ && to == graph_.reset_target();
    edges.push_back({from, to, reset ? *reset_cost_ : 1});
  }
  map.graph = Graph::from_edges(graph_.state_count(), edges, kind());
  Picture picture{.world = World(name, std::move(map)),
                  .plan = {},
                  .seen = {},
                  .after = {seen_after.begin(), seen_after.end()},
                  .reveal = Reveal::parse("edges"),
                  .score = Score::kVisited,
                  .unit = 1};
  for (const NodeId node : walk) picture.plan.walk.push_back(number(node));
  for (std::int32_t state = 0; state < graph_.state_count(); ++state) {
    picture.seen.push_back(state);
    if (graph_.visited(state)) picture.plan.prize += graph_.prize(state);
  }
  picture.plan.visited = graph_.visited_count();
  return picture;
}

}  // namespace graphdrl
