// Policies by the names users give them.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "graphdrl/env/policy.h"
#include "graphdrl/planners/plan.h"

namespace graphdrl {

// `random`, `random-walk`, `dfs`, `nearest`, `explorer`, `beam` or `beam:W`, `guided`, `guided:W` or `guided:W:FILE`,
// `exact`, or a policy file. The time limit holds for each plan of a beam or an exact search. Throws Error on any other
// name, on a file that holds no policy, and on a time limit for a policy that plans nothing.
std::unique_ptr<Policy> make_policy(const std::string& name, std::uint64_t seed, TimeLimit limit = {});

// "beam[:W], guided[:W[:FILE]], dfs, exact, …, random-walk or a policy file", for help and errors.
std::string policy_names();

// What a policy is called in a table: the name given, a file's stem.
std::string policy_label(const std::string& name);

}  // namespace graphdrl
