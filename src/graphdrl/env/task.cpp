#include "graphdrl/env/task.h"

#include <fmt/format.h>

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

}  // namespace

CostToEnd::CostToEnd(const Task& task) {
  if (!task.ends_anywhere()) costs_ = costs_to(task.view.into(), task.end);
}

void check(const Task& task) {
  check_node(task.view, task.start, "start");
  if (task.ends_anywhere()) return;
  check_node(task.view, task.end, "end");
  bool reached = task.end == task.start;
  NearestFirst().run_cheapest(task.view.open(), task.start, task.limit(), [&](NodeId node, double) {
    reached = reached || node == task.end;
    return reached ? NearestFirst::Next::kEnd : NearestFirst::Next::kThrough;
  });
  if (!reached) {
    throw Error({.what = "the end cannot be reached within the budget",
                 .got = fmt::format("node {} from node {} for {:g}", task.end, task.start, task.budget),
                 .where = task.view.name()});
  }
}

}  // namespace graphdrl
