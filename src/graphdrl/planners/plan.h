// Planners, which think out a whole walk before its first step is taken, and the plans they make.
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "graphdrl/env/task.h"
#include "graphdrl/graph/search.h"

namespace graphdrl {

// When a planner must be done; empty where it may take as long as it takes.
using Deadline = std::optional<std::chrono::steady_clock::time_point>;
using TimeLimit = std::optional<std::chrono::duration<double>>;

Deadline deadline_after(TimeLimit limit);

// Asks every planner of the process to end now, as if its deadline had passed, and those that begin later. A signal
// handler may.
void stop_planning();

// Within its scope, planners on this thread, and in the tasks of its parallel loops, end when a flag becomes true, as
// if their deadlines had passed. The flag must outlive the scope. The flag of an inner scope replaces that of an outer
// one.
class StopScope {
 public:
  explicit StopScope(const std::atomic<bool>& stop);
  StopScope(const StopScope&) = delete;
  ~StopScope();

 private:
  const void* before_;
};

// Whether stop_planning() or a StopScope asks this thread's planner to end.
bool planning_stopped();

inline bool passed(Deadline deadline) {
  return planning_stopped() || (deadline && std::chrono::steady_clock::now() >= *deadline);
}

inline constexpr double kPrizeRounding = 1e-12;  // relative, of sums of prizes in whatever order

struct Plan {
  std::vector<NodeId> walk;  // every step, the start first
  int visited = 0;           // valid nodes, those before the walk among them
  double prize = 0;          // of the nodes first visited on the walk, and of its start where that is new
  double cost = 0;
  double bound = std::numeric_limits<double>::infinity();  // no walk has a higher prize
  bool optimal = false;                                    // proved so: no walk has a higher prize
};

// Whether one plan is better: by prize, then by cost.
bool better(const Plan& one, const Plan& other);

// The better one; of two as good the one that is proved optimal, else the first.
Plan better_of(Plan first, Plan second);

// The plan that a walk is: what it visits, is worth and costs. A repeated node is a blocked move and costs 1. Cost:
// O(steps). REQUIRES: every other step follows an edge.
Plan plan_of_walk(const Task& task, std::vector<NodeId> walk, bool optimal = false);

// How far a planner is. Told now and then while it works, on the thread that called it.
struct PlanProgress {
  int visited;                                             // nodes, by the walk under way, or by the best one
  double bound = std::numeric_limits<double>::infinity();  // as of plans
};
using Report = std::function<void(const PlanProgress&)>;

// Answers tasks. Keeps scratch memory: one thread at a time.
class Planner {
 public:
  virtual ~Planner() = default;

  // The best walk it finds. Once the deadline passes, the best walk so far, which ends where the task says; the walk of
  // the start alone where there is nothing else. Throws Error on a task that it cannot answer.
  virtual Plan plan(const Task& task, Deadline deadline = {}, const Report& report = {}) = 0;

  // Whether its plans have a bound beside them.
  virtual bool bounds() const { return false; }
};

// The walk that makes these first visits one after the other, each by the cheapest way through visited ground.
// Goes on to where the task says it must end. REQUIRES: there are such ways.
std::vector<NodeId> walk_through(const Task& task, std::span<const NodeId> first_visits, NearestFirst& search);

// Appends the cheapest way from a walk's last node to another. REQUIRES: there is one.
void append_way_to(const View& view, NodeId node, std::vector<NodeId>& walk, NearestFirst& search);

// Likewise to where the task says that it must end, if anywhere.
void append_way_to_end(const Task& task, std::vector<NodeId>& walk, NearestFirst& search);

// Looks at the clock once in `every` units of work, and reports to whoever listens.
class Ticker {
 public:
  static constexpr int kNodesPerUnit = 64;  // nodes met in a search that take as long as one unit

  Ticker(Deadline deadline, const Report& report, int every) : deadline_(deadline), report_(&report), every_(every) {}

  // Whether the deadline has passed, after so many units of work. visited: by the walk under way.
  bool tick(int visited, int units = 1) {
    done_ += units;
    if (done_ < every_) return false;
    done_ = 0;
    if (*report_) (*report_)({.visited = visited});
    return passed(deadline_);
  }

 private:
  Deadline deadline_;
  const Report* report_;
  int every_;
  int done_ = 0;
};

}  // namespace graphdrl
