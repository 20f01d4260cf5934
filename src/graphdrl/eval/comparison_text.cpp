#include <fmt/format.h>

#include <algorithm>

#include "graphdrl/base/error.h"
#include "graphdrl/eval/comparison.h"
#include "graphdrl/planners/exact.h"

namespace graphdrl {
namespace {

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
                        coverage ? or_dash(coverage->mean) : "–", coverage ? or_dash(coverage->std) : "–",
                        coverage ? or_dash(coverage->best) : "–", interval(coverage ? coverage->ci95 : std::nullopt),
                        or_dash(row.optimum));
    if (row.paper) {
      text += fmt::format(" |        {:6.1f} {:5.1f} {:5.1f}", row.paper->mean, row.paper->std, row.paper->best);
    }
    text += '\n';
  }
  return text + '\n';
}

// "88.4 ± 0.5"
std::string with_error(const std::optional<Summary>& summary, const char* format) {
  if (!summary) return "–";
  const std::string mean = or_dash(summary->mean, format);
  return summary->ci95 ? fmt::format("{} ± {}", mean, or_dash(summary->ci95->high - summary->mean, format)) : mean;
}

// A table per family, a line per policy.
std::string format_families(const Comparison& comparison, std::size_t name_width) {
  std::string text;
  const std::size_t policies = comparison.overall.size();
  const std::size_t count = comparison.families.size() / policies;
  for (std::size_t family = 0; family < count; ++family) {
    const FamilyRow& first = comparison.families[family];
    text += fmt::format("{:{}}  {:>5} {:>12}  {:>12}  {:>18}\n", first.family, name_width, "maps", "mean", "known",
                        "price of ignorance");
    for (std::size_t policy = 0; policy < policies; ++policy) {
      const FamilyRow& row = comparison.families[policy * count + family];
      text += fmt::format("{:{}}  {:5} {:>12}  {:>12}  {:>18}\n", row.policy, name_width, row.maps,
                          with_error(row.coverage, "{:.1f}"), with_error(row.known, "{:.1f}"),
                          with_error(row.price, "{:.3f}"));
    }
    text += '\n';
  }
  return text;
}

struct Wording {
  std::string none;
  std::string some;
  std::string all;
};

// What is said where none of the rows is so, where some are, where all are.
template <typename IsSo>
std::string by_share(const std::vector<ComparisonRow>& rows, const IsSo& is_so, const Wording& wording) {
  const auto count = std::count_if(rows.begin(), rows.end(), is_so);
  return count == 0 ? wording.none : count == std::ssize(rows) ? wording.all : wording.some;
}

std::string what_is_measured(const Comparison& comparison) {
  if (comparison.options.counts_edges()) {
    return comparison.options.until_covered ? "Cost until no edge is left" : "Edges walked, or their prizes, in %";
  }
  if (comparison.options.until_covered) return "Cost until nothing is left that is known";
  return by_share(comparison.rows, [](const ComparisonRow& row) { return row.has_prizes; },
                  {.none = "Coverage of the valid nodes in %",
                   .some = "Coverage of the valid nodes, or of the sum of prizes where a map has them, in %",
                   .all = "Coverage of the sum of prizes in %"});
}

std::string budgets_of(const Comparison& comparison) {
  const auto& rows = comparison.rows;
  if (comparison.options.until_covered) return "none";
  if (comparison.options.budget) return comparison.options.budget->text();
  const double first = rows.front().budget;
  const bool same =
      std::all_of(rows.begin(), rows.end(), [&](const ComparisonRow& row) { return row.budget == first; });
  if (same) return fmt::format("{:g}", first);
  const bool own = std::all_of(rows.begin(), rows.end(), [](const ComparisonRow& row) { return row.given.budget; });
  return own ? "the maps' own" : fmt::format("the maps' own, else {:g}", kPaperBudget);
}

std::string starts_of(const Comparison& comparison) {
  const ComparisonOptions& options = comparison.options;
  if (options.all_starts) return "every start once";
  const std::string episodes = fmt::format("{} episode{} per map", options.episodes, options.episodes == 1 ? "" : "s");
  if (!options.start.empty()) return fmt::format("{} from {}", episodes, in_quotes(options.start));
  const auto starts = by_share(comparison.rows, [](const ComparisonRow& row) { return row.given.start != kNoNode; },
                               {.none = fmt::format("random starts (seed {})", options.seed),
                                .some = fmt::format("the maps' own starts, else random ones (seed {})", options.seed),
                                .all = "the maps' own starts"});
  return episodes + ", " + starts;
}

// Begins with a comma; empty where nothing is said of ends.
std::string ends_of(const Comparison& comparison) {
  const std::string& end = comparison.options.end;
  if (end == "anywhere") return ", walks end anywhere";
  if (end == "start") return ", walks end where they start";
  if (!end.empty()) return fmt::format(", walks end at {}", in_quotes(end));
  return by_share(comparison.rows, [](const ComparisonRow& row) { return row.given.end != kNoNode; },
                  {.none = "",
                   .some = ", walks end at the maps' own ends, else anywhere",
                   .all = ", walks end at the maps' own ends"});
}

}  // namespace

std::string format_comparison(const Comparison& comparison) {
  const ComparisonOptions& options = comparison.options;
  std::string text = fmt::format("{}{}, budget {}, {}{}\n\n", what_is_measured(comparison),
                                 options.reveal.all() ? ""
                                                      : fmt::format(", {}of unknown maps that reveal {}",
                                                                    options.counts_edges()          ? ""
                                                                    : options.score == Score::kSeen ? "nodes seen, "
                                                                                                    : "nodes visited, ",
                                                                    options.reveal.text()),
                                 budgets_of(comparison), starts_of(comparison), ends_of(comparison));
  std::size_t name_width = 11;
  for (const ComparisonRow& row : comparison.rows) {
    name_width = std::max({name_width, row.map.size(), row.policy.size()});
  }
  const std::size_t maps = comparison.rows.size() / std::max<std::size_t>(comparison.overall.size(), 1);
  for (const FamilyRow& row : comparison.families) name_width = std::max(name_width, row.family.size());
  text += format_families(comparison, name_width);
  for (std::size_t i = 0; i < comparison.overall.size() && comparison.families.empty(); ++i) {
    text += format_rows(std::span(comparison.rows).subspan(i * maps, maps), name_width);
  }
  text += fmt::format("{:{}}  {:>5} {:>6}  {}\n", "overall", name_width, "maps", "mean", "share of the optimum");
  for (const ComparisonOverall& overall : comparison.overall) {
    text += fmt::format("{:{}}  {:5} {:>6}  {:>7}\n", overall.policy, name_width, overall.maps, or_dash(overall.mean),
                        overall.ratio_to_optimum ? fmt::format("{:.1f} %", 100 * *overall.ratio_to_optimum) : "–");
  }
  const auto missing = [&](const auto& is_there) {
    return std::any_of(comparison.rows.begin(), comparison.rows.end(),
                       [&](const ComparisonRow& row) { return !is_there(row); });
  };
  const bool has_optimum = !options.until_covered && options.score == Score::kVisited && !options.counts_edges();
  if (has_optimum && missing([](const ComparisonRow& row) { return row.optimum.has_value(); })) {
    text += fmt::format("\noptimum –: not computed for maps of more than {} valid nodes or {} states\n",
                        kOptimumMaxNodes, kExactMaxStates);
  }
  if (missing([](const ComparisonRow& row) { return row.coverage.has_value(); })) {
    text += "\nmean –: the policy's search is out of reach on that map\n";
  }
  return text;
}

}  // namespace graphdrl
