// GraphDRL in C++17: plans walks that visit as many nodes of a graph as a budget allows, and bounds them.
//
//   const auto world = graphdrl::World::from_edges({{0, 1, 2.5}, {1, 2, 1.0}});
//   const auto plan = graphdrl::plan(world, graphdrl::Task(10));
//   for (const int node : plan.walk()) …
//
// Over the C interface [graphdrl_c.h], so that it does not matter which compiler built the library. Everything that
// fails throws graphdrl::Error. Worlds and plans are handles: copies share one, and any number of threads may use it.
#ifndef GRAPHDRL_GRAPHDRL_H
#define GRAPHDRL_GRAPHDRL_H

#include <algorithm>
#include <cstdint>
#include <exception>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "graphdrl/graphdrl_c.h"

namespace graphdrl {
inline namespace v0 {

// Its text is one line. bad_input(): a bad argument or file, rather than memory that ran out.
class Error : public std::runtime_error {
 public:
  Error(graphdrl_status status, const std::string& text) : std::runtime_error(text), status_(status) {}
  bool bad_input() const { return status_ == GRAPHDRL_BAD_INPUT; }

 private:
  graphdrl_status status_;
};

namespace detail {

inline void check(graphdrl_status status) {
  if (status != GRAPHDRL_DONE) throw Error(status, graphdrl_last_error());
}

}  // namespace detail

inline std::string version() {
  return graphdrl_version();
}

// How many threads one call may use; 1 at first. Results do not depend on it. Do not call it while another call runs.
inline void set_threads(int count) {
  detail::check(graphdrl_set_threads(count));
}

struct Edge {
  std::int32_t from;
  std::int32_t to;
  double cost = 1;
};

// What else a graph may have. Vectors are empty, or have a value per node.
struct GraphOptions {
  std::int32_t node_count = -1;  // -1: one more than the largest node of an edge
  bool directed = false;
  std::vector<unsigned char> blocked = {};  // other than 0 where nobody may go
  std::vector<double> prizes = {};          // of first visits; 1 each where there are none
  std::string name = "graph";
};

// A graph with its blocked nodes and prizes.
class World {
 public:
  static World from_edges(const std::vector<Edge>& edges, const GraphOptions& options = {}) {
    std::vector<std::int32_t> ends;
    std::vector<double> costs;
    std::int64_t nodes = options.node_count < 0 ? 0 : options.node_count;
    for (const Edge& edge : edges) {
      ends.push_back(edge.from);
      ends.push_back(edge.to);
      costs.push_back(edge.cost);
      if (options.node_count < 0) nodes = std::max({nodes, std::int64_t{edge.from} + 1, std::int64_t{edge.to} + 1});
    }
    if (nodes > INT32_MAX) throw Error(GRAPHDRL_BAD_INPUT, "bad number of nodes: got " + std::to_string(nodes));
    require_length(options.blocked.size(), nodes, "blocked");
    require_length(options.prizes.size(), nodes, "prizes");
    graphdrl_world* world = nullptr;
    detail::check(graphdrl_world_from_edges(options.name.c_str(), static_cast<std::int32_t>(nodes), edges.size(),
                                            ends.data(), costs.data(), options.directed ? 1 : 0,
                                            options.blocked.empty() ? nullptr : options.blocked.data(),
                                            options.prizes.empty() ? nullptr : options.prizes.data(), &world));
    return World(world);
  }

  // blocked: [rows * columns], row by row from the top.
  static World from_grid(std::int32_t rows, std::int32_t columns, const std::vector<unsigned char>& blocked,
                         bool diagonals = false, const std::string& name = "grid") {
    if (rows > 0 && columns > 0) require_length(blocked.size(), std::int64_t{rows} * columns, "cells", false);
    graphdrl_world* world = nullptr;
    detail::check(graphdrl_world_from_grid(name.c_str(), rows, columns, blocked.data(), diagonals ? 1 : 0, &world));
    return World(world);
  }

  // A file in any format that the program reads, or "paper:a" to "paper:j".
  static World from_file(const std::string& path) {
    graphdrl_world* world = nullptr;
    detail::check(graphdrl_world_from_file(path.c_str(), &world));
    return World(world);
  }

  std::string name() const { return graphdrl_world_name(get()); }
  std::int32_t node_count() const { return graphdrl_world_node_count(get()); }    // blocked ones included
  std::int32_t valid_count() const { return graphdrl_world_valid_count(get()); }  // those that are not
  // What the file calls a node; its number where it has no names.
  std::string label(std::int32_t node) const {
    const char* const label = graphdrl_world_label(get(), node);
    return label != nullptr ? label : std::to_string(node);
  }
  // The node of a label, of "row,column" on a grid or of "#number"; -1 where there is no such valid node.
  std::int32_t find(const std::string& label) const { return graphdrl_world_find(get(), label.c_str()); }

  const graphdrl_world* get() const { return handle_.get(); }

 private:
  explicit World(graphdrl_world* world) : handle_(world, graphdrl_free) {}

  static void require_length(std::size_t length, std::int64_t expected, const char* what, bool or_empty = true) {
    if ((or_empty && length == 0) || static_cast<std::int64_t>(length) == expected) return;
    throw Error(GRAPHDRL_BAD_INPUT, std::string("bad length of ") + what + ": expected " + std::to_string(expected) +
                                        ", got " + std::to_string(length));
  }

  std::shared_ptr<graphdrl_world> handle_;
};

// What is asked: Task(25).from(3).back_to_start().within(0.5).
class Task {
 public:
  // What the file says.
  Task() { graphdrl_task_init(&task_); }
  // A budget in units of cost.
  explicit Task(double budget) : Task() { task_.budget = budget; }
  // So many times the valid nodes, in edges of mean cost: 1.1 is the command line's 1.1x.
  static Task relative(double multiple) {
    Task task;
    task.task_.relative = multiple;
    return task;
  }

  Task& from(std::int32_t start) { return set(task_.start, start); }
  Task& to(std::int32_t end) { return set(task_.end, end); }
  Task& to_anywhere() { return set(task_.end, GRAPHDRL_ANYWHERE); }
  Task& back_to_start() { return set(task_.end, GRAPHDRL_AT_START); }
  Task& within(double seconds) { return set(task_.time_limit_s, seconds); }
  Task& seed(std::uint64_t seed) { return set(task_.seed, seed); }
  // As of `graphdrl plan --policy`.
  Task& policy(std::string name) {
    policy_ = std::move(name);
    return *this;
  }
  // Explores a map that is not known beforehand: a visit shows "edges", or all within "radius:R", or what "sight:R"
  // meets. The policy is then that of `graphdrl explore`, unless it is set.
  Task& reveal(std::string what) {
    reveal_ = std::move(what);
    return *this;
  }
  // What an exploration counts: nodes seen instead of nodes visited.
  Task& count_seen() {
    counts_seen_ = true;
    return *this;
  }
  // Seconds for each choice of an exploration, of policies that plan.
  Task& think(double seconds) { return set(task_.think_time_s, seconds); }
  // Explores with an old map, of which some may have changed. The policy is then search:10000, unless it is set.
  Task& believed(World old) {
    believed_ = std::move(old);
    return *this;
  }
  // Instead of a budget, of an exploration: until nothing is left that is known.
  Task& until_covered() {
    task_.relative = 0;
    return set(task_.budget, std::numeric_limits<double>::infinity());
  }
  // Called now and then, on the thread that plans. False ends the planning; what it throws comes out of plan().
  Task& progress(std::function<bool(std::int32_t visited, double bound)> told) {
    progress_ = std::move(told);
    return *this;
  }

 private:
  friend class Plan;
  friend double upper_bound(const World& world, const Task& task);

  struct Call {
    const Task& task;
    std::exception_ptr thrown;
  };

  template <typename T, typename Value>
  Task& set(T& field, Value value) {
    field = static_cast<T>(value);
    return *this;
  }

  // The task as C takes it; holds as long as this and `call`.
  graphdrl_task for_call(Call& call) const {
    graphdrl_task task = task_;
    if (!policy_.empty()) task.policy = policy_.c_str();
    if (!reveal_.empty()) task.reveal = reveal_.c_str();
    if (counts_seen_) task.score = "seen";
    if (believed_) task.believed = believed_->get();
    if (progress_) {
      task.progress_data = &call;
      task.progress = [](std::int32_t visited, double bound, void* data) -> std::int32_t {
        Call& mine = *static_cast<Call*>(data);
        try {
          if (!mine.thrown && mine.task.progress_(visited, bound)) return 0;
        } catch (...) {
          mine.thrown = std::current_exception();
        }
        return 1;
      };
    }
    return task;
  }

  graphdrl_task task_;
  std::string policy_;
  std::string reveal_;
  bool counts_seen_ = false;
  std::optional<World> believed_;
  std::function<bool(std::int32_t, double)> progress_;
};

// One walk, and how far from the best it may be. It may outlive the world.
class Plan {
 public:
  Plan(const World& world, const Task& task) {
    Task::Call call{task, nullptr};
    const graphdrl_task asked = task.for_call(call);
    graphdrl_result* result = nullptr;
    const graphdrl_status status = graphdrl_plan(world.get(), &asked, &result);
    handle_.reset(result, graphdrl_free);
    if (call.thrown) std::rethrow_exception(call.thrown);
    detail::check(status);
  }

  // Every step, the start first.
  std::vector<std::int32_t> walk() const { return array(graphdrl_result_walk); }
  // Of an exploration: the nodes seen, in the order in which they were seen, and how many at each step of the walk.
  std::vector<std::int32_t> seen() const { return array(graphdrl_result_seen); }
  std::vector<std::int32_t> seen_after_step() const { return array(graphdrl_result_seen_after_step); }
  std::int32_t visited() const { return graphdrl_result_visited(handle_.get()); }  // valid nodes
  double prize() const { return graphdrl_result_prize(handle_.get()); }
  double cost() const { return graphdrl_result_cost(handle_.get()); }
  double budget() const { return graphdrl_result_budget(handle_.get()); }       // in units of cost
  double bound() const { return graphdrl_result_bound(handle_.get()); }         // no walk has a higher prize
  bool optimal() const { return graphdrl_result_optimal(handle_.get()) != 0; }  // whether that is proved of this one
  std::string json() const { return graphdrl_result_json(handle_.get()); }      // as `graphdrl plan --json`
  // In the format of the ending, as `graphdrl plan --out`.
  void save(const std::string& path) const { detail::check(graphdrl_result_save(handle_.get(), path.c_str())); }

 private:
  std::vector<std::int32_t> array(const std::int32_t* (*of)(const graphdrl_result*, std::size_t*)) const {
    std::size_t length = 0;
    const std::int32_t* const values = of(handle_.get(), &length);
    return {values, values + length};
  }

  std::shared_ptr<graphdrl_result> handle_;
};

inline Plan plan(const World& world, const Task& task) {
  return Plan(world, task);
}

// What no walk's prize exceeds: nodes, where there are no prizes.
inline double upper_bound(const World& world, const Task& task) {
  Task::Call call{task, nullptr};
  const graphdrl_task asked = task.for_call(call);
  double bound = 0;
  detail::check(graphdrl_upper_bound(world.get(), &asked, &bound));
  return bound;
}

// An exploration of something that can say in which state it is and which moves it has. Messages and answers are JSON
// objects; docs/live.md has all of them. One thread at a time.
class LiveExploration {
 public:
  // options: those of `open`, as {"cover": "edges"}. transcript: a file in which each message is written down with its
  // answer; empty for none. resume: go on where it ends, with its options.
  explicit LiveExploration(const std::string& options = "{}", const std::string& transcript = "", bool resume = false) {
    graphdrl_live* live = nullptr;
    detail::check(
        graphdrl_live_begin(options.c_str(), transcript.empty() ? nullptr : transcript.c_str(), resume ? 1 : 0, &live));
    handle_.reset(live, graphdrl_free);
  }

  // What to do next, or {"error": …} for a message that is refused.
  std::string answer(const std::string& message) {
    const char* answer = nullptr;
    detail::check(graphdrl_live_answer(handle_.get(), message.c_str(), &answer));
    return answer;
  }

  // The map discovered (.graphml, .dot, .json), or the walk through it in the format of another ending.
  void save(const std::string& path) const { detail::check(graphdrl_live_save(handle_.get(), path.c_str())); }

 private:
  std::shared_ptr<graphdrl_live> handle_;
};

}  // namespace v0
}  // namespace graphdrl

#endif  // GRAPHDRL_GRAPHDRL_H
