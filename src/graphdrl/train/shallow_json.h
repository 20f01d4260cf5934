// JSON from files that a stranger may have written.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace graphdrl {

// Parses `text`; what is no JSON gives a discarded value. Throws Error, naming `where`, on values nested deeper than
// any file of a training: copying or printing a value goes as deep as it is nested, and the stack does not.
nlohmann::ordered_json parse_shallow_json(const std::string& text, const std::string& where);

}  // namespace graphdrl
