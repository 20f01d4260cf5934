// JSON from files that may hold anything: the nesting is limited, so that nothing that recurses runs out of stack.
#pragma once

#include <exception>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

#include "graphdrl/base/error.h"

namespace graphdrl {

inline constexpr int kMaxJsonDepth = 100;  // objects and arrays in each other

// A whole document. Throws Error, naming `source` and the line where it knows it, on anything else and on one nested
// deeper than kMaxJsonDepth; `expected` says what the document should have been.
nlohmann::json parse_json(std::string_view text, const std::string& source,
                          const std::string& expected = "a JSON document");

// The same, but gives a discarded value, which is neither object nor array nor anything else, instead of an Error.
nlohmann::json parse_json_or_discard(std::string_view text);

// Throws Error where objects and arrays are nested deeper than kMaxJsonDepth. Only looks at brackets and quotes.
void require_shallow_json(std::string_view text, const std::string& source);

// The Error for what nlohmann's parsers complain about, `position` bytes after the begin of the text.
Error json_error(const std::exception& complaint, std::size_t position, std::string_view text,
                 const std::string& source, const std::string& expected);

// The begin of a value as compact JSON, in quotes, for an error's message. However large and deep the
// value is, time and stack stay small.
std::string shortened(const nlohmann::json& value, std::size_t max_length = 60);

}  // namespace graphdrl
