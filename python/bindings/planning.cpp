#include <nlohmann/json.hpp>

#include "bindings.h"
#include "graphdrl/base/error.h"
#include "graphdrl/env/budget.h"
#include "graphdrl/eval/rollout.h"
#include "graphdrl/planners/bound.h"
#include "graphdrl/report/picture.h"
#include "graphdrl/report/plan_files.h"

namespace graphdrl::python {
namespace {

Task task_of(const World& world, const std::string& budget, std::optional<std::int64_t> start,
             std::optional<std::int64_t> end) {
  const NodeId first = start ? checked_node(world, *start, "start") : world.valid_nodes().front();
  return {.view = world,
          .start = first,
          .budget = Budget::parse(budget).cost_in(world),
          .end = end ? checked_node(world, *end, "end") : kNoNode};
}

PlanReport plan(const World& world, const std::string& budget, std::optional<std::int64_t> start,
                std::optional<std::int64_t> end, const std::string& policy, const nb::object& own,
                std::optional<double> time_limit, std::uint64_t seed, const nb::object& on_progress) {
  const Task task = task_of(world, budget, start, end);
  check(task);
  PlanRequest request{.policy = policy, .seed = seed, .time_limit_s = time_limit};
  if (!own.is_none()) {
    const OwnPolicy chosen = own_policy_of(own);
    request.own_planner = chosen.planner;
    request.own_policy = chosen.policy;
  }
  std::optional<PlanReport> answer;
  run_planning(on_progress, [&](const Report& report) { answer = make_plan(world, task, request, report); });
  return std::move(*answer);
}

double upper_bound(const World& world, const std::string& budget, std::optional<std::int64_t> start,
                   std::optional<std::int64_t> end, std::optional<double> time_limit) {
  const Task task = task_of(world, budget, start, end);
  double bound = 0;
  run_planning(nb::none(), [&](const Report&) {
    bound = max_prize(task, deadline_after(time_limit ? TimeLimit(*time_limit) : std::nullopt));
  });
  return bound;
}

// What pickles keep beside the world and the walk: budget, end, policy, bound, optimal, most visited, out of reach,
// time.
using Claims = std::tuple<double, NodeId, std::string, double, bool, int, int, double>;

Claims claims_of(const PlanReport& report) {
  return {report.task.budget,  report.task.end,    report.policy,      report.plan.bound,
          report.plan.optimal, report.max_visited, report.unreachable, report.elapsed_s};
}

PlanReport restore(const World& world, const InArray<NodeId, nb::ndim<1>>& walk, const Claims& claims) {
  const auto& [budget, end, policy, bound, optimal, most, unreachable, elapsed_s] = claims;
  std::vector<NodeId> nodes(walk.data(), walk.data() + walk.size());
  if (nodes.empty()) throw Error({.what = "the walk is empty", .where = world.name()});
  for (const NodeId node : nodes) checked_node(world, node, "a step");
  const Task task{.view = world, .start = nodes.front(), .budget = budget, .end = end};
  PlanReport report{.world = world,
                    .task = task,
                    .policy = policy,
                    .plan = plan_of_walk(task, std::move(nodes), optimal),
                    .max_visited = most,
                    .unreachable = unreachable,
                    .elapsed_s = elapsed_s};
  report.plan.bound = bound;
  return report;
}

}  // namespace

void bind_planning(nb::module_& module) {
  nb::class_<PlanReport>(module, "PlanReport", "A task answered: its plan and its bound. Nodes are numbers.")
      .def_static("restore", &restore, nb::arg("world"), nb::arg("walk"), nb::arg("claims"))
      .def_prop_ro("claims", &claims_of)
      .def_prop_ro(
          "walk", [](const PlanReport& report) { return to_numpy(report.plan.walk); }, nb::rv_policy::automatic)
      .def_prop_ro(
          "costs", [](const PlanReport& report) { return to_numpy(costs_so_far(report)); }, nb::rv_policy::automatic)
      .def_prop_ro("visited", [](const PlanReport& report) { return report.plan.visited; })
      .def_prop_ro("prize", [](const PlanReport& report) { return report.plan.prize; })
      .def_prop_ro("cost", [](const PlanReport& report) { return report.plan.cost; })
      .def_prop_ro("bound", [](const PlanReport& report) { return report.plan.bound; })
      .def_prop_ro("optimal", [](const PlanReport& report) { return report.plan.optimal; })
      .def_prop_ro("budget", [](const PlanReport& report) { return report.task.budget; })
      .def_prop_ro("end", [](const PlanReport& report) { return report.task.end; })
      .def_prop_ro("policy", [](const PlanReport& report) { return report.policy; })
      .def_prop_ro("elapsed_s", [](const PlanReport& report) { return report.elapsed_s; })
      .def_prop_ro("summary", [](const PlanReport& report) { return plan_summary(report); })
      .def("json", [](const PlanReport& report) { return plan_json(report).dump(); })
      .def("svg",
           [](const PlanReport& report) {
             return Picture(report.world, report.plan.walk, report.world.name(), plan_summary(report)).svg();
           })
      .def("save", [](const PlanReport& report, const std::string& file) {
        check_plan_file(report.world, file);
        write_plan(report, file);
      });
  module.def("plan", &plan, nb::arg("world"), nb::arg("budget"), nb::arg("start").none(), nb::arg("end").none(),
             nb::arg("policy"), nb::arg("own").none(), nb::arg("time_limit").none(), nb::arg("seed"),
             nb::arg("on_progress").none());
  module.def("upper_bound", &upper_bound, nb::arg("world"), nb::arg("budget"), nb::arg("start").none(),
             nb::arg("end").none(), nb::arg("time_limit").none());
}

}  // namespace graphdrl::python
