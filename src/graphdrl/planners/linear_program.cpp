#include "graphdrl/planners/linear_program.h"

#include <ClpEventHandler.hpp>
#include <ClpSimplex.hpp>
#include <CoinPackedMatrix.hpp>
#include <algorithm>
#include <cmath>

namespace graphdrl {
namespace {

constexpr int kPrimalInfeasible = 1;        // a status of CLP
constexpr int kOverhead = 10;               // of a solve, in iterations
constexpr int kIterationsPerRow = 20;       // of one solve: more is a sign of cycling
constexpr int kFewestIterations = 2'000;    // whatever the number of rows
constexpr double kSumRounding = 1e-11;      // relative, of the sums that make a bound
constexpr double kInfeasibleMargin = 1e-6;  // by which weighted rows must be missed

// Ends the simplex method at the deadline.
class DeadlineHandler final : public ClpEventHandler {
 public:
  int event(Event event) override {
    constexpr int kGoOn = -1;
    return event == endOfIteration && passed(deadline) ? 0 : kGoOn;
  }
  ClpEventHandler* clone() const override { return new DeadlineHandler(*this); }

  Deadline deadline;
};

}  // namespace

struct LinearProgram::Solver {
  ClpSimplex model;
};

LinearProgram::LinearProgram() : solver_(std::make_unique<Solver>()) {
  ClpSimplex& model = solver_->model;
  model.setLogLevel(0);
  model.setOptimizationDirection(1);  // minimises the negative objective
  const DeadlineHandler handler;
  model.passInEventHandler(&handler);
}

LinearProgram::~LinearProgram() = default;

int LinearProgram::add_column(double objective, double lower, double upper) {
  const int column = columns();
  solver_->model.addColumn(0, nullptr, nullptr, lower, upper, -objective);
  return column;
}

void LinearProgram::add_rows(std::span<const Row> rows) {
  std::vector<double> lower;
  std::vector<double> upper;
  std::vector<CoinBigIndex> begin = {0};
  std::vector<int> columns;
  std::vector<double> values;
  for (const Row& row : rows) {
    lower.push_back(row.lower == -kUnbounded ? -COIN_DBL_MAX : row.lower);
    upper.push_back(row.upper == kUnbounded ? COIN_DBL_MAX : row.upper);
    columns.insert(columns.end(), row.columns.begin(), row.columns.end());
    values.insert(values.end(), row.values.begin(), row.values.end());
    begin.push_back(static_cast<CoinBigIndex>(columns.size()));
  }
  solver_->model.addRows(static_cast<int>(rows.size()), lower.data(), upper.data(), begin.data(), columns.data(),
                         values.data());
}

void LinearProgram::remove_slack_rows(int first) {
  ClpSimplex& model = solver_->model;
  std::vector<int> slack;
  for (int row = first; row < model.numberRows(); ++row) {
    if (model.getRowStatus(row) == ClpSimplex::basic) slack.push_back(row);
  }
  if (!slack.empty()) model.deleteRows(static_cast<int>(slack.size()), slack.data());
}

void LinearProgram::set_bounds(int column, double lower, double upper) {
  solver_->model.setColumnBounds(column, lower, upper);
}

LinearProgram::Outcome LinearProgram::solve(Deadline deadline, double work) {
  ClpSimplex& model = solver_->model;
  static_cast<DeadlineHandler*>(model.eventHandler())->deadline = deadline;
  const int size = model.numberRows() + model.numberColumns();
  const int most_iterations = static_cast<int>(
      std::min<double>(std::max(kFewestIterations, kIterationsPerRow * model.numberRows()), 1 + work / size));
  run_dual(most_iterations);
  if (model.status() == kPrimalInfeasible) {
    if (proves_infeasible()) return Outcome::kInfeasible;
    // The weights of a warm start are at times those of a solve before.
    model.allSlackBasis(true);
    run_dual(most_iterations);
    if (model.status() == kPrimalInfeasible && proves_infeasible()) return Outcome::kInfeasible;
  }
  values_.assign(model.primalColumnSolution(), model.primalColumnSolution() + model.numberColumns());
  bound_ = bound_by(model.dualRowSolution(), true);
  return model.status() == 0 ? Outcome::kOptimal : Outcome::kStopped;
}

double LinearProgram::probe(int column, double lower, double upper, int iterations) {
  ClpSimplex& model = solver_->model;
  const std::vector<unsigned char> status(model.statusArray(),
                                          model.statusArray() + model.numberRows() + model.numberColumns());
  const std::vector<double> reduced_costs = reduced_costs_;
  const double before_lower = this->lower(column);
  const double before_upper = this->upper(column);
  model.setColumnBounds(column, lower, upper);
  run_dual(iterations);
  const bool impossible = model.status() == kPrimalInfeasible && proves_infeasible();
  const double bound = impossible ? -kUnbounded : std::min(bound_, bound_by(model.dualRowSolution(), true));
  model.setColumnBounds(column, before_lower, before_upper);
  std::copy(status.begin(), status.end(), model.statusArray());
  reduced_costs_ = reduced_costs;
  return bound;
}

void LinearProgram::run_dual(int most_iterations) {
  ClpSimplex& model = solver_->model;
  model.setNumberIterations(0);
  model.setMaximumIterations(most_iterations);
  model.dual();
  work_ += std::int64_t{kOverhead + model.numberIterations()} * (model.numberRows() + model.numberColumns());
}

// Whether CLP's weights of the rows show that these cannot be met together; of which sign they are, CLP does not say.
bool LinearProgram::proves_infeasible() {
  const ClpSimplex& model = solver_->model;
  const std::unique_ptr<double[]> ray(model.infeasibilityRay());
  if (ray == nullptr) return false;
  std::vector<double> weights(ray.get(), ray.get() + model.numberRows());
  if (bound_by(weights.data(), false) < -kInfeasibleMargin) return true;
  for (double& weight : weights) weight = -weight;
  return bound_by(weights.data(), false) < -kInfeasibleMargin;
}

double LinearProgram::bound_by(const double* duals, bool with_objective) {
  ClpSimplex& model = solver_->model;
  duals_.assign(duals, duals + model.numberRows());
  const double* const row_lower = model.rowLower();
  const double* const row_upper = model.rowUpper();
  double least = 0;  // of the negative objective
  double size = 0;
  const auto add = [&](double term) {
    least += term;
    size += std::abs(term);
  };
  for (int row = 0; row < model.numberRows(); ++row) {
    double& dual = duals_[row];
    if (dual > 0 ? row_lower[row] <= -COIN_DBL_MAX : row_upper[row] >= COIN_DBL_MAX) dual = 0;
    if (dual != 0) add(dual * (dual > 0 ? row_lower[row] : row_upper[row]));
  }
  const int count = model.numberColumns();
  reduced_costs_.assign(count, 0.0);
  if (with_objective) std::copy(model.objective(), model.objective() + count, reduced_costs_.begin());
  // Not by ClpModel::transposeTimes, which takes the scaled matrix where there is one.
  const CoinPackedMatrix& matrix = *model.matrix();
  for (int column = 0; column < count; ++column) {
    double& cost = reduced_costs_[column];
    const CoinBigIndex first = matrix.getVectorFirst(column);
    for (CoinBigIndex i = first; i < first + matrix.getVectorSize(column); ++i) {
      cost -= duals_[matrix.getIndices()[i]] * matrix.getElements()[i];
    }
    add(cost * (cost > 0 ? model.columnLower()[column] : model.columnUpper()[column]));
    cost = -cost;
  }
  return -least + kSumRounding * size;
}

int LinearProgram::columns() const {
  return solver_->model.numberColumns();
}

int LinearProgram::rows() const {
  return solver_->model.numberRows();
}

double LinearProgram::lower(int column) const {
  return solver_->model.columnLower()[column];
}

double LinearProgram::upper(int column) const {
  return solver_->model.columnUpper()[column];
}

}  // namespace graphdrl
