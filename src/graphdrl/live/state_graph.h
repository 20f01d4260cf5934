// What a client has told of the states it was in and the moves they have: a graph that is discovered move by move.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "graphdrl/env/discovery.h"

namespace graphdrl {

// A move as a client offers it.
struct OfferedMove {
  std::string name;
  std::optional<std::string> to = {};  // the state it leads to, where that can be seen
  std::optional<double> cost = {};     // empty: what it cost last, or 1
  bool tried = false;                  // it was done before, as in an earlier run: it does not count any more
};

// A move of a state.
struct StateMove {
  std::int32_t name;              // [StateGraph::move_name()]
  NodeId untried_node = kNoNode;  // what stands for its unknown end; kNoNode once it has been tried
  NodeId to = kNoNode;            // the state's node it led to last, or is said to lead to
  double cost = 1;                // what it cost last, or is said to cost
  NodeId told_to = kNoNode;       // what the client said of it last: where it leads …
  double told_cost = -1;          // … and what it costs; -1: nothing
  bool tried = false;
  bool gone = false;            // the state does not have it any more
  bool waiting = false;         // it failed, and others come first
  std::uint16_t failures = 0;   // since it was done last
  std::uint16_t surprises = 0;  // led elsewhere than the time before
};

// States are nodes of a directed graph [Discovery] once they are seen. A move that has not been tried is a node of its
// own, at the frontier, which becomes the new state that it leads to; where that state is known, the node is forgotten.
// So policies for unknown maps explore states as they are. Of states with very many moves only kMostUntriedShown
// untried ones are nodes at a time.
//
// Moves that lead back to their state are no edges, and of several to the same state the cheapest one that works is.
class StateGraph {
 public:
  // directed: false where each move leads back, too, as a move of the same name of the state that it leads to; both
  // count as one. reset_cost: of going back to the first state from any other; empty where that cannot be done.
  // way_home: whether a walk must be able to end at the first state.
  StateGraph(Cover cover, bool directed, std::optional<double> reset_cost, bool way_home);

  // States have numbers in the order in which they were heard of, and moves numbers of their state in the order in
  // which they were offered.
  struct Place {
    std::int32_t state = -1;
    std::int32_t move = -1;  // -1: the state itself
  };
  static constexpr std::int32_t kReset = -2;  // a move's number
  static constexpr int kMostFailures = 3;     // then a move, or resets, are given up

  const Discovery& discovery() const { return discovery_; }
  Discovery& discovery() { return discovery_; }
  const View& view() const { return discovery_.view(); }
  Cover cover() const { return cover_; }
  bool directed() const { return directed_; }

  std::int32_t state_count() const { return static_cast<std::int32_t>(states_.size()); }
  std::int32_t find(std::string_view name) const;  // -1: never heard of
  const std::string& name(std::int32_t state) const { return states_[state].name; }
  NodeId node(std::int32_t state) const { return states_[state].node; }
  bool visited(std::int32_t state) const { return states_[state].visited; }
  int visited_count() const { return visited_count_; }
  double prize(std::int32_t state) const { return states_[state].prize; }
  const std::vector<StateMove>& moves(std::int32_t state) const { return states_[state].moves; }
  const std::string& move_name(std::int32_t name) const { return move_names_[name]; }
  std::int32_t move_name_count() const { return static_cast<std::int32_t>(move_names_.size()); }
  // How many moves of a state are worth trying.
  int untried_count(std::int32_t state) const { return states_[state].untried; }
  std::int64_t tried_count() const { return tried_count_; }  // transitions done
  // What a node stands for; state -1 where it was forgotten.
  Place place(NodeId node) const { return places_[node]; }
  std::int32_t reset_target() const { return reset_target_; }  // the state that resets lead to

  // Nodes that first visits walk through: states visited, and what was forgotten.
  const NodeSet& ground() const { return ground_; }

  // A state is entered: gives it. untried_node: what stood for it till then, or kNoNode. The first state is the one
  // that resets lead to.
  std::int32_t enter(std::string_view name, double prize, NodeId untried_node);
  // The moves that a state has now, instead of those before. REQUIRES: no two have the same name.
  void offer(std::int32_t state, const std::vector<OfferedMove>& moves);
  // What is shown from here on is a later visit's.
  void begin_visit() { changed_ = false; }

  // A move was done and led to a state, which has been entered.
  void done(std::int32_t state, std::int32_t move, std::int32_t to, double cost);
  // It was not done; it waits. given_up(): it has failed three times.
  void failed(std::int32_t state, std::int32_t move);
  static bool given_up(const StateMove& move) { return move.failures >= kMostFailures; }
  // Moves that failed and wait can be tried again; where there are none, those that led elsewhere than the client says
  // are believed to lead there again. False where there are none of these either.
  bool retry();
  // A reset led to a state, for a cost; so others do from now on.
  void reset_done(std::int32_t state, double cost);
  // Resets do not work.
  void give_up_resets();
  bool resets() const { return reset_cost_.has_value(); }
  double reset_cost() const { return *reset_cost_; }  // REQUIRES: resets()
  // Something changed that policies must know of, as that a step cost more than was said.
  void change();

  // The move by which a step to a node is made: kReset for a reset.
  std::int32_t move_to(std::int32_t state, NodeId node) const;

 private:
  static constexpr int kMostUntriedShown = 256;
  static constexpr int kMostSurprises = 10;  // then no way leads over the move

  struct State {
    std::string name;
    NodeId node;
    double prize = 1;
    bool visited = false;
    int untried = 0;                          // moves worth trying
    int shown = 0;                            // of them, nodes
    std::size_t next_shown = 0;               // all before it are shown
    std::optional<std::size_t> offered = {};  // a hash of what was offered last
    std::vector<StateMove> moves = {};
  };

  std::int32_t see(std::string_view name, NodeId untried_node);
  std::int32_t number_of(const std::string& move_name);
  bool worth_trying(const StateMove& move) const;
  NodeId add_node(Place place);
  void add_way_home(NodeId node);
  void show_more(std::int32_t state);
  void hide(StateMove& move, std::int32_t state);
  NodeId lead(std::int32_t state, std::int32_t move, NodeId to);
  std::int32_t add_move(std::int32_t state, std::int32_t name);
  void lead_back(std::int32_t state, std::int32_t move);
  void settle_resets(NodeId target);
  void settle_edge(NodeId from, NodeId to);

  Cover cover_;
  bool directed_;
  std::optional<double> reset_cost_;
  bool way_home_;
  Discovery discovery_;
  NodeSet ground_;
  std::vector<State> states_;
  std::vector<Place> places_;  // [N]
  std::unordered_map<std::string, std::int32_t> state_of_;
  std::vector<std::string> move_names_;
  std::unordered_map<std::string, std::int32_t> number_of_move_;
  std::unordered_map<std::uint64_t, std::vector<std::int32_t>> moves_to_;  // by from_to(): what led there last
  std::unordered_map<std::uint64_t, std::int32_t> move_of_;                // by state and name; unless directed
  std::vector<Place> waiting_;                                             // moves that failed
  std::vector<Place> doubted_;  // moves that led elsewhere than the client says
  bool changed_ = false;        // since the visit began
  std::int32_t reset_target_ = -1;
  int visited_count_ = 0;
  std::int64_t tried_count_ = 0;
};

}  // namespace graphdrl
