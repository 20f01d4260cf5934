// What the explorer's network sees: one row of numbers per valid node and one per possible first visit, none of which
// depends on a world's size, on coordinates or, but for ties at the edge of the scope, on how its nodes are numbered.
#pragma once

#include <array>
#include <deque>
#include <span>
#include <string_view>
#include <vector>

#include "graphdrl/nn/explorer_measures.h"
#include "graphdrl/nn/graph_batch.h"

namespace graphdrl {

// How a measured number becomes a feature: (x - less) / divisor, or ln(1 + x) / divisor of counts, where x is the
// number cut at `least` and `most`.
struct FeatureScale {
  double least = -kNoLimit;
  double most = kNoLimit;
  double less = 0;
  double divisor = 1;
  bool is_count = false;
};

namespace scale {
inline constexpr FeatureScale kFlag{};  // 0 or 1
inline constexpr FeatureScale kShare{};
inline constexpr FeatureScale kCount{.most = 64, .divisor = 4, .is_count = true};
inline constexpr FeatureScale kCost{.most = 32, .divisor = 8};                 // mean edges of the world
inline constexpr FeatureScale kEdgeCost{.most = 4, .less = 1};                 // mean edges
inline constexpr FeatureScale kBudgetPerWork{.most = 3};                       // mean edges a node
inline constexpr FeatureScale kSlack{.least = -16, .most = 16, .divisor = 8};  // mean edges
inline constexpr FeatureScale kPenalty{.divisor = 4};                          // mean edges
}  // namespace scale

struct ExplorerFeature {
  std::string_view name;
  FeatureScale scale;
};

inline constexpr auto kExplorerNodeFeatures = std::to_array<ExplorerFeature>({
    {"unvisited", scale::kFlag},
    {"current", scale::kFlag},
    {"candidate", scale::kFlag},  // the target of a possible first visit
    {"degree", scale::kCount},    // whichever way edges lead
    {"unvisited_neighbours", scale::kCount},
    {"isolated", scale::kFlag},                  // unvisited, and so is no neighbour
    {"dead_end", scale::kFlag},                  // unvisited, and so is one neighbour
    {"distance", scale::kCost},                  // from the current node, through any ground
    {"visit_cost", scale::kCost},                // of the first visit; 0 of other nodes
    {"out_of_scope", scale::kShare},             // of the node's neighbours, those that the network does not see
    {"distance_to_work", scale::kCost},          // steps to the nearest unvisited node
    {"part_size", scale::kCount},                // unvisited nodes connected through unvisited ones
    {"part_share", scale::kShare},               // of all unvisited nodes in reach
    {"edge_cost", scale::kEdgeCost},             // mean of the node's edges
    {"budget_per_work", scale::kBudgetPerWork},  // budget left for each unvisited node in reach; the same of all
    {"slack", scale::kSlack},                    // budget left less unvisited nodes in the scope; the same of all
    {"hanging", scale::kFlag},                   // unvisited, and can be left only by the way one came
    {"hanging_size", scale::kCount},   // nodes of the hanging tree from here outwards, or of those on the node
    {"hanging_height", scale::kCost},  // steps to the farthest of them
    {"one_way", scale::kShare},        // of the node's edges, those that lead one way only
});

inline constexpr auto kExplorerVisitFeatures = std::to_array<ExplorerFeature>({
    {"cost", scale::kCost},
    {"change_of_penalties", scale::kPenalty},    // change_of_penalties()
    {"unvisited_neighbours", scale::kCount},     // of the target
    {"next_cost", scale::kCost},                 // from the target to the next unvisited node
    {"budget_per_work", scale::kBudgetPerWork},  // as of nodes, after the visit
    {"slack", scale::kSlack},                    // likewise
    {"work", scale::kCount},                     // unvisited nodes in reach
    {"hanging", scale::kFlag},                   // as of the target
    {"hanging_size", scale::kCount},             // likewise
    {"hanging_height", scale::kCost},            // likewise
    {"work_in_scope", scale::kShare},            // of the work, what the network sees; the same of all
});

inline constexpr int kExplorerNodeFeatureCount = static_cast<int>(kExplorerNodeFeatures.size());
inline constexpr int kExplorerVisitFeatureCount = static_cast<int>(kExplorerVisitFeatures.size());

// The column of a feature. REQUIRES: it is one of them.
constexpr std::size_t feature_column(std::span<const ExplorerFeature> features, std::string_view name) {
  std::size_t column = 0;
  while (features[column].name != name) ++column;
  return column;
}

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
  std::deque<Graph> scopes;     // what the network looks at of each world; `graphs` points to them

  void clear();
  int visit_count() const { return static_cast<int>(target.size()); }  // C
};

// How many nodes around the current one the network looks at: a large world looks like those it was trained on, and its
// share of a move's cost does not grow with the world. With few first visits among them it looks at more [Scope].
inline constexpr int kExplorerScope = 96;

// Scratch memory of encode(), for states of any world. One thread at a time.
struct ExplorerScratch {
  NearestFirst search;
  Horizon horizon;
  Nearby nearby;
  FirstVisits visits;
  Scope scope;
  std::vector<int> steps_to_work;
  std::vector<int> part_size;
  HangingTrees trees;
  std::vector<int> queue;
};

// The first visits of a state that are in scope.
struct SeenVisits {
  std::span<const FirstVisit> visits;  // nearest first; valid until the scratch memory is used again
  bool left_out;                       // there may be more, out of scope
};

// Appends the features of a state of any world, as far as the network looks. The batch may outlive everything else.
// Cost: what lies within the horizon.
SeenVisits encode(const Exploration& state, ExplorerScratch& scratch, ExplorerBatch& batch, int scope = kExplorerScope);

}  // namespace graphdrl
