#include "graphdrl/planners/parts.h"

#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

#include "graphdrl/base/parallel.h"
#include "graphdrl/base/random.h"
#include "graphdrl/planners/annealing.h"
#include "graphdrl/planners/baselines.h"
#include "graphdrl/planners/covering_walk.h"
#include "graphdrl/planners/tour.h"

namespace graphdrl {
namespace {

// By what is visited at 1.0x in 10 s on two threads, of 8,000 nodes; beside each number what others lose. On 100×100
// cells of which a fifth is blocked, and for kAround in mazes (M) and geometric graphs (G) too.
constexpr int kLeastLength = 250;         // steps of a part; up to twice as many. From 120: 13; from 500: 50
constexpr double kAround = 2;             // times the nodes of a part, that are looked at. 1.5: 30 to 90 (M); 3: 40 (G)
constexpr double kPartPrice = 0.8;        // of a unit of cost, of what the walk brings for one. 0.65: 30; 0.9: 10
constexpr double kProgress = 0.99;        // through the schedule of annealing, all the time. 0.95: 15; from 0.6 on: 50
constexpr std::int64_t kFirstSteps = 50;  // for each target; twice as many in each sweep. 400: 8
constexpr int kMostDoublings = 6;
constexpr int kMostInVain = 3;  // sweeps

constexpr double kMoreCost = 0.1;    // that a part may come to cost, as a share …
constexpr double kMoreEdges = 4;     // … and in mean edges
constexpr double kLeastWaste = 0.5;  // steps that bring nothing, of a part that is looked at
constexpr std::size_t kBatch = 256;  // parts between two settlements of the budget
constexpr int kStepsAtOnce = 256;    // of annealing, between two looks at the clock

struct Part {
  std::vector<NodeId> walk = {};  // its last node is the first of the next part
  double prize = 0;
  double cost = 0;
};

// What a part is about, and what it becomes.
struct Job {
  int part;
  std::vector<NodeId> nodes = {};   // by their numbers in a small world
  std::vector<double> prizes = {};  // there
  Part found = {};                  // no walk where nothing better was found
  std::int64_t steps = 0;
};

// A part that costs more and brings more.
struct Upgrade {
  int number;
  Part part;
  double ratio;  // what it brings for a unit of cost
};

double step_cost(const Graph& open, NodeId from, NodeId to) {
  return from == to ? 1.0 : open.cost(from, open.index_of(from, to));  // a blocked move costs 1
}

// A part as a task of its own, and its walk there.
class PartWorld {
 public:
  PartWorld(const Task& whole, const Job& job, const Part& part, bool ends_anywhere)
      : graph_(graph_of(whole.view().open(), job)), task_(task_of(whole, job, part, ends_anywhere)) {}

  const Task& task() const { return task_; }
  const std::vector<NodeId>& walk() const { return walk_; }

 private:
  int number_of(NodeId node) const {
    const auto found = std::lower_bound(numbers_.begin(), numbers_.end(), std::pair(node, 0));
    return found != numbers_.end() && found->first == node ? found->second : -1;
  }

  Graph graph_of(const Graph& open, const Job& job) {
    const auto count = static_cast<NodeId>(job.nodes.size());
    for (NodeId number = 0; number < count; ++number) numbers_.emplace_back(job.nodes[number], number);
    std::sort(numbers_.begin(), numbers_.end());
    std::vector<Edge> edges;
    for (NodeId from = 0; from < count; ++from) {
      const auto neighbours = open.neighbours(job.nodes[from]);
      for (int i = 0; i < std::ssize(neighbours); ++i) {
        const NodeId to = number_of(neighbours[i]);
        if (to < 0 || (!open.directed() && to < from)) continue;
        edges.push_back({.a = from, .b = to, .cost = open.cost(job.nodes[from], i)});
      }
    }
    return Graph::from_edges(count, edges, open.directed() ? EdgeKind::kDirected : EdgeKind::kUndirected);
  }

  Task task_of(const Task& whole, const Job& job, const Part& part, bool ends_anywhere) {
    for (const NodeId node : part.walk) walk_.push_back(number_of(node));
    const double limit = part.cost * (1 + kMoreCost) + kMoreEdges * whole.view().open().mean_cost();
    const View view(make_known({.name = whole.view().name(),
                                .open = std::move(graph_),
                                .blocked = std::vector<bool>(job.nodes.size()),
                                .prizes = job.prizes}));
    return {view, walk_.front(), limit, ends_anywhere ? End::anywhere() : End::at(walk_.back())};
  }

