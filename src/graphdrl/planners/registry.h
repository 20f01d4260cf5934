// Policies by the names users give them.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "graphdrl/env/policy.h"
#include "graphdrl/planners/plan.h"

namespace graphdrl {

// Planners and policies: `search`, `search:ITERATIONS`, `dfs`, `nearest`, `explorer`, `beam` or `beam:W`, `guided`,
// `guided:W` or `guided:W:FILE`, `exact`, and explorers in policy files, plan whole walks; `random`, `random-walk` and
// the paper's networks in policy files choose step by step. Throw Error on any other name, and on a file that holds no
// policy.
//
// make_planner: null where the name is of one that chooses step by step. seed: of `search`.
std::unique_ptr<Planner> make_planner(const std::string& name, std::uint64_t seed = 1);

// Whatever the name is of; planners are followed step by step.
std::unique_ptr<Policy> make_policy(const std::string& name, std::uint64_t seed);

// Whether the choices of a policy depend on its seed.
bool is_random(const std::string& name);

// "beam[:W], guided[:W[:FILE]], dfs, exact, …, random-walk or a policy file", for help and errors.
std::string policy_names();

// What a policy is called in a table: the name given, a file's stem.
std::string policy_label(const std::string& name);

}  // namespace graphdrl
