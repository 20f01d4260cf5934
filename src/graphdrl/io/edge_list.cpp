#include "graphdrl/io/edge_list.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "graphdrl/base/error.h"
#include "graphdrl/io/csv.h"
#include "graphdrl/io/graph_builder.h"
#include "graphdrl/io/text.h"

namespace graphdrl {
namespace {

constexpr std::array<std::string_view, 4> kSourceNames = {"source", "from", "src", "u"};
constexpr std::array<std::string_view, 4> kTargetNames = {"target", "to", "dst", "v"};

// What a dictionary of Python has under the first of these names that it has; empty where it has none.
std::string_view value_in_dictionary(std::string_view text, std::span<const std::string_view> names) {
  if (!text.ends_with('}')) return text;
  for (const std::string_view name : names) {
    for (const char quote : {'\'', '"'}) {
      const std::string key = fmt::format("{}{}{}:", quote, name, quote);
      const std::size_t at = text.find(key);
      if (at == std::string_view::npos) continue;
      const std::string_view rest = text.substr(at + key.size());
      return rest.substr(0, rest.find_first_of(",}"));
    }
  }
  return {};
}

class EdgeListReader {
 public:
  EdgeListReader(std::string_view text, const std::string& source, const MapOptions& options)
      : lines_(text), source_(source), builder_(options, [this] { return place(); }) {
    if (options.cost_attribute.empty()) return;
    cost_names_ = {options.cost_attribute};
    cost_name_ = options.cost_attribute;
    cost_ = kNoColumn;
  }

  GraphMap read() {
    bool first = true;
    while (lines_.next()) {
      if (is_comment(lines_.line())) continue;
      if (first) separator_ = separator_of(lines_.line());
      const std::vector<std::string> fields = split_fields(lines_.line(), separator_);
      if (!first || !read_header(fields)) read_edge(fields);
      first = false;
    }
    if (!any_) throw Error({.what = "no edges", .where = source_});
    return builder_.build();
  }

 private:
  std::string place() const { return fmt::format("{}:{}", source_, lines_.number()); }

  // Whether these are the names of columns.
  bool read_header(const std::vector<std::string>& fields) {
    const int from = column_of(fields, kSourceNames);
    const int to = column_of(fields, kTargetNames);
    if (from == kNoColumn || to == kNoColumn) return false;
    from_ = from;
    to_ = to;
    cost_ = column_of(fields, cost_names_);
    return true;
  }

  void read_edge(const std::vector<std::string>& fields) {
    const auto count = static_cast<int>(fields.size());
    if (count <= std::max(from_, to_) || fields[from_].empty() || fields[to_].empty()) {
      throw Error({.what = "not an edge",
                   .expected = "two nodes, and a cost where there is one",
                   .got = in_quotes(lines_.line()),
                   .where = place()});
    }
    const NodeId from = builder_.node_or_new(fields[from_]);
    builder_.add_edge(from, builder_.node_or_new(fields[to_]), /*one_way=*/false);
    any_ = true;
    std::string_view cost = cost_ != kNoColumn && cost_ < count ? std::string_view(fields[cost_]) : std::string_view();
    if (fields.back().starts_with('{')) cost = value_in_dictionary(fields.back(), cost_names_);
    if (!cost.empty()) builder_.set_edge(cost_name_, cost);
  }

  Lines lines_;
  const std::string& source_;
  char separator_ = ' ';
  int from_ = 0;
  int to_ = 1;
  int cost_ = 2;
  std::string_view cost_name_ = "cost";
  std::vector<std::string_view> cost_names_ = {cost_names().begin(), cost_names().end()};
  bool any_ = false;  // edge
  GraphBuilder builder_;
};

}  // namespace

bool is_edge_list(std::string_view text) {
  Lines lines(text);
  while (lines.next()) {
    const std::string_view line = lines.line();
    if (is_comment(line)) continue;
    const bool printable =
        std::none_of(line.begin(), line.end(), [](char c) { return c >= 0 && c < ' ' && c != '\t'; });
    return printable && split_fields(line, separator_of(line)).size() >= 2;
  }
  return false;
}

GraphMap parse_edge_list(std::string_view text, const std::string& source, const MapOptions& options) {
  return EdgeListReader(text, source, options).read();
}

}  // namespace graphdrl
