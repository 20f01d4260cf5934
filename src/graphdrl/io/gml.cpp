#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <optional>
#include <utility>

#include "graphdrl/base/error.h"
#include "graphdrl/io/graph_builder.h"
#include "graphdrl/io/readers.h"
#include "graphdrl/io/text.h"
#include "graphdrl/io/utf8.h"

namespace graphdrl {
namespace {

constexpr int kMostListsDeep = 100;  // lists in each other
constexpr std::string_view kBlanks = " \t\r\n";

class GmlReader {
 public:
  GmlReader(std::string_view text, const std::string& source, const MapOptions& options)
      : text_(text), source_(source), builder_(options, [this] { return place(); }) {}

  GraphMap read() {
    while (const auto key = next_key()) {
      if (!same_name(*key, "graph")) {
        skip_value();
      } else if (std::exchange(graph_read_, true)) {
        fail("a second graph", "one graph");
      } else {
        read_graph();
      }
    }
    if (!graph_read_) fail("no graph", "graph [ … ]");
    for (const LooseEdge& edge : edges_) {
      at_ = edge.at;
      builder_.add_edge(builder_.node(edge.source), builder_.node(edge.target), directed_);
      builder_.set_edge(edge.attributes);
    }
    return builder_.build();
  }

 private:
  // Edges may stand before their nodes.
  struct LooseEdge {
    std::size_t at;  // in the text
    std::string source;
    std::string target;
    std::vector<Attribute> attributes;
  };

  std::string place() const { return place_in(text_, at_, source_); }
  [[noreturn]] void fail(const std::string& what, const std::string& expected, std::string_view got = {}) const {
    throw Error({.what = what, .expected = expected, .got = got.empty() ? "" : in_quotes(got), .where = place()});
  }

  // Lines whose first character is '#' are comments.
  void skip_space() {
    for (;;) {
      at_ = std::min(text_.find_first_not_of(kBlanks, at_), text_.size());
      if (!text_.substr(at_).starts_with('#')) return;
      at_ = std::min(text_.find('\n', at_), text_.size());
    }
  }

  std::string_view word() {
    const std::size_t begin = at_;
    at_ = std::min(text_.find_first_of(" \t\r\n[]\"", at_), text_.size());
    return text_.substr(begin, at_ - begin);
  }

  // Empty at the end of the list, or of the text outside of lists.
  std::optional<std::string_view> next_key() {
    skip_space();
    if (at_ == text_.size()) {
      if (depth_ > 0) fail("the file ends within a list", "']'");
      return std::nullopt;
    }
    if (text_[at_] == ']' && depth_ > 0) {
      ++at_;
      --depth_;
      return std::nullopt;
    }
    const bool letter = std::isalpha(static_cast<unsigned char>(text_[at_])) != 0 || text_[at_] == '_';
    if (!letter) fail("not a key", "a name", text_.substr(at_, 20));
    return word();
  }

  bool at_list() {
    skip_space();
    return at_ < text_.size() && text_[at_] == '[';
  }

  void enter_list(std::string_view key) {
    if (!at_list()) fail(fmt::format("no list after `{}`", escaped(key)), "'['", text_.substr(at_, 20));
    if (++depth_ > kMostListsDeep) fail("lists in lists, too deep", fmt::format("at most {}", kMostListsDeep));
    ++at_;
  }

  std::string value() {
    skip_space();
    if (at_ == text_.size()) fail("the file ends after a key", "a value");
    if (text_[at_] != '"') {
      const std::string_view found = word();
      if (found.empty()) fail("not a value", "a number or a text", text_.substr(at_, 20));
      return std::string(found);
    }
    const std::size_t end = text_.find('"', at_ + 1);
    if (end == std::string_view::npos) fail("a text that does not end", "'\"'", text_.substr(at_, 20));
    const std::string_view found = text_.substr(at_ + 1, end - at_ - 1);
    at_ = end + 1;
    return without_entities(found);
  }

  void skip_value() {
    if (!at_list()) {
      value();
      return;
    }
    enter_list("");
    while (next_key()) skip_value();
  }

  void read_graph() {
    enter_list("graph");
    while (const auto key = next_key()) {
      if (same_name(*key, "node")) {
        read_node();
      } else if (same_name(*key, "edge")) {
        read_edge();
      } else if (same_name(*key, "directed")) {
        directed_ = value() == "1";
      } else if (same_name(*key, "unit") && !at_list()) {
        builder_.set_unit(value());
      } else {
        skip_value();
      }
    }
  }

