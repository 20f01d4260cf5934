// Policies by the names users give them.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "graphdrl/env/policy.h"

namespace graphdrl {

// `random`, `random-walk`, `dfs`, `nearest`, `exact`, or a policy file. Throws Error on any other name and on a file
// that holds no policy.
std::unique_ptr<Policy> make_policy(const std::string& name, std::uint64_t seed);

// "dfs, exact, nearest, random, random-walk or a policy file", for help and errors.
std::string policy_names();

// What a policy is called in a table: the name given, a file's stem.
std::string policy_label(const std::string& name);

}  // namespace graphdrl
