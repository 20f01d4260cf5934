#include <nlohmann/json.hpp>

#include "bindings.h"
#include "graphdrl/base/error.h"
#include "graphdrl/env/load_worlds.h"
#include "graphdrl/live/edge_exploration.h"
#include "graphdrl/planners/bound.h"
#include "graphdrl/report/picture.h"
#include "graphdrl/report/plan_files.h"

namespace graphdrl::python {
namespace {

// An end: a node, "start" or "anywhere".
using AskedEnd = std::variant<std::int64_t, std::string>;

Asked asked_of(const World& world, const std::optional<std::string>& budget, std::optional<std::int64_t> start,
               const std::optional<AskedEnd>& end) {
  Asked asked;
  if (budget) asked.budget = Budget::parse(*budget);
  if (start) asked.start = checked_node(world, *start, "start");
  if (!end) return asked;
  const auto* const node = std::get_if<std::int64_t>(&*end);
  asked.end =
      node != nullptr ? End::at(checked_node(world, *node, "end")) : parse_end(world, std::get<std::string>(*end));
  return asked;
}

Answer plan(const World& world, const std::optional<std::string>& budget, std::optional<std::int64_t> start,
            const std::optional<AskedEnd>& end, const std::string& policy, const nb::object& own,
            std::optional<double> time_limit, std::uint64_t seed, const nb::object& on_progress,
            const std::string& cover, std::optional<double> reset_cost, const std::string& reveal,
            const std::string& score, std::optional<double> think_time, const std::optional<World>& believed) {
  Asked asked = asked_of(world, budget, start, end);
  const Cover covered = parse_cover(cover);
  if (covered == Cover::kEdges && !asked.budget && !world.given().budget) asked.budget = Budget(kNoLimit);
  const Task task(world, asked);
  PlanRequest request{.policy = policy,
                      .seed = seed,
                      .reveal = Reveal::parse(reveal),
                      .score = parse_score(score),
                      .cover = covered,
                      .reset_cost = reset_cost,
                      .believed = believed ? believe(*believed, world) : nullptr,
                      .think_s = think_time.value_or(kNoLimit)};
  if (!own.is_none()) {
    const OwnPolicy chosen = own_policy_of(own);
    request.own_planner = chosen.planner;
    request.own_policy = chosen.policy;
  }
  std::optional<Answer> answer;
  run_planning(time_limit, on_progress, [&](const Clock& clock) { answer = answer_task(world, task, request, clock); });
  return std::move(*answer);
}

double upper_bound(const World& world, const std::optional<std::string>& budget, std::optional<std::int64_t> start,
                   const std::optional<AskedEnd>& end, std::optional<double> time_limit, const std::string& cover,
                   std::optional<double> reset_cost) {
  const Task task(world, asked_of(world, budget, start, end));
  double bound = 0;
  if (parse_cover(cover) == Cover::kEdges) {
    return judge_edges(world, task, reset_cost, {.nodes = {task.start()}}).bound;
  }
  if (reset_cost) throw Error({.what = "resets go with the cover of edges"});
  run_planning(time_limit, nb::none(), [&](const Clock& clock) { bound = max_prize(task, clock); });
  return bound;
}

// What pickles keep beside the world and the walk.
nb::dict claims_of(const Answer& answer) {
  nb::dict claims;
  claims["budget"] = answer.task.budget();
  claims["end"] = answer.task.end();
  claims["policy"] = answer.policy;
  claims["bound"] = answer.plan.bound;
  claims["optimal"] = answer.plan.optimal;
  claims["unreachable"] = answer.unreachable;
  claims["elapsed_s"] = answer.elapsed_s;
  claims["prize"] = answer.plan.prize;
  claims["reveal"] = answer.reveal.text();
  claims["seen_counts"] = answer.score == Score::kSeen;
  claims["seen"] = answer.discovered.nodes;
  claims["seen_after_step"] = answer.discovered.after_step;
  claims["no_way_back"] = answer.discovered.no_way_back;
  if (answer.edges) claims["document"] = plan_json(answer).dump();
  return claims;
}

Answer restore(const World& world, const InArray<NodeId, nb::ndim<1>>& walk, const nb::dict& claims) {
  if (claims.contains("document")) {
    Answer answer = parse_plan(world, nb::cast<std::string>(claims["document"]), world.name());
    answer.elapsed_s = nb::cast<double>(claims["elapsed_s"]);
    return answer;
  }
  std::vector<NodeId> nodes(walk.data(), walk.data() + walk.size());
  if (nodes.empty()) throw Error({.what = "the walk is empty", .where = world.name()});
  for (const NodeId node : nodes) checked_node(world, node, "a step");
  const auto end = nb::cast<NodeId>(claims["end"]);
  const Task task(world, nodes.front(), nb::cast<double>(claims["budget"]),
                  end == kNoNode ? End::anywhere() : End::at(end));
  Answer answer{.world = world,
                .task = task,
                .policy = nb::cast<std::string>(claims["policy"]),
                .plan = plan_of_walk(task, std::move(nodes), nb::cast<bool>(claims["optimal"])),
                .unreachable = nb::cast<int>(claims["unreachable"]),
                .elapsed_s = nb::cast<double>(claims["elapsed_s"]),
                .reveal = Reveal::parse(nb::cast<std::string>(claims["reveal"])),
                .score = nb::cast<bool>(claims["seen_counts"]) ? Score::kSeen : Score::kVisited,
                .discovered = {.nodes = nb::cast<std::vector<NodeId>>(claims["seen"]),
                               .after_step = nb::cast<std::vector<int>>(claims["seen_after_step"]),
                               .no_way_back = nb::cast<int>(claims["no_way_back"])}};
  answer.plan.prize = nb::cast<double>(claims["prize"]);
  answer.plan.bound = nb::cast<double>(claims["bound"]);
  return answer;
}

// Nothing of a known map, which was not seen bit by bit.
std::optional<OutArray<NodeId>> if_explored(const Answer& answer, const std::vector<NodeId>& values) {
  return answer.reveal.all() ? std::nullopt : std::optional(to_numpy(values));
}

}  // namespace

void bind_planning(nb::module_& module) {
  nb::class_<Answer>(module, "Answer", "A task answered: its plan and its bound. Nodes are numbers.")
      .def_static("restore", &restore, nb::arg("world"), nb::arg("walk"), nb::arg("claims"))
      .def_prop_ro("claims", &claims_of)
      .def_prop_ro(
          "walk", [](const Answer& answer) { return to_numpy(answer.plan.walk); }, nb::rv_policy::automatic)
      .def_prop_ro(
          "costs", [](const Answer& answer) { return to_numpy(costs_so_far(answer)); }, nb::rv_policy::automatic)
      .def_prop_ro(
          "seen", [](const Answer& answer) { return if_explored(answer, answer.discovered.nodes); },
          nb::rv_policy::automatic)
      .def_prop_ro(
          "seen_after_step", [](const Answer& answer) { return if_explored(answer, answer.discovered.after_step); },
          nb::rv_policy::automatic)
      .def_prop_ro("visited", [](const Answer& answer) { return answer.plan.visited; })
      .def_prop_ro("prize", [](const Answer& answer) { return answer.plan.prize; })
      .def_prop_ro("cost", [](const Answer& answer) { return answer.plan.cost; })
      .def_prop_ro("bound", [](const Answer& answer) { return answer.plan.bound; })
      .def_prop_ro("optimal",
                   [](const Answer& answer) { return answer.edges ? answer.edges->optimal() : answer.plan.optimal; })
      .def_prop_ro("budget", [](const Answer& answer) { return answer.task.budget(); })
      .def_prop_ro("end", [](const Answer& answer) { return answer.task.end(); })
      .def_prop_ro("policy", [](const Answer& answer) { return answer.policy; })
      .def_prop_ro("elapsed_s", [](const Answer& answer) { return answer.elapsed_s; })
      .def_prop_ro(
          "walk_edges",
          [](const Answer& answer) { return answer.edges ? std::optional(answer.edges->walk.edges) : std::nullopt; })
      .def_prop_ro(
          "edges_walked",
          [](const Answer& answer) { return answer.edges ? std::optional(answer.edges->walked) : std::nullopt; })
      .def_prop_ro(
          "edge_count",
          [](const Answer& answer) { return answer.edges ? std::optional(answer.edges->edges) : std::nullopt; })
      .def_prop_ro(
          "edge_prize",
          [](const Answer& answer) { return answer.edges ? std::optional(answer.edges->prize) : std::nullopt; })
      .def_prop_ro(
          "edge_bound",
          [](const Answer& answer) { return answer.edges ? std::optional(answer.edges->bound) : std::nullopt; })
      .def_prop_ro("summary", [](const Answer& answer) { return plan_summary(answer); })
      .def("json", [](const Answer& answer) { return plan_json(answer).dump(); })
      .def("svg",
           [](const Answer& answer) {
             return Picture(answer.world, answer.plan.walk, answer.world.name(), plan_summary(answer)).svg();
           })
      .def("save", [](const Answer& answer, const std::string& file) {
        check_plan_file(answer.world, file);
        write_plan(answer, file);
      });
  module.def("plan", &plan, nb::arg("world"), nb::arg("budget").none(), nb::arg("start").none(), nb::arg("end").none(),
             nb::arg("policy"), nb::arg("own").none(), nb::arg("time_limit").none(), nb::arg("seed"),
             nb::arg("on_progress").none(), nb::arg("cover") = "nodes", nb::arg("reset_cost") = nb::none(),
             nb::arg("reveal") = "all", nb::arg("score") = "visited", nb::arg("think_time") = nb::none(),
             nb::arg("believed") = nb::none());
  module.def("upper_bound", &upper_bound, nb::arg("world"), nb::arg("budget").none(), nb::arg("start").none(),
             nb::arg("end").none(), nb::arg("time_limit").none(), nb::arg("cover"), nb::arg("reset_cost").none());
}

}  // namespace graphdrl::python
