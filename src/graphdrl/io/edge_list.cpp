#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <iterator>
#include <set>

#include "graphdrl/base/error.h"
#include "graphdrl/io/graph_builder.h"
#include "graphdrl/io/readers.h"
#include "graphdrl/io/text.h"

namespace graphdrl {
namespace {

using namespace std::string_view_literals;
using Fields = std::vector<std::string>;

// Columns of nodes. The usual names tell a header; the others are a guess.
constexpr std::array kSources = {"source"sv, "from"sv, "src"sv, "u"sv, "start"sv, "origin"sv, "tail"sv, "begin"sv};
constexpr std::array kTargets = {"target"sv, "to"sv, "dst"sv, "v"sv, "end"sv, "destination"sv, "head"sv, "dest"sv};
constexpr std::size_t kUsualNames = 4;
// Values of the column `type`, as Gephi writes them, and of the column `directed`.
constexpr std::array kOneWay = {"directed"sv, "true"sv, "yes"sv, "1"sv};
constexpr std::array kBothWays = {"undirected"sv, "false"sv, "no"sv, "0"sv};

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

// Excel's first line, "sep=;", names what parts the fields; 0 where this is no such line.
char separator_named_by(std::string_view line) {
  line = trimmed(line);
  if (line.starts_with('"') && line.ends_with('"') && line.size() > 1) line = line.substr(1, line.size() - 2);
  return line.size() == 5 && same_name(line.substr(0, 4), "sep=") ? line[4] : '\0';
}

// Whether a comment says that edges lead one way, as those of SNAP ("# Directed graph …") and KONECT ("% asym …") do.
bool says_directed(std::string_view comment) {
  comment = trimmed(comment);
  if (comment.empty()) return false;
  const std::string_view text = trimmed(comment.substr(std::min(comment.find_first_not_of("#%"), comment.size())));
  const std::string_view first = text.substr(0, text.find_first_of(" \t:=,."));
  if (comment.front() == '%' && same_name(first, "asym")) return true;
  const std::string_view last = text.substr(text.find_last_of(" \t:=") + 1);
  return same_name(first, "directed") && !is_name_of(last, kBothWays);
}

// A number with a point, as coordinates are.
bool is_decimal(const std::string& field) {
  return field.find('.') != std::string::npos && parse_number(field);
}

// Names of columns that differ in the number at their ends alone, as id_1 and id_2.
bool differ_in_number(std::string_view one, std::string_view other) {
  const auto stem = [](std::string_view name) { return name.substr(0, name.find_last_not_of("0123456789") + 1); };
  return one != other && stem(one).size() < one.size() && stem(other).size() < other.size() && !stem(one).empty() &&
         same_name(stem(one), stem(other));
}

// Whether these are columns of a table of nodes, as Gephi and `plan --out` write it.
bool names_nodes(const Fields& names) {
  return column_of(names, std::array{"id"sv, "node"sv, "nodes"sv}) != kNoColumn &&
         column_of(names, std::array{"label"sv, "name"sv, "step"sv, "x"sv, "lon"sv, "prize"sv, "score"sv}) != kNoColumn;
}

bool names_coordinates(const Fields& names) {
  return column_of(names, std::array{"x"sv, "lon"sv, "longitude"sv}) != kNoColumn &&
         column_of(names, std::array{"y"sv, "lat"sv, "latitude"sv}) != kNoColumn;
}

// Without spaces, signs and the words at the end that tell nothing: "From Node-ID" is "From".
std::string bare_name(const std::string& name) {
  std::string bare;
  std::copy_if(name.begin(), name.end(), std::back_inserter(bare), [](char c) { return std::isalnum(c & 0x7f) != 0; });
  for (const std::string_view word : {"id", "node", "vertex", "name"}) {
    const std::size_t at = bare.size() - std::min(bare.size(), word.size());
    if (at > 0 && same_name(std::string_view(bare).substr(at), word)) bare.resize(at);
  }
  return bare;
}

class EdgeListReader {
 public:
  EdgeListReader(std::string_view text, const std::string& source, const MapOptions& options)
      : lines_(text, source), source_(source), options_(options), builder_(options, [this] { return lines_.place(); }) {
    if (options.cost_attribute.empty()) return;
    cost_names_ = {options.cost_attribute};
    cost_name_ = options.cost_attribute;
    cost_ = kNoColumn;
  }