  std::vector<std::pair<NodeId, NodeId>> numbers_;  // of nodes of the whole, which ascend
  std::vector<NodeId> walk_;
  Graph graph_;
  Task task_;
};

// The best walk up to now, and its parts.
class Parts {
 public:
  Parts(const Task& task, Plan best, std::uint64_t seed)
      : task_(task),
        open_(task.view().open()),
        seed_(seed),
        best_(std::move(best)),
        first_of_(open_.node_count(), kNobody),
        is_met_(open_.node_count()) {
    double prize = 0;
    for (const NodeId node : task.reach().nodes) prize += task.prize(node);
    mean_prize_ = prize / static_cast<double>(task.reach().nodes.size());
    if (task.ends_anywhere()) walking_on_ = kPartPrice * mean_prize_ / open_.mean_cost();
  }

  bool is_done() const { return meets(best_.prize, best_.bound); }
  const Plan& best() const { return best_; }
  Plan take() && { return std::move(best_); }

  // Goes over the walk once, cut at other places each time; parts that waste most come first. steps: at most about so
  // many. Gives how many it took.
  std::int64_t sweep(int number, std::int64_t steps, const Clock& clock) {
    Rng rng(derive_seed(seed_, 0, static_cast<std::uint64_t>(number)));
    cut(kLeastLength + rng.index(kLeastLength), rng);
    std::vector<std::pair<double, int>> order;
    for (int part = 0; part < std::ssize(parts_); ++part) {
      const double waste = parts_[part].cost / open_.mean_cost() - parts_[part].prize / mean_prize_;
      if (waste >= kLeastWaste) order.emplace_back(-waste, part);
    }
    std::sort(order.begin(), order.end());
    price_ = kPartPrice * best_.prize / best_.cost;
    std::int64_t taken = 0;
    for (std::size_t first = 0; first < order.size() && taken < steps; first += kBatch) {
      if (clock.passed() || is_done()) break;
      std::vector<Job> jobs;
      std::int64_t planned = taken;
      for (std::size_t i = first; i < std::min(first + kBatch, order.size()) && planned < steps; ++i) {
        jobs.push_back(job_of(order[i].second));
        planned += steps_for(number, static_cast<int>(parts_[order[i].second].walk.size()));
      }
      parallel_for(static_cast<int>(jobs.size()), [&](int i) { solve(jobs[i], number, clock); });
      for (const Job& job : jobs) taken += job.steps;
      settle(jobs);
      clock.tell({.visited = best_.visited, .bound = best_.bound});
    }
    return taken;
  }

 private:
  static constexpr int kNobody = -1;

  static std::int64_t steps_for(int sweep, int targets) {
    return kFirstSteps * targets << std::min(sweep, kMostDoublings);
  }

  void cut(int length, Rng& rng) {
    const auto steps = static_cast<int>(best_.walk.size()) - 1;
    parts_.clear();
    for (int first = 0, last = 1 + rng.index(length); first < steps; first = last, last += length) {
      last = std::min(last, steps);
      parts_.push_back({.walk = {best_.walk.begin() + first, best_.walk.begin() + last + 1}});
    }
    claim();
  }

  // Each node counts for the part that visits it first.
  void claim() {
    std::fill(first_of_.begin(), first_of_.end(), kNobody);
    for (int number = 0; number < std::ssize(parts_); ++number) {
      Part& part = parts_[number];
      part.prize = 0;
      part.cost = 0;
      for (std::size_t i = 0; i < part.walk.size(); ++i) {
        const NodeId node = part.walk[i];
        if (i > 0) part.cost += step_cost(open_, part.walk[i - 1], node);
        if (first_of_[node] != kNobody) continue;
        first_of_[node] = number;
        part.prize += task_.prize(node);
      }
    }
  }

  // The part and what lies around. What nobody visits, it may: no other part of the batch.
  Job job_of(int number) {
    Job job{.part = number};
    const auto meet = [&](NodeId node) {
      if (is_met_[node] != 0) return;
      is_met_[node] = 1;
      if (first_of_[node] == kNobody && task_.reach().contains[node]) first_of_[node] = number;
      job.nodes.push_back(node);
      job.prizes.push_back(first_of_[node] == number ? task_.prize(node) : 0);
    };
    for (const NodeId node : parts_[number].walk) meet(node);
    const auto most = static_cast<std::size_t>(kAround * static_cast<double>(job.nodes.size()));
    for (std::size_t i = 0; i < job.nodes.size() && job.nodes.size() < most; ++i) {
      for (const NodeId next : task_.view().open_neighbours(job.nodes[i])) meet(next);
    }
    for (const NodeId node : job.nodes) is_met_[node] = 0;
    return job;
  }

