#include "graphdrl/io/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "graphdrl/base/error.h"

namespace graphdrl {

std::optional<double> parse_number(std::string_view text) {
  if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value + 0.0;
}

std::optional<double> parse_whole(std::string_view text, double least, double most) {
  const std::optional<double> value = parse_number(text);
  return value && *value >= least && *value <= most && *value == std::floor(*value) ? value : std::nullopt;
}

bool same_name(std::string_view one, std::string_view other) {
  const auto lower = [](char c) { return static_cast<char>(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c); };
  return std::equal(one.begin(), one.end(), other.begin(), other.end(),
                    [&](char a, char b) { return lower(a) == lower(b); });
}

std::string_view trimmed(std::string_view text, std::string_view blanks) {
  text.remove_prefix(std::min(text.find_first_not_of(blanks), text.size()));
  return text.substr(0, text.find_last_not_of(blanks) + 1);
}

std::string_view take_word(std::string_view& line) {
  line = trimmed(line);
  const std::string_view word = line.substr(0, line.find_first_of(" \t"));
  line = trimmed(line.substr(word.size()));
  return word;
}

std::string place_in(std::string_view text, std::size_t at, const std::string& source) {
  const std::string_view before = text.substr(0, at);
  return fmt::format("{}:{}", source, 1 + std::count(before.begin(), before.end(), '\n'));
}

bool Lines::next() {
  if (rest_.empty()) return false;
  const std::size_t end = std::min(rest_.find_first_of("\r\n"), rest_.size());
  line_ = rest_.substr(0, end);
  rest_.remove_prefix(std::min(rest_.size(), end + (rest_.substr(end).starts_with("\r\n") ? 2 : 1)));
  ++number_;
  return true;
}

std::string Lines::place() const {
  return fmt::format("{}:{}", source_, number_);
}

void Lines::fail(const std::string& what, const std::string& expected) const {
  throw Error({.what = what, .expected = expected, .got = in_quotes(line_), .where = place()});
}

bool is_comment(std::string_view line) {
  line = trimmed(line);
  return line.empty() || line.front() == '#' || line.front() == '%';
}

char separator_of(std::string_view line) {
  std::string plain;  // without what is in quotes; a dictionary of networkx has commas of its own
  bool quoted = false;
  for (const char c : line.substr(0, line.find('{'))) {
    if (c == '"') quoted = !quoted;
    if (!quoted) plain += c;
  }
  // A comma may be one of a number's, where something else parts the fields.
  for (const char separator : {'\t', ';', ','}) {
    if (plain.find(separator) != std::string::npos) return separator;
  }
  return ' ';
}

std::vector<std::string> split_fields(std::string_view line, char separator) {
  std::vector<std::string> fields;
  for (;;) {
    line = trimmed(line);
    if (separator == ' ' && line.empty()) return fields;
    if (line.starts_with('{')) {
      fields.emplace_back(line);
      return fields;
    }
    std::string field;
    if (line.starts_with('"')) {
      std::size_t at = 1;
      for (;; ++at) {
        if (at >= line.size()) return {};
        if (line[at] != '"') {
          field += line[at];
        } else if (at + 1 < line.size() && line[at + 1] == '"') {
          field += line[at++];
        } else {
          break;
        }
      }
      line = trimmed(line.substr(at + 1));
      if (!line.empty() && separator != ' ' && line.front() != separator) return {};
    } else {
      const std::size_t end = separator == ' ' ? line.find_first_of(" \t") : line.find(separator);
      field = trimmed(line.substr(0, end));
      line.remove_prefix(std::min(end, line.size()));
    }
    fields.push_back(std::move(field));
    if (separator == ' ') continue;
    if (line.empty()) return fields;
    line.remove_prefix(1);
  }
}

int column_of(std::span<const std::string> fields, std::span<const std::string_view> names) {
  for (const std::string_view name : names) {
    const auto field =
        std::find_if(fields.begin(), fields.end(), [&](const auto& one) { return same_name(one, name); });
    if (field != fields.end()) return static_cast<int>(field - fields.begin());
  }
  return kNoColumn;
}

}  // namespace graphdrl
