#include "graphdrl/planners/linear_program.h"

#include <ClpEventHandler.hpp>
#include <CoinPackedMatrix.hpp>
#include <algorithm>
#include <cmath>
#include <memory>

namespace graphdrl {
namespace {

constexpr int kPrimalInfeasible = 1;        // a status of CLP
constexpr int kOverhead = 10;               // of a solve, in iterations
constexpr int kIterationsPerRow = 20;       // of one solve: more is a sign of cycling
constexpr int kFewestIterations = 2'000;    // whatever the number of rows
constexpr double kSumRounding = 1e-11;      // relative, of the sums that make a bound
constexpr double kInfeasibleMargin = 1e-6;  // by which weighted rows must be missed

// Ends the simplex method once the clock passes.
class ClockHandler final : public ClpEventHandler {
 public:
  int event(Event event) override {
    constexpr int kGoOn = -1;
    return event == endOfIteration && clock.passed() ? 0 : kGoOn;
  }
  ClpEventHandler* clone() const override { return new ClockHandler(*this); }

  Clock clock;
};

}  // namespace

LinearProgram::LinearProgram() {
  model_.setLogLevel(0);
  model_.setOptimizationDirection(1);  // minimises the negative objective
  const ClockHandler handler;
  model_.passInEventHandler(&handler);
}

int LinearProgram::add_column(double objective, double lower, double upper) {
  model_.addColumn(0, nullptr, nullptr, lower, upper, -objective);
  return columns() - 1;
}

void LinearProgram::add_rows(std::span<const Row> rows) {
  std::vector<double> lower;
  std::vector<double> upper;
  std::vector<CoinBigIndex> begin = {0};
  std::vector<int> columns;
  std::vector<double> values;
  for (const Row& row : rows) {
    lower.push_back(row.lower);
    upper.push_back(row.upper);
    columns.insert(columns.end(), row.columns.begin(), row.columns.end());
    values.insert(values.end(), row.values.begin(), row.values.end());
    begin.push_back(static_cast<CoinBigIndex>(columns.size()));
  }
  model_.addRows(static_cast<int>(rows.size()), lower.data(), upper.data(), begin.data(), columns.data(),
                 values.data());
}

void LinearProgram::remove_slack_rows(int first) {
  std::vector<int> slack;
  for (int row = first; row < rows(); ++row) {
    if (model_.getRowStatus(row) == ClpSimplex::basic) slack.push_back(row);
  }
  if (!slack.empty()) model_.deleteRows(static_cast<int>(slack.size()), slack.data());
}

LinearProgram::Outcome LinearProgram::solve(const Clock& clock, double work) {
  static_cast<ClockHandler*>(model_.eventHandler())->clock = clock;
  const int size = rows() + columns();
  const int most_iterations =
      static_cast<int>(std::min<double>(std::max(kFewestIterations, kIterationsPerRow * rows()), 1 + work / size));
  run_dual(most_iterations);
  if (model_.status() == kPrimalInfeasible) {
    if (proves_infeasible()) return Outcome::kInfeasible;
    // The weights of a warm start are at times those of a solve before.
    model_.allSlackBasis(true);
    run_dual(most_iterations);
    if (model_.status() == kPrimalInfeasible && proves_infeasible()) return Outcome::kInfeasible;
  }
  values_.assign(model_.primalColumnSolution(), model_.primalColumnSolution() + columns());
  bound_ = bound_by(model_.dualRowSolution(), true);
  return model_.status() == 0 ? Outcome::kOptimal : Outcome::kStopped;
}

double LinearProgram::probe(int column, double lower, double upper, int iterations) {
  const std::vector<unsigned char> status(model_.statusArray(), model_.statusArray() + rows() + columns());
  const std::vector<double> reduced_costs = reduced_costs_;
  const double before_lower = this->lower(column);
  const double before_upper = this->upper(column);
  model_.setColumnBounds(column, lower, upper);
  run_dual(iterations);
  const bool impossible = model_.status() == kPrimalInfeasible && proves_infeasible();
  const double bound = impossible ? -kUnbounded : std::min(bound_, bound_by(model_.dualRowSolution(), true));
  model_.setColumnBounds(column, before_lower, before_upper);
  std::copy(status.begin(), status.end(), model_.statusArray());
  reduced_costs_ = reduced_costs;
  return bound;
}

void LinearProgram::run_dual(int most_iterations) {
  model_.setNumberIterations(0);
  model_.setMaximumIterations(most_iterations);
  model_.dual();
  work_ += std::int64_t{kOverhead + model_.numberIterations()} * (rows() + columns());
}

// Whether CLP's weights of the rows show that these cannot be met together; of which sign they are, CLP does not say.
bool LinearProgram::proves_infeasible() {
  const std::unique_ptr<double[]> ray(model_.infeasibilityRay());
  if (ray == nullptr) return false;
  std::vector<double> weights(ray.get(), ray.get() + rows());
  if (bound_by(weights.data(), false) < -kInfeasibleMargin) return true;
  for (double& weight : weights) weight = -weight;
  return bound_by(weights.data(), false) < -kInfeasibleMargin;
}

double LinearProgram::bound_by(const double* duals, bool with_objective) {
  std::vector<double> weights(duals, duals + rows());
  const double* const row_lower = model_.rowLower();
  const double* const row_upper = model_.rowUpper();
  double least = 0;  // of the negative objective
  double size = 0;
  const auto add = [&](double term) {
    least += term;
    size += std::abs(term);
  };
  for (int row = 0; row < rows(); ++row) {
    double& dual = weights[row];
    if (dual > 0 ? row_lower[row] <= -COIN_DBL_MAX : row_upper[row] >= COIN_DBL_MAX) dual = 0;
    if (dual != 0) add(dual * (dual > 0 ? row_lower[row] : row_upper[row]));
  }
  const int count = columns();
  reduced_costs_.assign(count, 0.0);
  if (with_objective) std::copy(model_.objective(), model_.objective() + count, reduced_costs_.begin());
  // Not by ClpModel::transposeTimes, which takes the scaled matrix where there is one.
  const CoinPackedMatrix& matrix = *model_.matrix();
  for (int column = 0; column < count; ++column) {
    double& cost = reduced_costs_[column];
    const CoinBigIndex first = matrix.getVectorFirst(column);
    for (CoinBigIndex i = first; i < first + matrix.getVectorSize(column); ++i) {
      cost -= weights[matrix.getIndices()[i]] * matrix.getElements()[i];
    }
    add(cost * (cost > 0 ? model_.columnLower()[column] : model_.columnUpper()[column]));
    cost = -cost;
  }
  return -least + kSumRounding * size;
}

}  // namespace graphdrl
