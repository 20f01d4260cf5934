#include "graphdrl/eval/seed_distribution.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>

namespace graphdrl {
namespace {

constexpr std::size_t kLadderSize = 4;
constexpr const char* kLadderNames[kLadderSize] = {"random-walk", "dfs", "nearest", "exact"};

// The mean of what some maps have; empty where one has none.
std::optional<double> mean_over(const std::vector<std::size_t>& maps,
                                const std::function<std::optional<double>(std::size_t map)>& value) {
  double sum = 0;
  for (const std::size_t map : maps) {
    const std::optional<double> one = value(map);
    if (!one) return std::nullopt;
    sum += *one;
  }
  return sum / static_cast<double>(maps.size());
}

class Table {
 public:
  Table(const Comparison& comparison, std::size_t seeds, std::size_t maps)
      : comparison_(comparison), seeds_(seeds), maps_(maps) {}

  SeedRow row(std::string name, const std::vector<std::size_t>& maps) const {
    std::vector<double> means;
    for (std::size_t seed = 0; seed < seeds_; ++seed) means.push_back(*mean_of(seed, maps));
    const Summary summary = summarise(means);
    SeedRow row{.name = std::move(name),
                .several = maps.size() > 1,
                .means = means,
                .over_seeds = summary,
                .lowest = quantile(means, 0),
                .lower_quartile = quantile(means, 0.25),
                .median = quantile(means, 0.5),
                .upper_quartile = quantile(means, 0.75),
                .paper = mean_over(maps, [&](std::size_t map) { return paper_of(map); }),
                .paper_z = {},
                .random_walk = *mean_of(seeds_, maps),
                .depth_first = *mean_of(seeds_ + 1, maps),
                .nearest = *mean_of(seeds_ + 2, maps),
                .optimum = mean_of(seeds_ + 3, maps)};
    if (row.paper && summary.std && *summary.std > 0) row.paper_z = (*row.paper - summary.mean) / *summary.std;
    return row;
  }

 private:
  const ComparisonRow& of(std::size_t policy, std::size_t map) const { return comparison_.rows[policy * maps_ + map]; }

  std::optional<double> mean_of(std::size_t policy, const std::vector<std::size_t>& maps) const {
    return mean_over(maps, [&](std::size_t map) -> std::optional<double> {
      const std::optional<Summary>& coverage = of(policy, map).coverage;
      return coverage ? std::optional(coverage->mean) : std::nullopt;
    });
  }

  std::optional<double> paper_of(std::size_t map) const {
    const std::optional<PaperResult>& paper = of(0, map).paper;
    return paper ? std::optional(paper->mean) : std::nullopt;
  }

  const Comparison& comparison_;
  std::size_t seeds_;
  std::size_t maps_;
};

std::string one_decimal(const std::optional<double>& value, const char* format = "{:.1f}") {
  return value ? fmt::format(fmt::runtime(format), *value) : "–";
}

}  // namespace

SeedDistribution distribution_over_seeds(const std::vector<std::string>& policy_files, const std::vector<World>& worlds,
                                         const std::vector<std::string>& trained_on,
                                         const std::optional<Budget>& budget) {
  ComparisonOptions options{.policies = policy_files, .budget = budget, .all_starts = true};
  options.policies.insert(options.policies.end(), std::begin(kLadderNames), std::end(kLadderNames));
  const Comparison comparison = compare(worlds, options);
  const Table table(comparison, policy_files.size(), worlds.size());
  SeedDistribution distribution{.rows = {}, .budget = comparison.rows.front().budget};
  std::vector<std::size_t> all;
  std::vector<std::size_t> unseen;
  for (std::size_t map = 0; map < worlds.size(); ++map) {
    const std::string& name = worlds[map].name();
    distribution.rows.push_back(table.row(name, {map}));
    all.push_back(map);
    if (std::find(trained_on.begin(), trained_on.end(), name) == trained_on.end()) unseen.push_back(map);
  }
  if (unseen.size() > 1 && unseen.size() < all.size()) distribution.rows.push_back(table.row("unseen", unseen));
  if (all.size() > 1) distribution.rows.push_back(table.row("all", all));
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
        row.name, width, row.over_seeds.mean, one_decimal(row.over_seeds.std), row.lowest, row.lower_quartile,
        row.median, row.upper_quartile, row.over_seeds.best, one_decimal(row.paper),
        one_decimal(row.paper_z, "{:+.1f}"), row.random_walk, row.depth_first, row.nearest, one_decimal(row.optimum));
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
        name, row.over_seeds.mean, one_decimal(row.over_seeds.std), row.lowest, row.over_seeds.best, row.lower_quartile,
        row.median, row.upper_quartile, one_decimal(row.paper), one_decimal(row.paper_z, "{:+.1f}"), row.random_walk,
        row.depth_first, row.nearest, one_decimal(row.optimum));
  }
  return text;
}

}  // namespace graphdrl
