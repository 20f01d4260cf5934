// The linear relaxation of all walks that a task allows, tightened by cutting planes as in branch and cut for the
// orienteering problem [Fischetti, Salazar González and Toth 1998], on the edges of the graph itself.
//
// Columns: y[v] in [0, 1], node v is visited; z[v] in [0, 1], the walk ends there. In an undirected graph u[e], edge e
// is used once; w[e], twice. No best walk uses it more often: two uses less keep it connected and its degrees' parity.
// In a directed graph x[a], how often an arc is used.
//
// Rows, with s the start, S a set of nodes without s, and x = u + 2 w:
//   cost        sum of c x <= budget, rounded down to what costs can add up to; where, by parity,
//               no walk that ends at v costs exactly that, a step less for v
//   ends        sum of z = 1, z[v] <= y[v]
//   degrees     x(δ(v)) + z[v] >= 2 y[v]; directed: x(in(v)) >= y[v], and as often out of v as into it
//   edges       u[e] + w[e] <= y[v] for both its nodes
//   connection  x(δ(S)) + z(S) >= 2 y[v] for v in S; directed: x(in(S)) >= y[v]
//   blocks      y[v] <= y[r], where r parts v's block from the start
//   partition   (u + w)(edges between V0, V1 … Vk) >= y[v1] + … + y[vk], for parts of V with s in V0 and vi in Vi
//   parity      u(F) - u(δ(S) \ F) -+ z(S) <= |F| - (0 or 1) for any F in δ(S): of the u in δ(S) and z(S),
//               an even number is 1
// Cost, degrees and the sum of ends are rows from the beginning, the others once a solution violates them: connection
// by maximum flows from each node to the start, parity for components of fractional edges.
#pragma once

#include <functional>
#include <vector>

#include "graphdrl/graph/max_flow.h"
#include "graphdrl/planners/bound.h"
#include "graphdrl/planners/linear_program.h"

namespace graphdrl {

inline constexpr double kStepRounding = 1e-6;  // of a step in which costs or prizes add up

class WalkRelaxation {
 public:
  struct Change {  // of a column's bounds
    int column;
    double lower;
    double upper;
  };
  struct Branches {
    std::vector<Change> first;
    std::vector<Change> second;
  };

  explicit WalkRelaxation(const Task& task);

  LinearProgram& program() { return program_; }
  // Up to now, in the unit of LinearProgram::work(), maximum flows included.
  std::int64_t work() const { return program_.work() + scanned_ / kArcsPerWork; }
  // Prizes add up to multiples of it; 0 where nothing is known.
  double prize_step() const { return prize_step_; }

  // Takes out the rows added by separate() that do not bind.
  void remove_slack_rows() { program_.remove_slack_rows(fixed_rows_); }
  // Adds rows that the last solution violates, as many as it finds until the deadline. Their number.
  int separate(const Clock& clock);
  // Of the last solution.
  bool integral() const;
  // Two parts without the last solution, which together hold every walk: first by ends, then by a visit or an edge.
  // REQUIRES: the solution is optimal and not integral.
  Branches branches();
  // The walk that an integral solution is, once it violates no row.
  std::vector<NodeId> walk() const;

 private:
  struct Arc {  // of an edge: from its lower node to the higher, or as it leads
    int from;
    int to;
    double cost;
    int once;   // column; of a directed graph how often
    int twice;  // column; -1 in a directed graph
    int other_end(int node) const { return from + to - node; }
  };
  void add_columns(const Task& task);
  void add_rows(const Task& task);
  std::vector<bool> odd_ends(double step, double budget) const;
  Branches halve_ends() const;
  std::vector<int> least_integral_columns() const;
  Branches split_a_column();

  double value(int column) const { return column < 0 ? 0 : program_.values()[column]; }
  double uses(const Arc& arc) const { return value(arc.once) + 2 * value(arc.twice); }
  double taken(const Arc& arc) const { return value(arc.once) + value(arc.twice); }  // whether used at all
  static void add_uses(LinearProgram::Row& row, const Arc& arc, double factor) {
    row.add(arc.once, factor);
    row.add(arc.twice, 2 * factor);
  }
  void add_ends(LinearProgram::Row& row, double factor, const std::vector<char>& inside) const;

  void separate_simple();
  std::vector<int> components(const std::function<bool(const Arc&)>& joins) const;
  void separate_parity(const Clock& clock);
  void separate_parity_cuts(const Clock& clock);
  void separate_parity_of(const std::vector<int>& component);
  void add_parity_row(const std::vector<int>& component, int which);
  void separate_partitions();
  void separate_partition(const std::vector<int>& component);
  void separate_connection(const Clock& clock);
  void add_connection_row(int node);

  static constexpr std::int64_t kArcsPerWork = 10;

  LinearProgram program_;
  bool directed_;
  double prize_step_ = 0;
  int fixed_rows_ = 0;
  std::vector<NodeId> nodes_;     // [n], the start first
  std::vector<int> visit_;        // [n], columns
  std::vector<int> end_;          // [n], columns; -1 where no walk ends
  std::vector<int> depth_first_;  // [n], nodes: what is near stands together
  std::vector<int> parent_;       // [n], the root of its block; -1 for the start
  std::vector<Arc> arcs_;
  std::vector<std::vector<int>> at_;  // [n], arcs
  std::vector<LinearProgram::Row> found_;
  MaxFlow network_;            // flow goes from a node back to the start, which is node n; an end is an arc to it
  std::int64_t scanned_ = 0;   // arcs of all flows
  std::vector<int> to_start_;  // [n], its arcs
};

}  // namespace graphdrl