  GraphMap read() {
    bool first = true;
    while (lines_.next()) {
      const std::string_view line = lines_.line();
      if (is_comment(line)) {
        directed_ = directed_ || (first && says_directed(line));
        continue;
      }
      if (first && separator_ == '\0') {
        separator_ = separator_named_by(line);
        if (separator_ != '\0') continue;
        separator_ = separator_of(line);
      }
      const Fields fields = split_fields(line, separator_);
      if (!first || !read_header(fields)) read_edge(fields);
      first = false;
    }
    if (one_way_ + both_ways_ == 0) throw Error({.what = "no edges", .where = source_});
    if (!named_ && 2 * decimals_ > one_way_ + both_ways_) refuse_table("coordinates");
    if (options_.note) options_.note(description());
    return builder_.build();
  }

 private:
  [[noreturn]] void refuse_table(const std::string& of) const {
    throw Error({.what = fmt::format("this looks like a table of {}, not of edges", of),
                 .expected = "two nodes a line; names of columns, source and target, above them if they are",
                 .where = source_});
  }

  // Whether these are the names of columns.
  bool read_header(const Fields& fields) {
    columns_ = fields.size();
    from_ = column_of(fields, std::span(kSources).first(kUsualNames));
    to_ = column_of(fields, std::span(kTargets).first(kUsualNames));
    named_ = from_ != kNoColumn && to_ != kNoColumn;
    if (!named_) {
      if (names_nodes(fields)) refuse_table("nodes");
      guess_columns(fields);
      if (!may_be_header(fields)) {
        from_ = 0;
        to_ = 1;
        return false;
      }
      if (names_coordinates(fields)) refuse_table("coordinates");
    }
    header_ = true;
    cost_ = column_of(fields, cost_names_);
    if (cost_ != kNoColumn) cost_name_in_file_ = fields[cost_];
    for (int column = 0; cost_ == kNoColumn && column < std::ssize(fields); ++column) {
      if (column == from_ || column == to_) continue;
      skipped_ += fmt::format("{}{}", skipped_.empty() ? "" : ", ", escaped(fields[column]));
    }
    direction_ = column_of(fields, std::array{"type"sv, "directed"sv});
    direction_words_ = direction_ != kNoColumn && same_name(fields[direction_], "type") ? 1 : kOneWay.size();
    return true;
  }

  // A row of names, none of which is a node below: where all below are numbers, where the names are numbered, or where
  // nodes below occur again.
  bool may_be_header(const Fields& names) const {
    if (names.size() < 2 || names.back().starts_with('{') || names[from_].empty() || names[to_].empty()) return false;
    if (std::any_of(names.begin(), names.end(), [](const std::string& name) { return parse_number(name); }))
      return false;
    bool rows = false;
    bool numbers = true;
    bool again = differ_in_number(names[from_], names[to_]);
    std::set<std::string> met;
    for (Lines below = lines_; below.next();) {
      if (is_comment(below.line())) continue;
      const Fields fields = split_fields(below.line(), separator_);
      if (std::ssize(fields) <= std::max(from_, to_)) return false;
      for (const std::string& node : {fields[from_], fields[to_]}) {
        if (node == names[from_] || node == names[to_]) return false;
        numbers = numbers && parse_number(node);
        again = again || !met.insert(node).second;
      }
      rows = true;
    }
    return rows && (numbers || again);
  }

  // By names like the usual ones, or numbered; else the first two.
  void guess_columns(const Fields& names) {
    Fields bare;
    std::ranges::transform(names, std::back_inserter(bare), bare_name);
    from_ = column_of(bare, kSources);
    to_ = column_of(bare, kTargets);
    if (from_ != kNoColumn && to_ != kNoColumn && from_ != to_) return;
    from_ = 0;
    for (std::size_t i = 0; i + 1 < names.size(); ++i) {
      if (!differ_in_number(names[i], names[i + 1])) continue;
      from_ = static_cast<int>(i);
      break;
    }
    to_ = from_ + 1;
  }

