#include "graphdrl/planners/bound.h"

#include <algorithm>
#include <cmath>
#include <queue>

#include "graphdrl/planners/walk_relaxation.h"

namespace graphdrl {
namespace {

using Outcome = LinearProgram::Outcome;

constexpr std::int64_t kMostEdges = 4'000;
constexpr int kRoundsOfCuts = 5;     // in a branch
constexpr double kLeastFall = 0.01;  // of the bound by a round of cuts, in steps of prize or parts of the bound
constexpr int kPatience = 5;         // rounds of cuts at the root without such a fall

class BranchAndCut final : public LpBound {
 public:
  BranchAndCut(const Task& task, double bound) : task_(task), relaxation_(task), bound_(bound) {
    for (int column = 0; column < program().columns(); ++column) {
      root_bounds_.push_back({column, program().lower(column), program().upper(column)});
    }
  }

  void cut(double prize, Effort effort) override {
    begin(prize, effort);
    apply({});
    double last = kNoLimit;
    for (int tired = 0; tired < kPatience && !beaten(bound_) && !spent();) {
      const Outcome outcome = solve();
      bound_ = std::min(bound_, rounded(program().bound()));
      if (outcome != Outcome::kOptimal) break;
      const bool falls = last - program().bound() >= kLeastFall * scale();
      if (falls) relaxation_.remove_slack_rows();
      if (relaxation_.separate(effort_.clock) == 0) break;
      tired = falls ? 0 : tired + 1;
      last = std::min(last, program().bound());
    }
  }

  void branch(double prize, Effort effort) override {
    begin(prize, effort);
    if (!begun_) parts_.push({bound_, kNoLimit, 0, {}});
    begun_ = true;
    settle_bound();
    for (bool go_on = true; go_on && !beaten(bound_) && !spent(); settle_bound()) {
      Part part = parts_.top();
      parts_.pop();
      go_on = branch_on(std::move(part));
    }
  }

  double bound() const override { return beaten(bound_) ? prize_ : bound_; }
  const std::vector<NodeId>& walk() const override { return walk_; }

 private:
  using Change = WalkRelaxation::Change;

  // A part of all walks.
  struct Part {
    double bound;
    double estimate;  // the bound before it was rounded down
    int depth;
    std::vector<Change> changes;

    // A queue has the highest bound on top; of several, the deepest, for it is near to an end.
    bool operator<(const Part& other) const {
      if (bound != other.bound) return bound < other.bound;
      return depth != other.depth ? depth < other.depth : estimate < other.estimate;
    }
  };

  LinearProgram& program() { return relaxation_.program(); }

  // What walks can be worth at most, as prizes add up in steps.
  double rounded(double bound) const {
    const double step = relaxation_.prize_step();
    return step > 0 ? std::floor(bound / step + kStepRounding) * step : bound;
  }

  // Whether no walk within this bound is better than the best one known.
  bool beaten(double bound) const {
    const double step = relaxation_.prize_step();
    return bound <= (step > 0 ? prize_ + 0.5 * step : prize_ * (1 + kBoundMargin) + 1e-12);
  }
  // A step of prize, or where there is none all of it.
  double scale() const { return relaxation_.prize_step() > 0 ? relaxation_.prize_step() : prize_; }
  void begin(double prize, const Effort& effort) {
    prize_ = std::max(prize_, prize);
    effort_ = effort;
    work_before_ = relaxation_.work();
  }
  double work_left() const { return effort_.work - static_cast<double>(relaxation_.work() - work_before_); }
  bool spent() const { return effort_.clock.passed() || work_left() <= 0; }
  Outcome solve() { return program().solve(effort_.clock, work_left()); }

  void apply(const std::vector<Change>& changes) {
    for (const Change& change : applied_) {
      const Change& root = root_bounds_[change.column];
      program().set_bounds(root.column, root.lower, root.upper);
    }
    for (const Change& change : changes) program().set_bounds(change.column, change.lower, change.upper);
    applied_ = changes;
  }

