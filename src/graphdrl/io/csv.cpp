#include "graphdrl/io/csv.h"

#include <algorithm>

#include "graphdrl/io/graph_builder.h"
#include "graphdrl/io/text.h"

namespace graphdrl {

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

int column_of(const std::vector<std::string>& fields, std::span<const std::string_view> names) {
  for (const std::string_view name : names) {
    const auto field =
        std::find_if(fields.begin(), fields.end(), [&](const auto& one) { return same_name(one, name); });
    if (field != fields.end()) return static_cast<int>(field - fields.begin());
  }
  return kNoColumn;
}

}  // namespace graphdrl
