#include "graphdrl/live/state_graph.h"

#include <algorithm>
#include <functional>
#include <utility>

namespace graphdrl {
namespace {

std::uint64_t from_to(NodeId from, NodeId to) {
  return static_cast<std::uint64_t>(from) << 32 | static_cast<std::uint32_t>(to);
}

std::size_t hash_of(const std::vector<OfferedMove>& moves) {
  std::size_t hash = moves.size();
  const auto add = [&](std::size_t more) { hash = (hash ^ more) * 0x9e3779b97f4a7c15ULL + (hash >> 29); };
  for (const OfferedMove& move : moves) {
    add(std::hash<std::string>()(move.name));
    add(move.to ? std::hash<std::string>()(*move.to) : 1);
    add(move.cost ? std::hash<double>()(*move.cost) : 2);
    add(move.tried ? 3 : 4);
  }
  return hash;
}

}  // namespace

StateGraph::StateGraph(Cover cover, bool directed, std::optional<double> reset_cost, bool way_home)
    : cover_(cover),
      directed_(directed),
      reset_cost_(reset_cost),
      way_home_(way_home),
      discovery_("live", EdgeKind::kDirected) {}

std::int32_t StateGraph::find(std::string_view name) const {
  const auto found = state_of_.find(std::string(name));
  return found == state_of_.end() ? -1 : found->second;
}

void StateGraph::change() {
  if (!changed_) discovery_.begin_visit();
  changed_ = true;
}

NodeId StateGraph::add_node(Place place) {
  const NodeId node = discovery_.see();
  places_.push_back(place);
  ground_.grow(node + 1);
  return node;
}

// Where a walk must come home, resets lead there from nodes that were not entered yet, too.
void StateGraph::add_way_home(NodeId node) {
  if (way_home_ && reset_target_ >= 0) settle_edge(node, this->node(reset_target_));
}

std::int32_t StateGraph::see(std::string_view name, NodeId untried_node) {
  const auto [found, fresh] = state_of_.try_emplace(std::string(name), state_count());
  if (!fresh) return found->second;
  change();
  const std::int32_t state = found->second;
  if (untried_node == kNoNode) untried_node = add_node({.state = state});
  places_[untried_node] = {.state = state};
  states_.push_back({.name = std::string(name), .node = untried_node});
  add_way_home(untried_node);
  return state;
}

std::int32_t StateGraph::number_of(const std::string& move_name) {
  const auto [found, fresh] = number_of_move_.try_emplace(move_name, move_name_count());
  if (fresh) move_names_.push_back(move_name);
  return found->second;
}

std::int32_t StateGraph::enter(std::string_view name, double prize, NodeId untried_node) {
  const std::int32_t state = see(name, untried_node);
  State& entered = states_[state];
  if (entered.visited) return state;
  change();
  entered.visited = true;
  entered.prize = prize;
  ++visited_count_;
  ground_.insert(entered.node);
  if (reset_target_ < 0) {
    reset_target_ = state;
  } else {
    settle_edge(entered.node, node(reset_target_));
  }
  return state;
}

bool StateGraph::worth_trying(const StateMove& move) const {
  if (move.gone || move.waiting || move.tried || given_up(move)) return false;
  return cover_ == Cover::kEdges || move.to == kNoNode;
}

void StateGraph::offer(std::int32_t state, const std::vector<OfferedMove>& offered) {
  const std::size_t hash = hash_of(offered);
  if (states_[state].offered == hash) return;
  states_[state].offered = hash;
  change();
  std::vector<NodeId> touched;  // ends of edges that may have changed
  std::unordered_map<std::int32_t, std::int32_t> by_name;
  for (StateMove& move : states_[state].moves) {
    by_name.emplace(move.name, static_cast<std::int32_t>(by_name.size()));
    move.gone = true;
  }
  for (const OfferedMove& one : offered) {
    const std::int32_t name = number_of(one.name);
    const auto [found, fresh] = by_name.emplace(name, static_cast<std::int32_t>(by_name.size()));
    if (fresh) add_move(state, name);
    StateMove& move = states_[state].moves[found->second];
    move.gone = false;
    move.tried = move.tried || one.tried;
    // What is said again as before is no news: what was found out since holds.
    if (one.cost && *one.cost != move.told_cost) move.cost = move.told_cost = *one.cost;
    if (!one.to) continue;
    const NodeId to = states_[see(*one.to, kNoNode)].node;
    StateMove& told = states_[state].moves[found->second];  // states may have moved
    if (to == told.told_to) continue;
    told.told_to = to;
    touched.push_back(lead(state, found->second, to));
  }
  State& here = states_[state];
  here.untried = 0;
  here.next_shown = 0;
  for (StateMove& move : here.moves) {
    if (worth_trying(move)) {
      ++here.untried;
    } else if (move.untried_node != kNoNode) {
      hide(move, state);
    }
    if (move.untried_node != kNoNode) {
      const int index = view().open().index_of(here.node, move.untried_node);
      if (view().open().cost(here.node, index) != move.cost) {
        discovery_.disconnect(here.node, move.untried_node);
        discovery_.connect({here.node, move.untried_node, move.cost});
      }
    }
    touched.push_back(move.to);
  }
  std::ranges::sort(touched);
  touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
  for (const NodeId to : touched) {
    if (to != kNoNode) settle_edge(here.node, to);
  }
  for (std::int32_t i = 0; !directed_ && i < std::ssize(states_[state].moves); ++i) lead_back(state, i);
  show_more(state);
}

// As many nodes as may be for moves that are worth trying.
void StateGraph::show_more(std::int32_t state) {
  const std::int32_t count = static_cast<std::int32_t>(states_[state].moves.size());
  for (std::int32_t i = static_cast<std::int32_t>(states_[state].next_shown);
       i < count && states_[state].shown < kMostUntriedShown; ++i) {
    State& here = states_[state];
    here.next_shown = i + 1;
    StateMove& move = here.moves[i];
    if (move.untried_node != kNoNode || !worth_trying(move)) continue;
    change();
    move.untried_node = add_node({.state = state, .move = i});
    add_way_home(move.untried_node);
    discovery_.connect({here.node, move.untried_node, move.cost});
    ++here.shown;
  }
}

// What stood for its end is no node any more.
void StateGraph::hide(StateMove& move, std::int32_t state) {
  change();
  const NodeId node = move.untried_node;
  discovery_.disconnect(states_[state].node, node);
  while (view().open().degree(node) > 0) discovery_.disconnect(node, view().open_neighbours(node)[0]);
  discovery_.forget(node);
  ground_.insert(node);
  places_[node] = {};
  move.untried_node = kNoNode;
  --states_[state].shown;
}

// A move leads to a state from now on. Gives where it led before; the edges there are still to be settled.
NodeId StateGraph::lead(std::int32_t state, std::int32_t move, NodeId to) {
  const NodeId from = states_[state].node;
  const NodeId before = states_[state].moves[move].to;
  if (before == to) return before;
  if (before != kNoNode) std::erase(moves_to_[from_to(from, before)], move);
  states_[state].moves[move].to = to;
  moves_to_[from_to(from, to)].push_back(move);
  return before;
}

std::int32_t StateGraph::add_move(std::int32_t state, std::int32_t name) {
  std::vector<StateMove>& moves = states_[state].moves;
  const auto move = static_cast<std::int32_t>(moves.size());
  moves.push_back({.name = name});
  if (!directed_) move_of_.emplace(from_to(state, name), move);
  return move;
}

// Where moves lead both ways: the state that a move leads to has it, too.
void StateGraph::lead_back(std::int32_t state, std::int32_t index) {
  const StateMove move = states_[state].moves[index];
  const NodeId here = states_[state].node;
  if (directed_ || move.gone || move.to == kNoNode || move.to == here) return;
  const std::int32_t other = places_[move.to].state;
  const auto found = move_of_.find(from_to(other, move.name));
  const bool fresh = found == move_of_.end();
  const std::int32_t back = fresh ? add_move(other, move.name) : found->second;
  StateMove& same = states_[other].moves[back];
  if (!fresh && same.to == here && same.tried == move.tried && same.cost == move.cost) return;
  change();
  const bool counted = !fresh && worth_trying(same) && states_[other].visited;
  same.tried = same.tried || move.tried;
  same.cost = move.cost;
  const NodeId before = lead(other, back, here);
  if (before != kNoNode && before != here) settle_edge(move.to, before);
  settle_edge(move.to, here);
  if (!states_[other].visited) return;  // what is worth trying is counted once it is entered
  StateMove& settled = states_[other].moves[back];
  if (worth_trying(settled)) {
    if (!counted) ++states_[other].untried;
  } else {
    if (counted) --states_[other].untried;
    if (settled.untried_node != kNoNode) hide(settled, other);
  }
  show_more(other);
}

std::int32_t StateGraph::move_to(std::int32_t state, NodeId to) const {
  const NodeId from = states_[state].node;
  if (places_[to].move >= 0) return places_[to].move;
  std::int32_t best = kReset;
  const bool resets = reset_cost_ && reset_target_ >= 0 && to == states_[reset_target_].node;
  double least = resets ? *reset_cost_ : kNoLimit;
  bool tried = true;  // of equally cheap ones one that has not been tried
  const auto found = moves_to_.find(from_to(from, to));
  if (found == moves_to_.end()) return best;
  for (const std::int32_t i : found->second) {
    const StateMove& move = states_[state].moves[i];
    if (move.gone || move.waiting || given_up(move) || move.surprises >= kMostSurprises) continue;
    if (move.cost > least || (move.cost == least && best != kReset && (move.tried || !tried))) continue;
    best = i;
    least = move.cost;
    tried = move.tried;
  }
  return best;
}

// The edge between two states is as cheap as the cheapest move, or a reset; there is none where there is neither.
void StateGraph::settle_edge(NodeId from, NodeId to) {
  if (from == to) return;
  double cost = kNoLimit;
  if (reset_target_ >= 0 && to == node(reset_target_) && reset_cost_) cost = *reset_cost_;
  if (const Place& place = places_[from]; place.state >= 0 && place.move < 0) {
    const std::int32_t move = move_to(place.state, to);
    if (move != kReset) cost = states_[place.state].moves[move].cost;
  }
  const int before = view().open().index_of(from, to);
  if (before >= 0 ? view().open().cost(from, before) == cost : cost == kNoLimit) return;
  change();
  if (before >= 0) discovery_.disconnect(from, to);
  if (cost < kNoLimit) discovery_.connect({from, to, cost});
}

void StateGraph::done(std::int32_t state, std::int32_t index, std::int32_t to, double cost) {
  const NodeId target = states_[to].node;
  bool settled = true;  // the edge is as the move was
  {
    State& here = states_[state];
    StateMove& move = here.moves[index];
    settled = move.to == target && move.cost == cost && !move.waiting && !given_up(move);
    if (worth_trying(move)) --here.untried;
    if (!move.tried) ++tried_count_;
    if (move.to != kNoNode && move.to != target) ++move.surprises;
    if (move.told_to != kNoNode && move.told_to != target) doubted_.push_back({.state = state, .move = index});
    if (move.untried_node == target) {  // became the state
      move.untried_node = kNoNode;
      --here.shown;
    } else if (move.untried_node != kNoNode) {
      hide(move, state);
    }
    move.tried = true;
    move.waiting = false;
    move.failures = 0;
    move.cost = cost;
  }
  const NodeId before = lead(state, index, target);
  if (before != kNoNode && before != target) settle_edge(states_[state].node, before);
  if (!settled || states_[state].moves[index].surprises >= kMostSurprises) settle_edge(states_[state].node, target);
  lead_back(state, index);
  show_more(state);
}

void StateGraph::failed(std::int32_t state, std::int32_t index) {
  State& here = states_[state];
  StateMove& move = here.moves[index];
  if (worth_trying(move)) --here.untried;
  ++move.failures;
  if (!move.waiting) waiting_.push_back({.state = state, .move = index});
  move.waiting = true;
  if (move.untried_node != kNoNode) hide(move, state);
  if (move.to != kNoNode) settle_edge(here.node, move.to);
  show_more(state);
}

bool StateGraph::retry() {
  bool any = false;
  changed_ = false;  // a policy that has seen all this and stopped must think again
  for (const Place& place : std::exchange(waiting_, {})) {
    State& here = states_[place.state];
    StateMove& move = here.moves[place.move];
    move.waiting = false;
    if (move.gone || given_up(move)) continue;
    any = true;
    if (worth_trying(move)) ++here.untried;
    here.next_shown = std::min(here.next_shown, static_cast<std::size_t>(place.move));
    if (move.to != kNoNode) settle_edge(here.node, move.to);
    show_more(place.state);
  }
  if (any) return true;
  // What the client says of a move may be true again.
  for (const Place& place : std::exchange(doubted_, {})) {
    const StateMove& move = states_[place.state].moves[place.move];
    if (move.gone || move.told_to == kNoNode || move.told_to == move.to || move.surprises >= kMostFailures) continue;
    any = true;
    const NodeId before = lead(place.state, place.move, move.told_to);
    settle_edge(states_[place.state].node, before);
    settle_edge(states_[place.state].node, move.told_to);
  }
  return any;
}

void StateGraph::reset_done(std::int32_t state, double cost) {
  if (state == reset_target_ && cost == *reset_cost_) return;
  change();
  const NodeId before = node(reset_target_);
  reset_target_ = state;
  reset_cost_ = cost;
  settle_resets(before);
  settle_resets(states_[state].node);
}

void StateGraph::give_up_resets() {
  change();
  reset_cost_.reset();
  settle_resets(node(reset_target_));
}

// The edges to where resets lead, or led.
void StateGraph::settle_resets(NodeId target) {
  for (NodeId node = 0; node < view().node_count(); ++node) {
    const Place& place = places_[node];
    if (place.state < 0) continue;
    if (way_home_ || (place.move < 0 && states_[place.state].visited)) settle_edge(node, target);
  }
}

}  // namespace graphdrl
