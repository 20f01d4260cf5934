// Policies by the names users give them.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <variant>

#include "graphdrl/env/discovery.h"
#include "graphdrl/env/policy.h"
#include "graphdrl/nn/paper_network.h"
#include "graphdrl/planners/beam.h"
#include "graphdrl/planners/explorer.h"
#include "graphdrl/planners/online_explorer.h"
#include "graphdrl/planners/plan.h"

namespace graphdrl {

enum class PolicyKind {
  kRandom,
  kRandomWalk,
  kPocket,
  kOpen,
  kFrontier,
  kTour,  // these choose step by step, and so do the paper's networks in files; others plan whole walks
  kDepthFirst,
  kNearest,
  kBeam,
  kGuided,
  kExplorer,
  kSearch,
  kExact,
  kFile,  // an explorer, an online explorer, or a network of the paper
};

// A trained network: that of a file, or `explorer`, the one in the program. Throws Error where there is none.
using TrainedPolicy = std::variant<SharedExplorer, PaperParameters, SharedOnlineExplorer>;
TrainedPolicy read_policy(const std::string& name);
// The same of networks that look at maps that are known. Throws Error on an online explorer, too.
using KnownMapPolicy = std::variant<SharedExplorer, PaperParameters>;
KnownMapPolicy read_known_map_policy(const std::string& name);

// A policy's name, taken apart.
struct PolicySpec {
  PolicyKind kind;
  int width = BeamOptions{}.width;  // of beam and guided
  std::int64_t iterations = 0;      // of search; 0: as many as the world's size asks for, or the time allows
  int smallest_part = 1;            // of tour: smaller parts of the frontier wait
  TrainedPolicy trained = {};       // of kFile; of guided, null for the explorer in the program
  std::string label = {};           // in tables: the name given, a file's stem
};

// `random`, `random-walk`, `dfs`, `nearest`, `pocket`, `open`, `frontier`, `tour[:M]`, `beam[:W]`, `guided[:W[:FILE]]`,
// `explorer`, `search[:ITERATIONS]`, `exact`, or a policy file, which is read here. Throws Error on any other name, and
// on a file that holds no policy.
PolicySpec parse_policy(const std::string& name);

// Whether it plans whole walks.
bool plans(const PolicySpec& spec);

// Null where it chooses step by step. seed: of `search`.
std::unique_ptr<Planner> make_planner(const PolicySpec& spec, std::uint64_t seed = 1);
// Whatever it is; planners are followed step by step. seed: of `search` and of random policies.
std::unique_ptr<Policy> make_policy(const PolicySpec& spec, std::uint64_t seed);
// The same for an unknown map, of which more is known with each step: rules choose anew instead of planning on, and
// `explorer` is the online one.
std::unique_ptr<Policy> make_online_policy(const PolicySpec& spec, std::uint64_t seed);

// Whether it still plans where the map is not known: on what is known, or on an old map.
bool plans_online(const PolicySpec& spec);
// For an unknown map of which there is an old one: plans on what is believed. Throws Error unless plans_online().
std::unique_ptr<Policy> make_believing_policy(const PolicySpec& spec, std::uint64_t seed,
                                              std::shared_ptr<const BelievedMap> old);
std::unique_ptr<Policy> make_believing_policy(std::unique_ptr<Planner> planner, std::shared_ptr<const BelievedMap> old);

inline std::unique_ptr<Planner> make_planner(const std::string& name, std::uint64_t seed = 1) {
  return make_planner(parse_policy(name), seed);
}
inline std::unique_ptr<Policy> make_policy(const std::string& name, std::uint64_t seed) {
  return make_policy(parse_policy(name), seed);
}

// "beam[:W], guided[:W[:FILE]], dfs, exact, …, random-walk or a policy file", for help and errors.
std::string policy_names();

}  // namespace graphdrl
