#include <fmt/format.h>

#include <algorithm>

#include "graphdrl/eval/comparison.h"
#include "graphdrl/planners/exact.h"

namespace graphdrl {
namespace {

std::string number(const std::optional<double>& value) {
  return value ? fmt::format("{:.1f}", *value) : "–";
}

std::string interval(const std::optional<Interval>& value) {
  return value ? fmt::format("{:5.1f} – {:5.1f}", value->low, value->high) : "–";
}

// One policy's block: a line per map, the paper's own beside it where there is one.
std::string format_rows(std::span<const ComparisonRow> rows, std::size_t name_width) {
  const bool paper = std::any_of(rows.begin(), rows.end(), [](const ComparisonRow& row) { return row.paper; });
  std::string text =
      fmt::format("{:{}}  {:>5} {:>6} {:>5} {:>5}  {:^13} {:>7}{}\n", rows.front().policy, name_width, "nodes", "mean",
                  "std", "best", "95 % interval", "optimum", paper ? " | paper:  mean   std  best" : "");
  for (const ComparisonRow& row : rows) {
    const auto coverage = row.coverage;
    text += fmt::format("{:{}}  {:5} {:>6} {:>5} {:>5}  {:^13} {:>7}", row.map, name_width, row.valid_nodes,
                        coverage ? number(coverage->mean) : "–", coverage ? number(coverage->std) : "–",
                        coverage ? number(coverage->best) : "–", interval(coverage ? coverage->ci95 : std::nullopt),
                        number(row.optimum));
    if (row.paper) {
      text += fmt::format(" |        {:6.1f} {:5.1f} {:5.1f}", row.paper->mean, row.paper->std, row.paper->best);
    }
    text += '\n';
  }
  return text + '\n';
}

// Of all rows; "the maps' own" where they differ.
std::string budgets_of(const Comparison& comparison) {
  const auto& rows = comparison.rows;
  const bool same = !rows.empty() && std::all_of(rows.begin(), rows.end(), [&](const ComparisonRow& row) {
    return row.budget == rows.front().budget;
  });
  return same ? fmt::format("{:g}", rows.front().budget) : "the maps' own";
}

}  // namespace

std::string format_comparison(const Comparison& comparison) {
  const ComparisonOptions& options = comparison.options;
  std::string text = fmt::format(
      "Coverage of the valid nodes in %, budget {}, {}\n\n",
      options.budget ? options.budget->text() : budgets_of(comparison),
      options.all_starts ? "every start once"
                         : fmt::format("{} episodes per map, random starts (seed {})", options.episodes, options.seed));
  std::size_t name_width = 11;
  for (const ComparisonRow& row : comparison.rows) {
    name_width = std::max({name_width, row.map.size(), row.policy.size()});
  }
  const std::size_t maps = comparison.rows.size() / std::max<std::size_t>(comparison.overall.size(), 1);
  for (std::size_t i = 0; i < comparison.overall.size(); ++i) {
    text += format_rows(std::span(comparison.rows).subspan(i * maps, maps), name_width);
  }
  text += fmt::format("{:{}}  {:>5} {:>6}  {}\n", "overall", name_width, "maps", "mean", "share of the optimum");
  for (const ComparisonOverall& overall : comparison.overall) {
    text += fmt::format("{:{}}  {:5} {:>6}  {:>7}\n", overall.policy, name_width, overall.maps, number(overall.mean),
                        overall.ratio_to_optimum ? fmt::format("{:.1f} %", 100 * *overall.ratio_to_optimum) : "–");
  }
  const auto missing = [&](const auto& is_there) {
    return std::any_of(comparison.rows.begin(), comparison.rows.end(),
                       [&](const ComparisonRow& row) { return !is_there(row); });
  };
  if (missing([](const ComparisonRow& row) { return row.optimum.has_value(); })) {
    text += fmt::format("\noptimum –: not computed for maps of more than {} valid nodes or {} states\n",
                        kOptimumMaxNodes, kExactMaxStates);
  }
  if (missing([](const ComparisonRow& row) { return row.coverage.has_value(); })) {
    text += "\nmean –: the policy's search is out of reach on that map\n";
  }
  return text;
}

}  // namespace graphdrl
