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

#include "graphdrl/env/world.h"
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

// A move: a walk to an unvisited node next to visited ground, by the cheapest way through visited ground.
struct FirstVisit {
  NodeId node;
  double cost;  // in units of cost
};

// The state of an exploration, as planners keep it.
struct ExplorerState {
  const std::uint64_t* visited;  // a bit per node
  NodeId position;
  double spendable;
};

// A bit per node.
std::vector<std::uint64_t> bits_of(const std::vector<bool>& visited);

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
  std::deque<Graph> parts;              // of worlds, which `graphs` points to

  void clear();
  int visit_count() const { return static_cast<int>(target.size()); }  // C
};

// How many nodes around the current one the network looks at: a large world looks like those it was trained on, and its
// share of a move's cost does not grow with the world.
inline constexpr int kExplorerScope = 96;

// Builds the features of one world's states. Keeps working memory; not thread safe. The world must outlive it, and it
// every batch that it appended to.
class ExplorerEncoder {
 public:
  explicit ExplorerEncoder(const World& world);

  const World& world() const { return *world_; }

  // Appends a state: of the valid nodes in reach the nearest `scope`, and more until three first visits are among them.
  // Gives the first visits, nearest first, until the next call. Cost: O(nodes + edges), and a search for each visit
  // that leads to no unvisited neighbour.
  std::span<const FirstVisit> append(const ExplorerState& state, int scope, ExplorerBatch& batch);

  // Whether there were first visits out of scope at the last call.
  bool overlooked() const { return overlooked_; }

 private:
  void measure_distances(const ExplorerState& state);
  void measure_work(const std::vector<bool>& unvisited);

  const World* world_;
  Graph into_;               // the open graph turned round
  Graph graph_;              // the valid nodes, renumbered in ascending order (rows), with edges in both directions
  std::vector<int> row_of_;  // by node; -1 for blocked ones
  double unit_;              // mean cost of an edge
  NearestFirst nearest_;
  NearestFirst from_visit_;
  std::vector<float> fixed_;  // [valid nodes, 3]: degree, edge cost, share of edges that lead one way
  std::vector<FirstVisit> visits_;
  bool overlooked_ = false;
  std::vector<NodeId> in_reach_;  // rows, nearest first, the position's first
  std::vector<NodeId> number_;    // for Graph::induced
  std::vector<NodeId> all_rows_;  // 0, 1, …
  // By row:
  std::vector<bool> unvisited_;
  std::vector<double> distance_;    // from the position, in mean edges
  std::vector<double> visit_cost_;  // of a first visit, likewise; else 0
  std::vector<int> unvisited_neighbours_;
  std::vector<int> work_distance_;
  std::vector<int> part_size_;
  std::vector<bool> hanging_;
  std::vector<int> hanging_size_;
  std::vector<int> hanging_height_;
  std::vector<int> ties_;
  std::vector<int> queue_;
};

// What an unvisited node is likely to cost on top of one step, in mean edges, by its unvisited neighbours: one without
// any must be left again by the way one came; one with a single neighbour is a dead end. Of fourteen pairs of penalties
// tried, the one by which a beam visits most on random 11×11 mazes at 1.0x.
double leftover_penalty(int unvisited_neighbours);

// By how much the sum of penalties over all unvisited nodes changes when `node` is visited. into: open turned round.
double change_of_penalties(const Graph& open, const Graph& into, const std::uint64_t* visited, NodeId node);

}  // namespace graphdrl
