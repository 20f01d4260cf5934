#include "graphdrl/eval/seed_distribution.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace graphdrl {
namespace {

constexpr std::array kLadder = {"random-walk", "dfs", "nearest", "exact"};

// The policies of `comparison` are those of the seeds, then the ladder. maps: indices.
SeedRow row_of(const Comparison& comparison, std::size_t seeds, std::string name,
               const std::vector<std::size_t>& maps) {
  const std::size_t all_maps = comparison.rows.size() / comparison.overall.size();
  using Value = std::optional<double> (*)(const ComparisonRow&);
  // Empty where one of the maps has none.
  const auto mean_of = [&](std::size_t policy, Value value) -> std::optional<double> {
    double sum = 0;
    for (const std::size_t map : maps) {
      const std::optional<double> one = value(comparison.rows[policy * all_maps + map]);
      if (!one) return std::nullopt;
      sum += *one;
    }
    return sum / static_cast<double>(maps.size());
  };
  const Value coverage = [](const ComparisonRow& row) {
    return row.coverage ? std::optional(row.coverage->mean) : std::nullopt;
  };
  const Value of_paper = [](const ComparisonRow& row) {
    return row.paper ? std::optional(row.paper->mean) : std::nullopt;
  };
  std::vector<double> means;
  for (std::size_t seed = 0; seed < seeds; ++seed) means.push_back(*mean_of(seed, coverage));
  const Summary summary = summarise(means);
  SeedRow row{.name = std::move(name),
              .several = maps.size() > 1,
              .means = means,
              .over_seeds = summary,
              .lowest = quantile(means, 0),
              .lower_quartile = quantile(means, 0.25),
              .median = quantile(means, 0.5),
              .upper_quartile = quantile(means, 0.75),
              .paper = mean_of(0, of_paper),
              .paper_z = {},
              .random_walk = *mean_of(seeds, coverage),
              .depth_first = *mean_of(seeds + 1, coverage),
              .nearest = *mean_of(seeds + 2, coverage),
              .optimum = mean_of(seeds + 3, coverage)};
  if (row.paper && summary.std && *summary.std > 0) row.paper_z = (*row.paper - summary.mean) / *summary.std;
  return row;
}

}  // namespace

SeedDistribution distribution_over_seeds(const std::vector<std::string>& policy_files, const std::vector<World>& worlds,
                                         const std::vector<std::string>& trained_on,
                                         const std::optional<Budget>& budget) {
  ComparisonOptions options{.policies = policy_files, .budget = budget, .all_starts = true};
  options.policies.insert(options.policies.end(), kLadder.begin(), kLadder.end());
  const Comparison comparison = compare(worlds, options);
  const auto row = [&](const std::string& name, const std::vector<std::size_t>& maps) {
    return row_of(comparison, policy_files.size(), name, maps);
  };
  SeedDistribution distribution{.rows = {}, .budget = comparison.rows.front().budget};
  std::vector<std::size_t> all;
  std::vector<std::size_t> unseen;
  for (std::size_t map = 0; map < worlds.size(); ++map) {
    const std::string& name = worlds[map].name();
    distribution.rows.push_back(row(name, {map}));
    all.push_back(map);
    if (std::find(trained_on.begin(), trained_on.end(), name) == trained_on.end()) unseen.push_back(map);
  }
  if (unseen.size() > 1 && unseen.size() < all.size()) distribution.rows.push_back(row("unseen", unseen));
  if (all.size() > 1) distribution.rows.push_back(row("all", all));
  return distribution;
}

std::string format_distribution(const SeedDistribution& distribution) {
  std::size_t width = 4;
  for (const SeedRow& row : distribution.rows) width = std::max(width, row.name.size());
  std::string text = fmt::format(
      "Over {} seeds, each from every start: percent of the valid nodes visited\n\n"
      "{:<{}}   mean    std    min   25 % median   75 %    max | paper     z |  walk   dfs nearest optimum\n",
      distribution.rows.front().means.size(), "map", width);
  for (const SeedRow& row : distribution.rows) {
    text += fmt::format(
        "{:<{}} {:6.1f} {:>6} {:6.1f} {:6.1f} {:6.1f} {:6.1f} {:6.1f} | {:>5} {:>5} | {:5.1f} {:5.1f} "
        "{:7.1f} {:>7}\n",
        row.name, width, row.over_seeds.mean, or_dash(row.over_seeds.std), row.lowest, row.lower_quartile, row.median,
        row.upper_quartile, row.over_seeds.best, or_dash(row.paper), or_dash(row.paper_z, "{:+.1f}"), row.random_walk,
        row.depth_first, row.nearest, or_dash(row.optimum));
  }
  return text;
}

std::string markdown_distribution(const SeedDistribution& distribution) {
  std::string text =
      "| map | mean ± std over seeds | min – max | quartiles | the paper | its z | random-walk | dfs | nearest | "
      "optimum "
      "|\n|---|---|---|---|---|---|---|---|---|---|\n";
  for (const SeedRow& row : distribution.rows) {
    const std::string name = row.several ? "**" + row.name + "**" : row.name;
    text += fmt::format(
        "| {} | {:.1f} ± {} | {:.1f} – {:.1f} | {:.1f}, {:.1f}, {:.1f} | {} | {} | {:.1f} | {:.1f} | "
        "{:.1f} | {} |\n",
        name, row.over_seeds.mean, or_dash(row.over_seeds.std), row.lowest, row.over_seeds.best, row.lower_quartile,
        row.median, row.upper_quartile, or_dash(row.paper), or_dash(row.paper_z, "{:+.1f}"), row.random_walk,
        row.depth_first, row.nearest, or_dash(row.optimum));
  }
  return text;
}

}  // namespace graphdrl