  void solve(Job& job, int sweep, const Clock& clock) const {
    if (clock.passed()) return;
    const Part& part = parts_[job.part];
    const bool is_last = job.part + 1 == std::ssize(parts_);
    const PartWorld world(task_, job, part, is_last && task_.ends_anywhere());
    const Plan now = plan_of_walk(world.task(), world.walk());
    const Targets targets(world.task());
    if (targets.end() <= 1) return;
    const std::uint64_t seed = derive_seed(seed_, 1 + static_cast<std::uint64_t>(sweep), job.part);
    Annealing annealing(targets, world.task().limit(), seed, tour_of(world.task(), targets, now), price_);
    const std::int64_t steps = steps_for(sweep, targets.end());
    while (job.steps < steps && !clock.passed()) {
      for (int i = 0; i < kStepsAtOnce; ++i) annealing.step(kProgress);
      job.steps += kStepsAtOnce;
    }
    const Plan found = plan_of_walk(world.task(), walk_of(world.task(), targets, annealing.best().order));
    if (found.prize - price_ * found.cost <= now.prize - price_ * now.cost) return;
    job.found = {.walk = {}, .prize = part.prize + (found.prize - now.prize), .cost = found.cost};
    for (const NodeId number : found.walk) job.found.walk.push_back(job.nodes[number]);
  }

  // Takes what was found: first of each part what costs least, then what brings most for the rest of the budget.
  void settle(std::vector<Job>& jobs) {
    const std::vector<Part> before = parts_;
    std::vector<Upgrade> upgrades;
    for (Job& job : jobs) {
      Part& part = parts_[job.part];
      Part& found = job.found;
      if (found.walk.empty()) continue;
      if (found.cost <= part.cost) std::swap(part, found);
      const double ratio = (found.prize - part.prize) / (found.cost - part.cost);
      if (found.prize > part.prize) upgrades.push_back({.number = job.part, .part = std::move(found), .ratio = ratio});
    }
    std::stable_sort(upgrades.begin(), upgrades.end(), [](const auto& a, const auto& b) { return a.ratio > b.ratio; });
    double left = task_.limit();
    for (const Part& part : parts_) left -= part.cost;
    upgrade(upgrades, walking_on_, left);
    if (task_.ends_anywhere() && left >= open_.mean_cost()) walk_on(left);
    upgrade(upgrades, 0, left);

    Plan plan = joined();
    if (plan.cost <= task_.limit() && better(plan, best_)) {
      plan.bound = best_.bound;
      best_ = std::move(plan);
    } else {
      parts_ = before;
    }
    claim();
  }

  // Takes upgrades that bring so much for a unit of cost, while they can be paid for.
  void upgrade(std::vector<Upgrade>& upgrades, double least, double& left) {
    std::erase_if(upgrades, [&](Upgrade& one) {
      const double more = one.part.cost - parts_[one.number].cost;
      if (one.ratio < least || more > left) return false;
      left -= more;
      parts_[one.number] = std::move(one.part);
      return true;
    });
  }

  // Goes on where the walk ends.
  void walk_on(double& left) {
    NodeSet visited = task_.ground();
    for (const Part& part : parts_) {
      for (const NodeId node : part.walk) visited.insert(node);
    }
    Part& last = parts_.back();
    const Task rest = task_.rest(last.walk.back(), left, std::move(visited));
    Plan more = NearestPlanner().plan(rest);
    if (covering_fits(rest)) more = better_of(std::move(more), covering_plan(rest));
    last.walk.insert(last.walk.end(), more.walk.begin() + 1, more.walk.end());
    walking_on_ = more.prize / left;
    left -= more.cost;
  }

  Plan joined() const {
    std::vector<NodeId> walk = {task_.start()};
    for (const Part& part : parts_) walk.insert(walk.end(), part.walk.begin() + 1, part.walk.end());
    return plan_of_walk(task_, std::move(walk));
  }

  const Task& task_;
  const Graph& open_;
  std::uint64_t seed_;
  Plan best_;
  double mean_prize_;
  double price_ = 0;       // of a unit of cost
  double walking_on_ = 0;  // what a unit of cost brought there
  std::vector<Part> parts_;
  std::vector<int> first_of_;  // [N], the part that visits a node first, or that may
  std::vector<char> is_met_;   // [N], 0 between two jobs
};

}  // namespace

Plan improve_by_parts(const Task& task, Plan best, std::int64_t steps, std::uint64_t seed, const Clock& clock) {
  Parts parts(task, std::move(best), seed);
  std::int64_t left = steps > 0 ? steps : std::numeric_limits<std::int64_t>::max();
  int in_vain = 0;
  for (int sweep = 0; left > 0 && in_vain < kMostInVain && !clock.passed() && !parts.is_done(); ++sweep) {
    const double prize = parts.best().prize;
    left -= parts.sweep(sweep, left, clock);
    in_vain = parts.best().prize > prize ? 0 : in_vain + 1;
  }
  return std::move(parts).take();
}

}  // namespace graphdrl