  // Columns that cannot leave their bound in a better walk stay there.
  void fix_by_reduced_costs(std::vector<Change>& changes) {
    const double step = relaxation_.prize_step();
    const double goal = step > 0 ? (std::floor(prize_ / step + kStepRounding) + 1 - 2 * kStepRounding) * step : prize_;
    const double slack = program().bound() - goal;
    const auto costs = program().reduced_costs();
    for (int column = 0; column < program().columns(); ++column) {
      const double lower = program().lower(column);
      const double upper = program().upper(column);
      if (lower == upper || slack >= std::abs(costs[column])) continue;
      const double kept = costs[column] < 0 ? lower : upper;
      changes.push_back({column, kept, kept});
      program().set_bounds(column, kept, kept);
    }
    applied_ = changes;
  }

  void take_walk() {
    std::vector<NodeId> walk = relaxation_.walk();
    const Plan plan = plan_of_walk(task_, walk);
    const bool ends_well = task_.ends_anywhere() || walk.back() == task_.end();
    if (plan.cost > task_.limit() || !ends_well || plan.prize <= prize_) return;
    prize_ = plan.prize;
    walk_ = std::move(walk);
  }

  // Solves a part with rounds of cuts, until it is beaten or cuts do not help.
  Outcome solve_part(Part& part) {
    apply(part.changes);
    double last = kNoLimit;
    for (int round = 0;; ++round) {
      if (spent()) return Outcome::kStopped;
      const Outcome outcome = solve();
      if (outcome == Outcome::kInfeasible) return outcome;
      part.estimate = std::min(part.estimate, program().bound());
      part.bound = std::min(part.bound, rounded(part.estimate));
      if (outcome != Outcome::kOptimal || beaten(part.bound)) return outcome;
      const bool falls = round < kRoundsOfCuts && last - part.estimate >= kLeastFall * scale();
      if (!falls && !relaxation_.integral()) return outcome;
      last = part.estimate;
      if (relaxation_.separate(effort_.clock) == 0) return outcome;
    }
  }

  // Solves a part, and puts back what is left of it to solve. Whether to go on.
  bool branch_on(Part part) {
    relaxation_.remove_slack_rows();
    const Outcome outcome = solve_part(part);
    if (outcome == Outcome::kInfeasible || beaten(part.bound)) return true;
    WalkRelaxation::Branches branches;
    if (outcome != Outcome::kStopped) {
      const bool integral = relaxation_.integral();
      if (integral) take_walk();
      if (beaten(part.bound)) return true;
      if (!integral) fix_by_reduced_costs(part.changes);
      if (!integral) branches = relaxation_.branches();
    }
    if (branches.first.empty() && branches.second.empty()) {  // late, or by rounding
      parts_.push(std::move(part));
      return false;
    }
    for (const auto& changes : {branches.first, branches.second}) {
      Part child = part;
      ++child.depth;
      child.changes.insert(child.changes.end(), changes.begin(), changes.end());
      parts_.push(std::move(child));
    }
    return true;
  }

  void settle_bound() { bound_ = parts_.empty() ? prize_ : std::min(bound_, std::max(prize_, parts_.top().bound)); }

  Task task_;
  WalkRelaxation relaxation_;
  Effort effort_;
  std::int64_t work_before_ = 0;  // the effort began
  double prize_ = 0;
  double bound_;
  std::vector<NodeId> walk_;
  std::vector<Change> root_bounds_;
  std::vector<Change> applied_;
  std::priority_queue<Part> parts_;
  bool begun_ = false;
};

}  // namespace

std::unique_ptr<LpBound> make_lp_bound(const Task& task, double bound) {
  if (task.view().open().edge_count() > kMostEdges) return nullptr;
  return std::make_unique<BranchAndCut>(task, bound);
}

bool has_lp_bound() {
  return true;
}

}  // namespace graphdrl