  void read_edge(const Fields& fields) {
    const auto count = static_cast<int>(fields.size());
    if (count <= std::max(from_, to_) || fields[from_].empty() || fields[to_].empty()) {
      lines_.fail("not an edge", "two nodes, and a cost where there is one");
    }
    const bool dictionary = fields.back().starts_with('{');
    check_count(fields, dictionary);
    const NodeId from = builder_.node_or_new(fields[from_]);
    const NodeId to = builder_.node_or_new(fields[to_]);
    const bool one_way = leads_one_way(fields);
    builder_.add_edge(from, to, one_way);
    ++(one_way ? one_way_ : both_ways_);
    if (is_decimal(fields[from_]) && is_decimal(fields[to_])) ++decimals_;
    std::string cost = cost_ != kNoColumn && cost_ < count ? fields[cost_] : std::string();
    if (dictionary) cost = value_in_dictionary(fields.back(), cost_names_);
    if (cost.empty()) return;
    if (!dictionary && separator_ != ',' && std::count(cost.begin(), cost.end(), ',') == 1) {
      std::replace(cost.begin(), cost.end(), ',', '.');
      decimal_commas_ = true;
    }
    costs_ = true;
    builder_.set_edge(cost_name_, cost);
  }

  // Rows have no more fields than the header; without one, two or three, or as many as the first one.
  void check_count(const Fields& fields, bool dictionary) const {
    std::size_t count = fields.size();
    while (count > 0 && fields[count - 1].empty()) --count;
    if (header_ ? count > columns_ : !dictionary && count > 3 && count != columns_) {
      lines_.fail("not an edge", fmt::format("{} fields, as in the first line", columns_));
    }
  }

  bool leads_one_way(const Fields& fields) const {
    if (options_.directed) return true;
    if (direction_ != kNoColumn && direction_ < std::ssize(fields)) {
      if (is_name_of(fields[direction_], std::span(kOneWay).first(direction_words_))) return true;
      if (is_name_of(fields[direction_], std::span(kBothWays).first(direction_words_))) return false;
    }
    return directed_;
  }

  // What was guessed.
  std::string description() const {
    const std::string between = separator_ == ' '    ? "spaces"
                                : separator_ == '\t' ? "tabs"
                                                     : in_quotes({&separator_, 1});
    std::string cost = header_ ? fmt::format("column {} is the cost", in_quotes(cost_name_in_file_))
                               : std::string("the third field is the cost");
    if (!costs_) cost = "every cost 1";
    if (!skipped_.empty()) cost += fmt::format(" (columns besides: {})", skipped_);
    const std::string direction = one_way_ == 0     ? "edges lead both ways (--directed: one way)"
                                  : both_ways_ == 0 ? "edges lead one way"
                                                    : "edges lead one way or both, as they say";
    return fmt::format("{}: taken for an edge list: fields between {}, {}, {}{}, {}", source_, between,
                       header_ ? "the first line a header" : "no header", cost,
                       decimal_commas_ ? " with decimal commas" : "", direction);
  }

  Lines lines_;
  const std::string& source_;
  const MapOptions& options_;
  char separator_ = '\0';  // not known yet
  bool header_ = false;
  bool named_ = false;       // source and target by their usual names
  std::size_t columns_ = 0;  // of the first line
  int from_ = 0;
  int to_ = 1;
  int cost_ = 2;
  int direction_ = kNoColumn;
  std::size_t direction_words_ = 0;      // how many of kOneWay and kBothWays it may have
  std::string_view cost_name_ = "cost";  // for the builder
  std::string cost_name_in_file_;
  std::string skipped_;  // names of columns where none is the cost
  std::vector<std::string_view> cost_names_ = {kCostNames.begin(), kCostNames.end()};
  bool directed_ = false;  // a comment says so
  bool decimal_commas_ = false;
  bool costs_ = false;
  std::int64_t one_way_ = 0;
  std::int64_t both_ways_ = 0;
  std::int64_t decimals_ = 0;  // edges between numbers with a point
  GraphBuilder builder_;
};

}  // namespace

bool is_edge_list(std::string_view text) {
  char separator = '\0';
  for (Lines lines(text); lines.next();) {
    const std::string_view line = lines.line();
    if (is_comment(line)) continue;
    if (separator == '\0' && (separator = separator_named_by(line)) != '\0') continue;
    const bool printable =
        std::none_of(line.begin(), line.end(), [](char c) { return c >= 0 && c < ' ' && c != '\t'; });
    return printable && split_fields(line, separator != '\0' ? separator : separator_of(line)).size() >= 2;
  }
  return false;
}

GraphMap parse_edge_list(std::string_view text, const std::string& source, const MapOptions& options) {
  return EdgeListReader(text, source, options).read();
}

}  // namespace graphdrl
