// Walks over edges: how many different ones a budget pays for.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "graphdrl/base/clock.h"
#include "graphdrl/env/task.h"
#include "graphdrl/graph/postman.h"
#include "graphdrl/planners/plan.h"

namespace graphdrl {

// All edges of a world, loops and parallel ones too: those of its file, or Graph::edges() where that has no list of its
// own.
Multigraph all_edges(const World& world);

// Those that can be walked.
struct WalkableEdges {
  Multigraph graph;
  std::vector<std::int64_t> numbers;  // [edges], among all_edges()
};
WalkableEdges walkable_edges(const World& world);

struct EdgeCover {
  EdgeWalk walk;                          // with the numbers of WalkableEdges::numbers
  std::int64_t walked = 0;                // different edges
  std::int64_t edges = 0;                 // that there are
  double prize = 0;                       // of those walked: their number, unless edges have prizes
  double total_prize = 0;                 // of all
  bool has_prizes = false;                // some edge is worth other than 1
  double bound = 0;                       // no walk within the budget has a higher prize
  bool all_cheapest = false;              // it walks all, and none that does is cheaper
  double least_cost = 0;                  // of any walk over all edges, where this is one; 0 where that is not known
  std::string policy = {};                // what made it, where that was none of plan_nodes
  std::optional<double> reset_cost = {};  // of jumps to the start that walks may make

  // Whether no walk has a higher prize, or one as high for less where that is all.
  bool optimal() const { return walked == edges ? all_cheapest : prize >= bound; }
  double percent(double part) const { return total_prize == 0 ? 100.0 : 100.0 * part / total_prize; }  // of a prize
};

// A walk over edges that are worth as much as can be within the task's budget; among those over all edges the cheapest
// [postman_walk()]. An edge is worth its own prize, else 1, whatever the nodes' prizes are.
//
// Where not all can be walked: graphs of up to kExactEdges edges are searched by states. A directed graph is planned as
// nodes are, on a graph with a node in the middle of each edge. Others by the beginning of the cheapest walk over all,
// and by going to the nearest edge left again and again, with distances that seem a little longer by chance;
// the best of these counts.
//
// plan_nodes: plans a task of a world, within a clock. reset_cost: of a jump to the start, in a directed graph.
inline constexpr std::int64_t kExactEdges = 12;
EdgeCover cover_edges(const World& world, const Task& task, std::optional<double> reset_cost,
                      const std::function<Plan(const World&, const Task&)>& plan_nodes);

// What a walk of any origin covers, and the bound of the cheapest edges. walk: with the numbers of
// WalkableEdges::numbers.
EdgeCover judge_edges(const World& world, const Task& task, std::optional<double> reset_cost, EdgeWalk walk);

}  // namespace graphdrl