  // The attributes of a node or an edge, those of the list `graphics` among them.
  void read_attributes(std::string_view list, bool of_node, std::vector<Attribute>& attributes) {
    enter_list(list);
    while (const auto key = next_key()) {
      if (!at_list()) {
        attributes.push_back({std::string(*key), value()});
      } else if (of_node && same_name(*key, "graphics")) {
        read_attributes(*key, of_node, attributes);
      } else {
        skip_value();
      }
    }
  }

  // Takes an attribute out. Throws Error where there is none.
  std::string take(std::vector<Attribute>& attributes, std::string_view name, std::string_view kind) {
    const auto found = std::find_if(attributes.begin(), attributes.end(),
                                    [&](const Attribute& one) { return same_name(one.name, name); });
    if (found == attributes.end())
      fail(fmt::format("a{} {} without `{}`", kind == "edge" ? "n" : "", kind, name), "one");
    std::string value = std::move(found->value);
    attributes.erase(found);
    return value;
  }

  void read_node() {
    std::vector<Attribute> attributes;
    read_attributes("node", /*of_node=*/true, attributes);
    const NodeId node = builder_.add_node(take(attributes, "id", "node"));
    builder_.set_node(node, attributes);
  }

  void read_edge() {
    std::vector<Attribute> attributes;
    read_attributes("edge", /*of_node=*/false, attributes);
    std::string from = take(attributes, "source", "edge");
    std::string to = take(attributes, "target", "edge");
    edges_.push_back({at_, std::move(from), std::move(to), std::move(attributes)});
  }

  std::string_view text_;
  const std::string& source_;
  std::size_t at_ = 0;
  int depth_ = 0;
  bool graph_read_ = false;
  bool directed_ = false;
  std::vector<LooseEdge> edges_;
  GraphBuilder builder_;
};

std::string escaped_for_gml(std::string_view text) {
  std::string result;
  for (std::size_t at = 0; at < text.size();) {
    const Utf8Character character = utf8_at(text, at);
    at += character.bytes;
    const bool plain = character.code >= ' ' && character.code < 127 && character.code != '"' && character.code != '&';
    if (plain) {
      result += static_cast<char>(character.code);
    } else {
      result += fmt::format("&#{};", character.code);
    }
  }
  return result;
}

}  // namespace

bool is_gml(std::string_view text) {
  constexpr std::size_t kLooked = 4096;
  std::string_view rest = text.substr(0, kLooked);
  Lines lines(rest);
  while (lines.next()) {
    const std::string_view line = trimmed(lines.line());
    if (line.empty() || line.front() == '#') continue;
    if (std::isalpha(static_cast<unsigned char>(line.front())) == 0) return false;
    break;
  }
  for (std::size_t at = rest.find("graph"); at != std::string_view::npos; at = rest.find("graph", at + 1)) {
    const bool word = at == 0 || kBlanks.find(rest[at - 1]) != std::string_view::npos;
    const std::size_t next = rest.find_first_not_of(kBlanks, at + 5);
    if (word && next != std::string_view::npos && rest[next] == '[') return true;
  }
  return false;
}

GraphMap parse_gml(std::string_view text, const std::string& source, const MapOptions& options) {
  return GmlReader(text, source, options).read();
}

std::string format_gml(const GraphMap& map) {
  std::string text = fmt::format("graph [\n  directed {:d}\n", map.graph.directed());
  if (!map.places.unit.empty()) text += fmt::format("  unit \"{}\"\n", escaped_for_gml(map.places.unit));
  for (NodeId node = 0; node < map.graph.node_count(); ++node) {
    text += fmt::format("  node [\n    id {}\n", node);
    if (!map.labels.empty()) text += fmt::format("    label \"{}\"\n", escaped_for_gml(map.labels[node]));
    if (map.blocked[node]) text += "    blocked 1\n";
    if (!map.prizes.empty()) text += fmt::format("    prize {}\n", map.prizes[node]);
    if (!map.places.points.empty()) {
      text += fmt::format("    x {}\n    y {}\n", map.places.points[node].x, map.places.points[node].y);
    }
    text += "  ]\n";
  }
  for (const Edge& edge : map.graph.edges()) {
    text += fmt::format("  edge [\n    source {}\n    target {}\n", edge.a, edge.b);
    if (map.graph.weighted()) text += fmt::format("    weight {}\n", edge.cost);
    text += "  ]\n";
  }
  return text + "]\n";
}

}  // namespace graphdrl
