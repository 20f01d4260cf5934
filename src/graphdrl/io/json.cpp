#include "graphdrl/io/json.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "graphdrl/io/text.h"

namespace graphdrl {
namespace {

using nlohmann::json;

// Where nesting passes the limit first; npos where it does not. Exact as far as the text is JSON.
std::size_t find_too_deep(std::string_view text) {
  int depth = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_string) {
      if (c == '\\') {
        ++i;
      } else if (c == '"') {
        in_string = false;
      }
    } else if (c == '"') {
      in_string = true;
    } else if (c == '[' || c == '{') {
      if (++depth > kMaxJsonDepth) return i;
    } else if (c == ']' || c == '}') {
      --depth;
    }
  }
  return std::string_view::npos;
}

// Appends compact JSON until the text is longer than max_length.
void append_begin(const json& value, std::size_t max_length, int depth, std::string& text) {
  if (text.size() > max_length) return;
  if (value.is_structured() && depth == kMaxJsonDepth) {
    text += "…";
  } else if (value.is_structured()) {
    text += value.is_object() ? '{' : '[';
    for (auto item = value.begin(); item != value.end() && text.size() <= max_length; ++item) {
      if (item != value.begin()) text += ',';
      if (value.is_object()) text += json(item.key()).dump(-1, ' ', false, json::error_handler_t::replace) + ':';
      append_begin(*item, max_length, depth + 1, text);
    }
    text += value.is_object() ? '}' : ']';
  } else {
    text += value.dump(-1, ' ', false, json::error_handler_t::replace);
  }
}

}  // namespace

json parse_json(std::string_view text, const std::string& source, const std::string& expected) {
  require_shallow_json(text, source);
  try {
    return json::parse(text);
  } catch (const json::parse_error& error) {
    throw json_error(error, error.byte, text, source, expected);
  } catch (const json::out_of_range& error) {
    throw json_error(error, text.size(), text, source, expected);
  }
}

json parse_json_or_discard(std::string_view text) {
  if (find_too_deep(text) != std::string_view::npos) return json(json::value_t::discarded);
  return json::parse(text, nullptr, /*allow_exceptions=*/false);
}

void require_shallow_json(std::string_view text, const std::string& source) {
  const std::size_t position = find_too_deep(text);
  if (position == std::string_view::npos) return;
  throw Error({.what = "the JSON is nested too deeply",
               .expected = fmt::format("at most {} levels of objects and arrays", kMaxJsonDepth),
               .where = place_in(text, position, source)});
}

Error json_error(const std::exception& complaint, std::size_t position, std::string_view text,
                 const std::string& source, const std::string& expected) {
  if (dynamic_cast<const json::out_of_range*>(&complaint) != nullptr) {
    return Error({.what = "a number too large", .where = source});
  }
  for (const std::string_view word : {"NaN", "Infinity"}) {  // Python's json writes these
    if (position > 0 && text.substr(position - 1).starts_with(word)) {
      return Error({.what = "not JSON",
                    .expected = "a number or null",
                    .got = in_quotes(word),
                    .where = place_in(text, position, source)});
    }
  }
  return Error({.what = "not JSON", .expected = expected, .where = place_in(text, position, source)});
}

std::string shortened(const json& value, std::size_t max_length) {
  std::string text;
  append_begin(value, max_length, 0, text);
  return in_quotes(text, max_length);
}

}  // namespace graphdrl
