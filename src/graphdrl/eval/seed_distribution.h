// The paper's Table 2 as a distribution: what trainings that differ in their seeds alone reach.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "graphdrl/eval/comparison.h"

namespace graphdrl {

// Coverages in percent, from every valid node once.
struct SeedRow {
  std::string name;  // a map; of several, "unseen" or "all"
  bool several;
  std::vector<double> means;  // of each seed
  Summary over_seeds;         // of these
  double lowest;
  double lower_quartile;
  double median;
  double upper_quartile;
  std::optional<double> paper;  // the paper's mean over 30 episodes, of the same maps
  // (paper - mean) / std over seeds. The paper's mean is of 30 random starts; the error of that sample is not in it.
  std::optional<double> paper_z;
  double random_walk;
  double depth_first;
  double nearest;
  std::optional<double> optimum;
};

struct SeedDistribution {
  std::vector<SeedRow> rows;  // each map; those that no seed was trained on; all
  double budget;
};

// A policy file for each seed, on each world; `trained_on`: names of worlds. Throws Error as compare() does.
SeedDistribution distribution_over_seeds(const std::vector<std::string>& policy_files, const std::vector<World>& worlds,
                                         const std::vector<std::string>& trained_on,
                                         const std::optional<Budget>& budget);

// As text.
std::string format_distribution(const SeedDistribution& distribution);
// As a table of Markdown.
std::string markdown_distribution(const SeedDistribution& distribution);

}  // namespace graphdrl
