// What the explorer's network sees: one row of numbers per valid node and one per possible first visit, none of which
// depends on a world's size, on coordinates or, but for ties at the edge of the scope, on how its nodes are numbered.
// Costs are in mean edges of the world.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <span>
#include <string_view>
#include <vector>

#include "graphdrl/env/exploration.h"
#include "graphdrl/graph/search.h"
#include "graphdrl/nn/graph_batch.h"

namespace graphdrl {

// Flags are 0 or 1; costs are cut at 32 and divided by 8; counts are cut at 64 and scaled as ln(1 + count) / 4.
inline constexpr std::array<std::string_view, 20> kExplorerNodeFeatures = {
    "unvisited",             // flag
    "current",               // flag
    "candidate",             // flag: the target of a possible first visit
    "degree",                // count, whichever way edges lead
    "unvisited_neighbours",  // count
    "isolated",              // flag: unvisited, and so is no neighbour
    "dead_end",              // flag: unvisited, and so is one neighbour
    "distance",              // cost from the current node, through any ground
    "visit_cost",            // cost of the first visit; 0 of other nodes
    "out_of_scope",          // share of the node's neighbours that the network does not see
    "distance_to_work",      // steps to the nearest unvisited node
    "part_size",             // count: unvisited nodes connected through unvisited ones
    "part_share",            // of all unvisited nodes in reach
    "edge_cost",             // mean of the node's edges, in mean edges, cut at 4, less 1
    "budget_per_work",       // budget left for each unvisited node in reach, in mean edges, cut at 3; the same of all
    "slack",           // budget left less unvisited nodes in the scope, cut at ±16, divided by 8; the same of all
    "hanging",         // flag: unvisited, and can be left only by the way one came
    "hanging_size",    // count: nodes of the hanging tree from here outwards, or of those that hang on the node
    "hanging_height",  // cost: steps to the farthest of them
    "one_way",         // share of the node's edges that lead one way only
};
inline constexpr int kExplorerNodeFeatureCount = static_cast<int>(kExplorerNodeFeatures.size());

inline constexpr std::array<std::string_view, 11> kExplorerVisitFeatures = {
    "cost",                  // cost
    "change_of_penalties",   // change_of_penalties() / 4
    "unvisited_neighbours",  // count, of the target
    "next_cost",             // cost from the target to the next unvisited node
    "budget_per_work",       // as of nodes, after the visit
    "slack",                 // likewise
    "work",                  // count: unvisited nodes in reach
    "hanging",               // as of the target
    "hanging_size",          // likewise
    "hanging_height",        // likewise
    "work_in_scope",         // share of the work that the network sees; the same of all
};
inline constexpr int kExplorerVisitFeatureCount = static_cast<int>(kExplorerVisitFeatures.size());

// B states with C first visits together.
struct ExplorerBatch {
  GraphBatch graphs;
  std::vector<float> node_x;    // [N, 20]
  std::vector<int> current;     // [B], the current node's row
  std::vector<float> visit_x;   // [C, 11]
  std::vector<int> target;      // [C], the row of the node visited
  std::vector<int> state;       // [C], the state it belongs to; visits of a state stand together
  std::vector<double> ceiling;  // [B], about what a walk can still visit: nodes in reach, or what the budget pays for
  std::vector<double> unseen;   // [B], the share of the unvisited nodes in reach that is out of scope
  std::vector<double> budget_per_work;  // [B], mean edges left to spend for each unvisited node in reach
  std::deque<Graph> scopes;             // what the network looks at of each world; `graphs` points to them

  void clear();
  int visit_count() const { return static_cast<int>(target.size()); }  // C
};

// How many nodes around the current one the network looks at: a large world looks like those it was trained on, and its
// share of a move's cost does not grow with the world. Where fewer than kLeastVisits first visits are among them, it
// looks at up to twice as many; a first visit farther off is one more node.
inline constexpr int kExplorerScope = 96;
inline constexpr int kLeastVisits = 3;

// How many nodes around the current one the features are measured on, whichever way edges lead. What lies beyond counts
// as one whole: unvisited nodes there as one part, joined to every part that touches them. 4096 takes a third more time
// in large worlds and visits no more (docs/explorer.md).
inline constexpr int kExplorerHorizon = 1024;

// Builds the features of states, of any world. Scratch memory of one thread: a state costs what lies within the
// horizon, not the size of the world, but for growing to it once.
class ExplorerEncoder {
 public:
  // Appends a state: of the valid nodes in reach the nearest `scope`, and more as above. Gives the first visits among
  // them, nearest first, until the next call. The batch may outlive everything else.
  std::span<const FirstVisit> append(const Exploration& state, int scope, ExplorerBatch& batch);

  // Whether there may have been first visits out of scope at the last call.
  bool overlooked() const { return overlooked_; }

 private:
  // Nodes within the horizon have local indices, by distance in steps from the current node, which is 0.
  struct Place {
    std::uint32_t call = 0;  // the call that set it
    int index = -1;
  };
  int local(NodeId node) const { return place_[node].call == call_ ? place_[node].index : -1; }
  std::span<const int> neighbours(int index) const {
    return {neighbours_.data() + offsets_[index], neighbours_.data() + offsets_[index + 1]};
  }

  void gather_horizon(const Exploration& state);
  void measure_distances(const Exploration& state, int scope);
  void find_first_visits(const Exploration& state);
  void choose_scope(const View& view, int scope);
  void measure_work_distances();
  void measure_parts(int unvisited_in_world);
  void measure_hanging_trees();
  Graph scope_graph(const View& view) const;
  void append_nodes(const Exploration& state, ExplorerBatch& batch);
  void append_visits(const Exploration& state, ExplorerBatch& batch);

  NearestFirst search_;
  double unit_ = 1;           // mean cost of an edge
  std::vector<Place> place_;  // [nodes of the largest world]
  std::uint32_t call_ = 0;

  // By local index:
  std::vector<NodeId> nodes_;
  std::vector<std::int64_t> offsets_;
  std::vector<int> neighbours_;  // local indices, whichever way edges lead; those beyond the horizon are left out
  std::vector<std::uint8_t> unvisited_;
  std::vector<int> degree_;                // whichever way edges lead
  std::vector<int> unvisited_neighbours_;  // beyond the horizon too
  std::vector<double> distance_;           // from the current node, in mean edges
  std::vector<double> visit_cost_;         // of a first visit, likewise; 0 of other nodes
  std::vector<int> work_distance_;         // steps from a visited node to an unvisited one; -1 where there is none
  std::vector<int> part_size_;
  std::vector<std::uint8_t> hanging_;
  std::vector<int> hanging_size_;
  std::vector<int> hanging_height_;
  std::vector<int> ties_;
  std::vector<int> number_;  // row in the scope; -1 out of it

  bool whole_component_ = false;  // nothing lies beyond the horizon
  int steps_to_horizon_ = 0;
  double work_ = 0;               // unvisited nodes in reach
  std::vector<int> in_reach_;     // nearest first, the current node first; as many as a scope may have
  bool in_reach_is_all_ = false;  // nothing else is in reach
  std::vector<FirstVisit> visits_;
  bool overlooked_ = false;
  double share_ = 1;       // of the work, in scope
  std::vector<int> seen_;  // the scope: local indices, in the order of rows
  std::vector<int> queue_;
};

}  // namespace graphdrl
