// One task answered: the plan, its bound, and what is said beside them.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "graphdrl/answer/edge_cover.h"
#include "graphdrl/eval/rollout.h"
#include "graphdrl/planners/registry.h"

namespace graphdrl {

// A plan, and what is said beside it.
struct Answer {
  World world;
  Task task;
  std::string policy;  // as users name it
  Plan plan;
  int unreachable = 0;  // valid nodes that no walk can reach, whatever it spends
  double elapsed_s = 0;
  Reveal reveal = {};  // what was not known beforehand …
  Score score = Score::kVisited;
  Discovered discovered = {};      // … and how it became known
  std::optional<Plan> known = {};  // by a walk that knows the map, where that was asked for
  bool until_covered = false;      // costs tell walks apart, not what they visit
  // Where edges count; the plan's walk then leaves out loops, and its prize and bound are those of nodes. The world has
  // the resets that were made as edges.
  std::optional<EdgeCover> edges = {};

  // What it costs not to know the map [eval/comparison.h]; empty where that was not asked for, or where costs are to be
  // compared of walks that visit different nodes.
  std::optional<double> price_of_ignorance() const;

  // By any walk, at most: all valid nodes where the plan has no bound. REQUIRES: the world has no prizes.
  int max_visited() const { return static_cast<int>(std::clamp<double>(plan.bound, 0, world.valid_count())); }
};

// Where nobody asks for another: where the map is known, where it is not, where cells are then seen from afar and
// count, and where there is an old map besides.
inline constexpr const char* kPlanPolicy = "search";
inline constexpr const char* kOnlinePolicy = "explorer";
inline constexpr const char* kSeeingPolicy = "tour";
inline constexpr const char* kBelievingPolicy = "search:10000";  // plans often

struct PlanRequest {
  std::string policy = {};                      // as parse_policy() takes it; empty for the default
  std::uint64_t seed = 1;                       // of `search` and of random policies
  std::optional<std::int64_t> iterations = {};  // of `search`, instead of those in its name
  Reveal reveal = {};                           // unless all is known, the policy explores instead of planning
  Score score = Score::kVisited;
  Cover cover = Cover::kNodes;                       // edges: of known maps
  std::optional<double> reset_cost = {};             // where edges count, of a directed graph: of a jump to the start
  std::shared_ptr<const BelievedMap> believed = {};  // an old map, by which the policy plans; null without one
  bool until_covered = false;                        // the task has no budget
  double think_s = kNoLimit;                         // of an exploration, for a choice
  std::optional<double> price_s = {};                // likewise: seconds for a walk that knows the map, by `search`
  // One of these instead of a policy that has a name here; `policy` is then what it is called.
  std::function<std::unique_ptr<Planner>()> own_planner = {};
  std::function<std::unique_ptr<Policy>()> own_policy = {};
};

// Plans one walk and bounds it, both until the clock passes. A walk that explores is bounded by what one could do that
// knew the map; where what is seen counts, it is not. Throws Error on a policy that there is not.
Answer make_plan(const World& world, const Task& task, const PlanRequest& request, const Clock& clock = {});

// The answer that a walk over edges is.
Answer edge_answer(const World& world, const Task& task, EdgeCover cover, const std::string& policy);

// Bounds a walk of any origin, as tightly as `search` does without a time limit, and counts what no walk can reach.
void judge(Answer& answer);

// A few lines, for people: what the walk visits, what it is worth and costs, and the bound.
std::vector<std::string> plan_summary(const Answer& answer);

}  // namespace graphdrl
