#include "bindings.h"
#include "graphdrl/base/error.h"
#include "graphdrl/live/edge_exploration.h"

namespace graphdrl::python {
namespace {

nb::object number(const std::optional<double>& value) {
  return value ? nb::object(nb::float_(*value)) : nb::object(nb::none());
}

nb::dict row_of(const ComparisonRow& row) {
  const std::optional<Summary>& coverage = row.coverage;
  const bool interval = coverage && coverage->ci95;
  nb::dict out;
  out["map"] = row.map;
  out["policy"] = row.policy;
  out["valid_nodes"] = row.valid_nodes;
  out["budget"] = row.budget;
  out["episodes"] = row.episodes;
  out["mean"] = coverage ? number(coverage->mean) : nb::none();
  out["std"] = coverage ? number(coverage->std) : nb::none();
  out["best"] = coverage ? number(coverage->best) : nb::none();
  out["ci95_low"] = interval ? number(coverage->ci95->low) : nb::none();
  out["ci95_high"] = interval ? number(coverage->ci95->high) : nb::none();
  out["optimum"] = number(row.optimum);
  out["paper"] = row.paper ? number(row.paper->mean) : nb::none();
  return out;
}

nb::list evaluate(const std::vector<World>& worlds, const std::vector<std::string>& policies, const nb::dict& own,
                  const std::optional<std::string>& budget, const std::string& end, int episodes, bool all_starts,
                  std::uint64_t seed, const std::string& cover, std::optional<double> reset_cost) {
  ComparisonOptions options{
      .policies = policies, .end = end, .episodes = episodes, .all_starts = all_starts, .seed = seed};
  if (budget) options.budget = Budget::parse(*budget);
  for (const auto& [name, policy] : own) {
    options.own_policies[nb::cast<std::string>(name)] = [chosen = own_policy_of(policy)] { return chosen.as_policy(); };
  }
  if (parse_cover(cover) == Cover::kEdges) {
    if (!options.own_policies.empty()) throw Error({.what = "edges are covered by policies that have a name"});
    compare_edges(options, reset_cost);
  } else if (reset_cost) {
    throw Error({.what = "resets go with the cover of edges"});
  }
  Comparison comparison;
  run_planning({}, nb::none(), [&](const Clock& clock) { comparison = compare(worlds, options, clock); });
  nb::list rows;
  for (const ComparisonRow& row : comparison.rows) rows.append(row_of(row));
  return rows;
}

}  // namespace

void bind_evaluation(nb::module_& module) {
  module.def("evaluate", &evaluate, nb::arg("worlds"), nb::arg("policies"), nb::arg("own"), nb::arg("budget").none(),
             nb::arg("end"), nb::arg("episodes"), nb::arg("all_starts"), nb::arg("seed"), nb::arg("cover"),
             nb::arg("reset_cost").none());
}

}  // namespace graphdrl::python
