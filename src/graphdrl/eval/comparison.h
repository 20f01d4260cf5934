// The comparison of policies on maps: the paper's Table 2, the ladder beside it, and the optimum.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "graphdrl/env/discovery.h"
#include "graphdrl/env/policy.h"
#include "graphdrl/env/task.h"
#include "graphdrl/env/world.h"
#include "graphdrl/eval/statistics.h"
#include "graphdrl/io/task_folder.h"
#include "graphdrl/planners/plan.h"

namespace graphdrl {

// One line of the paper's Table 2, in percent.
struct PaperResult {
  double mean;
  double std;
  double best;
};

// For a map `paper:a` … `paper:j` under a budget of 25; empty elsewhere.
std::optional<PaperResult> paper_result(const std::string& map, double budget);

inline constexpr double kPaperBudget = 25;

struct ComparisonOptions {
  std::vector<std::string> policies;  // as make_policy takes them
  std::optional<Budget> budget = {};  // the default is the map's own, else kPaperBudget
  std::string start = {};             // as parse_node() takes it; the default is the map's own, else random ones
  std::string end = {};               // as parse_end() takes it; the default is the map's own, else anywhere
  int episodes = 30;                  // per map, from the same starts for every policy
  bool all_starts = false;            // instead: every valid node once
  std::uint64_t seed = 1;
  Reveal reveal = {};  // of unknown maps; these are walked by neighbours
  Score score = Score::kVisited;
  // Of unknown maps: instead of a budget, until nothing is left that is known. Costs are what is measured then.
  bool until_covered = false;
  // Of unknown maps: seconds that `search` may take for a walk that knows the map, from each start of each. Needed
  // where the optimum is not computed.
  std::optional<double> price_s = {};
  // [worlds] or empty: an old map of each unknown one, by which the policies plan that do.
  std::vector<std::shared_ptr<const BelievedMap>> believed = {};
  std::vector<std::string> families = {};  // [worlds] or empty: the family of each, to be summarised by
  // Policies of the caller's own, by names of `policies` that are theirs. Several may be at work at once.
  std::map<std::string, std::function<std::unique_ptr<Policy>()>> own_policies = {};
  // Where edges count instead of nodes: answers a task by a policy of a name. Empty: nodes count.
  struct Walked {
    double percent;  // of the edges
    double cost;
  };
  std::function<Walked(const World& world, const Task& task, const std::string& policy, std::uint64_t seed)>
      cover_edges = {};
  // The same, knowing the map, in price_s.
  std::function<Walked(const World& world, const Task& task)> cover_known_edges = {};
  bool counts_edges() const { return cover_edges != nullptr; }
};

inline constexpr int kOptimumMaxNodes = 25;  // valid nodes up to which the optimum is computed

// Coverages in percent; where there are prizes, of their sum. Until covered: costs.
struct ComparisonRow {
  std::string map;
  std::string policy;
  int valid_nodes;
  bool has_prizes;
  GivenTask given;  // what the map itself says; options may say otherwise
  double budget;
  int episodes;
  std::optional<Summary> coverage;   // empty where the policy's search is out of reach
  std::optional<double> optimum;     // mean over the same starts; empty where out of reach
  std::optional<PaperResult> paper;  // of walks that may end anywhere, as the paper's do
  std::optional<Summary> known;      // of unknown maps: of walks that know them, over the same starts
  // The price of ignorance, the mean over starts.
  std::optional<Summary> price;
};

// What `search` finds in so many seconds for a walk that knows the map. until_covered: the cheapest walk that visits
// everything in reach: `search` looks for ever cheaper ones, since it ends with the first where the budget pays for
// all.
Plan plan_knowing_the_map(const Task& task, bool until_covered, double seconds, std::uint64_t seed, const Clock& clock);

// What a walk gets that knows the map, as a multiple of what one gets that does not; of costs the other way round. 1
// where there is nothing to divide by.
double price_of_ignorance(double known, double unknown, bool costs);

// A policy on the maps of a family: of its maps' means, or of the episodes of its only map.
struct FamilyRow {
  std::string family;
  std::string policy;
  int maps;  // with a coverage
  std::optional<Summary> coverage;
  std::optional<Summary> known;  // as ComparisonRow's
  std::optional<Summary> price;
};

struct ComparisonOverall {
  std::string policy;
  int maps;                    // with a coverage
  std::optional<double> mean;  // of the maps' means
  // mean ÷ mean optimum, a fraction; 1 where no walk is worth anything. Empty unless every map has an optimum.
  std::optional<double> ratio_to_optimum;
};

struct Comparison {
  ComparisonOptions options;
  std::vector<ComparisonRow> rows;  // by policy, then by map, both in the order given
  std::vector<ComparisonOverall> overall;
  std::vector<FamilyRow> families;  // by policy, then by family, in the order of the maps
};

// Grids are walked in directions, other worlds by neighbours. Once the clock passes, episodes end where they are.
// Throws Error on a bad policy or option.
Comparison compare(const std::vector<World>& worlds, const ComparisonOptions& options, const Clock& clock = {});

// The same over ranks, or a share of it; results are kept in a folder, if there is one, and computed once. Nothing
// where results of other shares are lacking. Rows lack a coverage where a task failed too often. Throws Error as
// TaskFolder::run(), too. Collective.
std::optional<Comparison> compare(const std::vector<World>& worlds, const ComparisonOptions& options,
                                  const TaskWorkers& workers, const TaskFolder* folder, const Clock& clock = {});

// The comparison as a text: a table per policy, and a line per policy over all maps.
std::string format_comparison(const Comparison& comparison);

}  // namespace graphdrl
