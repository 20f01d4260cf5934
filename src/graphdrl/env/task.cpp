#include "graphdrl/env/task.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

#include "graphdrl/base/error.h"
#include "graphdrl/graph/search.h"

namespace graphdrl {
namespace {

void check_node(const View& view, NodeId node, const char* role) {
  if (node < 0 || node >= view.node_count()) {
    throw Error({.what = fmt::format("{} outside the world", role),
                 .expected = fmt::format("a node from 0 to {}", view.node_count() - 1),
                 .got = fmt::format("{}", node),
                 .where = view.name()});
  }
  if (!view.is_blocked(node)) return;
  throw Error({.what = fmt::format("{} on an obstacle", role),
               .expected = "a valid node",
               .got = fmt::format("node {}", node),
               .where = view.name()});
}

double budget_of(const World& world, const std::optional<Budget>& asked) {
  if (asked) return asked->cost_in(world);
  if (world.given().budget) return *world.given().budget;
  throw Error({.what = "no budget is given",
               .expected = "one asked for, as --budget 25, or one of the map's file",
               .where = world.name()});
}

NodeId start_of(const World& world) {
  return world.given().start == kNoNode ? world.valid_nodes().front() : world.given().start;
}

End end_of(const World& world) {
  return world.given().end == kNoNode ? End::anywhere() : End::at(world.given().end);
}

}  // namespace

Budget::Budget(double cost) : text_(fmt::format("{}", cost)), value_(std::abs(cost)) {  // -0
  if (!(cost >= 0)) {
    throw Error({.what = "bad budget", .expected = "a number from 0 up", .got = fmt::format("{}", cost)});
  }
}

Budget Budget::parse(std::string_view text) {
  std::string_view number = text;
  const bool relative = number.ends_with('x');
  if (relative) number.remove_suffix(1);
  const char* const end = number.data() + number.size();
  double value = 0;
  const auto [rest, error] = std::from_chars(number.data(), end, value);
  if (error != std::errc() || rest != end || !(value >= 0)) {
    throw Error(
        {.what = "bad budget", .expected = "a number from 0 up, or a multiple like 1.1x", .got = in_quotes(text)});
  }
  Budget budget(value);
  budget.text_ = text;
  budget.relative_ = relative;
  return budget;
}

double Budget::cost_in(const View& view) const {
  return relative_ ? std::floor(value_ * view.valid_count() + 1e-9) * view.open().mean_cost() : value_;
}

Task::Task(const World& world, const Asked& asked)
    : Task(world, asked.start ? *asked.start : start_of(world), budget_of(world, asked.budget),
           asked.end ? *asked.end : end_of(world)) {}

Task::Task(View view, NodeId start, double budget, End end)
    : view_(std::move(view)),
      asked_end_(end),
      start_(start),
      end_(end.of(start)),
      budget_(Budget(budget).cost_in(view_)) {
  // More than enough is enough: so many mean edges visit everything.
  const double enough = static_cast<double>(kMaxSteps) * view_.open().mean_cost();
  limit_ = std::min(view_.spending_limit(budget_), enough);
  has_budget_ = budget_ < enough;
  if (std::isinf(budget_)) budget_ = enough;
  check_node(view_, start_, "start");
  if (!ends_anywhere()) {
    check_node(view_, end_, "end");
    to_end_ = std::make_shared<const std::vector<double>>(costs_to(view_.into(), end_));
  }
  check_reach_from(start_);
}

void Task::check_reach_from(NodeId start) const {
  if (cost_to_end(start) <= limit_) return;
  throw Error({.what = "the end cannot be reached within the budget",
               .got = fmt::format("node {} from node {} for {}", end_, start, budget_),
               .where = view_.name()});
}

void Task::start_at(NodeId start) {
  if (start == start_) return;
  if (asked_end_.of(start) != end_) {
    Task moved(view_, start, budget_, asked_end_);
    std::swap(moved.claimed_, claimed_);
    moved.claims_beyond_ground_ = claims_beyond_ground_;
    *this = std::move(moved);
    return;
  }
  check_node(view_, start, "start");
  check_reach_from(start);
  start_ = start;
  reach_.forget();
}

Task Task::rest(NodeId position, double budget, NodeSet visited) const {
  Task task = *this;
  task.asked_end_ = ends_anywhere() ? End::anywhere() : End::at(end_);
  task.start_ = position;
  task.budget_ = budget;
  task.limit_ = std::min(view_.spending_limit(budget), limit_);
  task.ground_ = visited;
  task.ground_.insert(position);
  if (claimed_.empty()) {
    task.claimed_ = std::move(visited);
    task.claimed_.insert(position);
  } else {
    task.claimed_.insert_all(task.ground_);
  }
  task.reach_.forget();
  return task;
}

Task Task::on(View known, NodeId start, NodeId end, std::shared_ptr<const std::vector<double>> costs_to_end) const {
  Task task = *this;
  task.view_ = std::move(known);
  task.asked_end_ = end == kNoNode ? End::anywhere() : End::at(end);
  task.start_ = start;
  task.end_ = end;
  task.to_end_ = std::move(costs_to_end);
  task.reach_.forget();
  return task;
}

Task Task::without(const NodeSet& claimed) const {
  Task task = *this;
  if (task.claimed_.empty()) task.claimed_ = NodeSet(view_.node_count());
  task.claimed_.insert_all(claimed);
  task.claims_beyond_ground_ = true;
  return task;
}

NodeSet Task::ground() const {
  if (!ground_.empty()) return ground_;
  NodeSet start(view_.node_count());
  start.insert(start_);
  return start;
}

Task::LazyReach& Task::LazyReach::operator=(const LazyReach& other) {
  if (this == &other) return *this;
  const std::scoped_lock lock(mutex_, other.mutex_);
  known_ = other.known_;
  return *this;
}

const Reach& Task::LazyReach::of(const Task& task) {
  const std::lock_guard lock(mutex_);
  if (known_ != nullptr) return *known_;
  Reach reach{.nodes = {}, .contains = std::vector<bool>(task.view().node_count())};
  const auto take = [&](NodeId node, double cost) {
    if (cost + task.cost_to_end(node) > task.limit()) return;
    reach.contains[node] = true;
    reach.nodes.push_back(node);
  };
  take(task.start(), 0);
  NearestFirst().run_cheapest(task.view().open(), task.start(), task.limit(), [&](NodeId node, double cost) {
    take(node, cost);
    return NearestFirst::Next::kThrough;
  });
  known_ = std::make_shared<const Reach>(std::move(reach));
  return *known_;
}

}  // namespace graphdrl
