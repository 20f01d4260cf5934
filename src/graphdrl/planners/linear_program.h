// Linear programs, solved by CLP (github.com/coin-or/Clp).
#pragma once

#include <ClpSimplex.hpp>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "graphdrl/planners/plan.h"

namespace graphdrl {

// Maximise the sum of objective · x, where lower <= x <= upper and each row's sum of value · x is within its bounds.
// Columns come first, then rows; rows may come and go, the simplex method goes on from the last basis. Prints nothing.
// One thread at a time. The same calls give the same answers, but for deadlines.
class LinearProgram {
 public:
  static constexpr double kUnbounded = std::numeric_limits<double>::infinity();

  struct Row {
    double lower = -COIN_DBL_MAX;
    double upper = COIN_DBL_MAX;
    std::vector<int> columns = {};
    std::vector<double> values = {};

    void add(int column, double value) {  // nothing for column -1
      if (column < 0) return;
      columns.push_back(column);
      values.push_back(value);
    }
  };

  enum class Outcome {
    kOptimal,
    kInfeasible,  // proved: by weights of rows whose sum cannot be met
    kStopped,     // at the deadline, by too many iterations, or by numbers that do not add up
  };

  LinearProgram();
  LinearProgram(const LinearProgram&) = delete;  // a program is large

  // Its number. REQUIRES: finite bounds, no rows yet.
  int add_column(double objective, double lower, double upper);
  void add_rows(std::span<const Row> rows);
  // Takes out the rows from `first` on that do not bind in the last solution.
  void remove_slack_rows(int first);
  void set_bounds(int column, double lower, double upper) { model_.setColumnBounds(column, lower, upper); }

  // Dual simplex, until the clock passes or so much work more [work()], about.
  Outcome solve(const Clock& clock, double work = kUnbounded);

  // The bound after so many iterations with other bounds of a column; kUnbounded below zero where there is no solution.
  // Leaves everything as the last solve did. REQUIRES: that solve was optimal.
  double probe(int column, double lower, double upper, int iterations);

  int columns() const { return model_.numberColumns(); }
  int rows() const { return model_.numberRows(); }
  double lower(int column) const { return model_.columnLower()[column]; }
  double upper(int column) const { return model_.columnUpper()[column]; }
  // Up to now: iterations, each times the rows and columns there were. A million takes about 30 ms.
  std::int64_t work() const { return work_; }

  // Of the last solve.
  std::span<const double> values() const { return values_; }
  // No solution has a higher objective. From the dual values and the bounds of columns alone, so that it holds whatever
  // the solver's tolerances are and wherever it stopped [Neumaier and Shcherbina 2004].
  double bound() const { return bound_; }
  // By how much the bound falls, at least, where a column is 1 above its lower bound (negative) or below its upper one
  // (positive), for each unit.
  std::span<const double> reduced_costs() const { return reduced_costs_; }

 private:
  void run_dual(int most_iterations);
  bool proves_infeasible();
  // Computes the bound that weights of the rows prove, and the reduced costs. with_objective: else of 0.
  double bound_by(const double* duals, bool with_objective);

  ClpSimplex model_;
  std::vector<double> values_;
  std::vector<double> reduced_costs_;
  double bound_ = kUnbounded;
  std::int64_t work_ = 0;
};

}  // namespace graphdrl
