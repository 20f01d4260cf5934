#include "graphdrl/io/dot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <utility>

#include "graphdrl/base/error.h"
#include "graphdrl/io/graph_builder.h"
#include "graphdrl/io/text.h"

namespace graphdrl {
namespace {

constexpr int kMostGraphsDeep = 100;            // graphs in each other
constexpr std::int64_t kMostEdgesPerByte = 50;  // { a b } -> { c d } stands for four edges

bool is_letter(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c < 0;  // bytes of UTF-8 too
}

// The words and signs of a text in DOT [graphviz.org/doc/info/lang.html].
class DotTokens {
 public:
  enum class Kind { kId, kSign, kEnd };

  DotTokens(std::string_view text, const std::string& source) : text_(text), source_(source) { next(); }

  Kind kind() const { return kind_; }
  const std::string& word() const { return word_; }  // of an id without its quotes; a sign
  bool is(std::string_view sign) const { return kind_ == Kind::kSign && word_ == sign; }
  // Keywords stand without quotes, in any case.
  bool is_keyword(std::string_view keyword) const {
    return kind_ == Kind::kId && !quoted_ && same_name(word_, keyword);
  }
  bool is_edge() const { return is("->") || is("--"); }

  void next() {
    skip_space();
    begin_ = at_;
    quoted_ = false;
    word_.clear();
    if (at_ == text_.size()) {
      kind_ = Kind::kEnd;
    } else if (text_[at_] == '"') {
      read_quoted();
    } else if (text_[at_] == '<') {
      read_html();
    } else if (is_letter(text_[at_]) || starts_number()) {
      kind_ = Kind::kId;
      while (at_ < text_.size() && (is_letter(text_[at_]) || text_[at_] == '.' || at_ == begin_)) word_ += text_[at_++];
    } else {
      kind_ = Kind::kSign;
      const bool edge = text_.substr(at_).starts_with("->") || text_.substr(at_).starts_with("--");
      word_ += text_[at_++];
      if (edge) word_ += text_[at_++];
    }
  }

  std::string place() const {
    const auto end = text_.begin() + static_cast<std::ptrdiff_t>(begin_);
    return fmt::format("{}:{}", source_, 1 + std::count(text_.begin(), end, '\n'));
  }
  [[noreturn]] void fail(const std::string& what, const std::string& expected) const {
    const std::string got = kind_ == Kind::kEnd ? "the end of the file" : in_quotes(word_);
    throw Error({.what = what, .expected = expected, .got = got, .where = place()});
  }

 private:
  bool starts_number() const {
    const std::string_view rest = text_.substr(at_ + (text_[at_] == '-' ? 1 : 0), 2);
    const auto digit = [&](std::size_t i) { return i < rest.size() && rest[i] >= '0' && rest[i] <= '9'; };
    return digit(0) || (rest.starts_with('.') && digit(1));
  }

  void skip_space() {
    for (;;) {
      at_ = std::min(text_.find_first_not_of(" \t\r\n\f\v", at_), text_.size());
      const std::string_view rest = text_.substr(at_);
      const bool line_begins = at_ == 0 || text_[at_ - 1] == '\n';
      const bool block = rest.starts_with("/*");
      if (!block && !rest.starts_with("//") && !(line_begins && rest.starts_with('#'))) return;
      const std::size_t end = text_.find(block ? "*/" : "\n", at_ + (block ? 2 : 0));
      at_ = end == std::string_view::npos ? text_.size() : end + (block ? 2 : 1);
    }
  }

  // "a" + "b" is one text.
  void read_quoted() {
    kind_ = Kind::kId;
    quoted_ = true;
    for (;;) {
      for (++at_;; ++at_) {
        if (at_ >= text_.size()) fail("a text that does not end", "'\"'");
        if (text_[at_] == '"') break;
        const char after = at_ + 1 < text_.size() ? text_[at_ + 1] : '\0';
        const bool escape = text_[at_] == '\\' && (after == '"' || after == '\\' || after == '\n');
        if (escape) ++at_;
        if (!escape || after != '\n') word_ += text_[at_];
      }
      const std::size_t end = ++at_;
      skip_space();
      if (at_ < text_.size() && text_[at_] == '+') {
        ++at_;
        skip_space();
        if (at_ < text_.size() && text_[at_] == '"') continue;
      }
      at_ = end;
      return;
    }
  }

  void read_html() {
    kind_ = Kind::kId;
    quoted_ = true;
    int depth = 0;
    do {
      if (at_ == text_.size()) fail("a text that does not end", "'>'");
      if (text_[at_] == '<') ++depth;
      if (text_[at_] == '>') --depth;
      word_ += text_[at_++];
    } while (depth > 0);
    word_.erase(0, 1);
    word_.pop_back();
  }

  std::string_view text_;
  const std::string& source_;
  std::size_t at_ = 0;
  std::size_t begin_ = 0;  // of the token at hand
  Kind kind_ = Kind::kEnd;
  std::string word_;
  bool quoted_ = false;
};

class DotReader {
 public:
  DotReader(std::string_view text, const std::string& source, const MapOptions& options)
      : tokens_(text, source),
        most_edges_(kMostEdgesPerByte * std::ssize(text)),
        builder_(options, [this] { return tokens_.place(); }) {}

  GraphMap read() {
    if (tokens_.is_keyword("strict")) tokens_.next();
    directed_ = tokens_.is_keyword("digraph");
    if (!directed_ && !tokens_.is_keyword("graph")) tokens_.fail("not a graph in DOT", "graph or digraph");
    tokens_.next();
    if (tokens_.kind() == DotTokens::Kind::kId) tokens_.next();
    Scope scope;
    read_body(scope);
    if (tokens_.kind() != DotTokens::Kind::kEnd) tokens_.fail("more than one graph", "the end of the file");
    GraphMap map = builder_.build();
    if (!map.places.points.empty()) map.places.unit = unit_;
    return map;
  }

 private:
  struct Attribute {
    std::string name;
    std::string value;
  };
  using Attributes = std::vector<Attribute>;
  // What a graph within the graph takes from those around it, and the nodes that it names.
  struct Scope {
    Attributes of_nodes;
    Attributes of_edges;
    std::vector<NodeId> nodes;
  };

  void expect(std::string_view sign, const std::string& what) {
    if (!tokens_.is(sign)) tokens_.fail(what, fmt::format("'{}'", sign));
    tokens_.next();
  }

  std::string take_id(const std::string& what) {
    if (tokens_.kind() != DotTokens::Kind::kId) tokens_.fail(what, "a name, a number or a text in quotes");
    std::string word = tokens_.word();
    tokens_.next();
    return word;
  }

  void read_body(Scope& scope) {
    expect("{", "no graph");
    if (++depth_ > kMostGraphsDeep)
      tokens_.fail("graphs within graphs, too deep", fmt::format("at most {}", kMostGraphsDeep));
    while (!tokens_.is("}")) {
      read_statement(scope);
      if (tokens_.is(";") || tokens_.is(",")) tokens_.next();
    }
    --depth_;
    tokens_.next();
  }

  void read_statement(Scope& scope) {
    if (tokens_.is_keyword("graph") || tokens_.is_keyword("node") || tokens_.is_keyword("edge")) {
      const bool nodes = tokens_.is_keyword("node");
      const bool edges = tokens_.is_keyword("edge");
      tokens_.next();
      Attributes of_graph;
      read_attributes(nodes ? scope.of_nodes : edges ? scope.of_edges : of_graph);
      for (const Attribute& attribute : of_graph) set_graph(attribute);
      return;
    }
    const bool graph = tokens_.is("{") || tokens_.is_keyword("subgraph");
    std::vector<NodeId> from;
    bool fresh = false;
    if (graph) {
      from = read_subgraph(scope);
    } else {
      const std::string name = take_id("not a node, an edge or an attribute");
      if (tokens_.is("=")) {
        tokens_.next();
        set_graph({name, take_id("an attribute without a value")});
        return;
      }
      from = {node_of(name, scope)};
      fresh = true;
    }
    if (!tokens_.is_edge()) {
      Attributes attributes;
      if (fresh) read_attributes(attributes);
      for (const Attribute& attribute : attributes) set_node(from.front(), attribute);
      return;
    }
    read_edges(std::move(from), scope);
  }

  void read_edges(std::vector<NodeId> from, Scope& scope) {
    std::vector<std::pair<NodeId, NodeId>> edges;
    while (tokens_.is_edge()) {
      if (tokens_.is("->") != directed_) {
        tokens_.fail("the wrong sign of an edge", directed_ ? "'->' in a digraph" : "'--' in a graph");
      }
      tokens_.next();
      const bool graph = tokens_.is("{") || tokens_.is_keyword("subgraph");
      std::vector<NodeId> to;
      if (graph) {
        to = read_subgraph(scope);
      } else {
        to = {node_of(take_id("an edge to nowhere"), scope)};
      }
      edges_ += std::ssize(from) * std::ssize(to);
      if (edges_ > most_edges_) tokens_.fail("far more edges than a file of this size holds", "fewer");
      for (const NodeId one : from) {
        for (const NodeId other : to) edges.emplace_back(one, other);
      }
      from = std::move(to);
    }
    Attributes attributes = scope.of_edges;
    read_attributes(attributes);
    for (const auto& [one, other] : edges) {
      builder_.add_edge(one, other, directed_);
      for (const Attribute& attribute : attributes) builder_.set_edge(attribute.name, attribute.value);
    }
  }

  // The nodes that it names, each once.
  std::vector<NodeId> read_subgraph(Scope& scope) {
    if (tokens_.is_keyword("subgraph")) {
      tokens_.next();
      if (tokens_.kind() == DotTokens::Kind::kId) tokens_.next();
    }
    Scope inner{.of_nodes = scope.of_nodes, .of_edges = scope.of_edges, .nodes = {}};
    read_body(inner);
    std::sort(inner.nodes.begin(), inner.nodes.end());
    inner.nodes.erase(std::unique(inner.nodes.begin(), inner.nodes.end()), inner.nodes.end());
    scope.nodes.insert(scope.nodes.end(), inner.nodes.begin(), inner.nodes.end());
    return std::move(inner.nodes);
  }

  // The node of this name, and its port skipped.
  NodeId node_of(const std::string& name, Scope& scope) {
    const NodeId before = builder_.node_count();
    const NodeId node = builder_.node_or_new(name);
    if (node == before) {
      for (const Attribute& attribute : scope.of_nodes) set_node(node, attribute);
    }
    scope.nodes.push_back(node);
    for (int i = 0; i < 2 && tokens_.is(":"); ++i) {
      tokens_.next();
      take_id("a port without a name");
    }
    return node;
  }

  void read_attributes(Attributes& attributes) {
    while (tokens_.is("[")) {
      tokens_.next();
      while (!tokens_.is("]")) {
        Attribute attribute{.name = take_id("not an attribute"), .value = "true"};
        if (tokens_.is("=")) {
          tokens_.next();
          attribute.value = take_id("an attribute without a value");
        }
        attributes.push_back(std::move(attribute));
        if (tokens_.is(",") || tokens_.is(";")) tokens_.next();
      }
      tokens_.next();
    }
  }

  void set_graph(const Attribute& attribute) {
    if (attribute.name == "unit" && depth_ == 1) unit_ = attribute.value;
  }

  void set_node(NodeId node, const Attribute& attribute) {
    if (attribute.name != "pos") {
      if (attribute.value != "\\N") builder_.set_node(node, attribute.name, attribute.value);  // \N: the node's name
      return;
    }
    const std::string_view place = attribute.value;  // "x,y", and what may follow
    const std::size_t comma = place.find(',');
    if (comma == std::string_view::npos) return;
    const std::string_view y = place.substr(comma + 1);
    builder_.set_node(node, "x", place.substr(0, comma));
    builder_.set_node(node, "y", y.substr(0, y.find_first_of(",!")));
  }

  DotTokens tokens_;
  std::int64_t most_edges_;
  std::int64_t edges_ = 0;
  bool directed_ = false;
  int depth_ = 0;
  std::string unit_;
  GraphBuilder builder_;
};

}  // namespace

bool is_dot(std::string_view text) {
  constexpr std::size_t kLooked = 4096;
  const std::string nowhere;
  try {
    DotTokens tokens(text.substr(0, kLooked), nowhere);
    if (tokens.is_keyword("strict")) tokens.next();
    if (!tokens.is_keyword("graph") && !tokens.is_keyword("digraph")) return false;
    tokens.next();
    if (tokens.kind() == DotTokens::Kind::kId) tokens.next();
    return tokens.is("{");
  } catch (const Error&) {
    return false;
  }
}

GraphMap parse_dot(std::string_view text, const std::string& source, const MapOptions& options) {
  return DotReader(text, source, options).read();
}

std::string dot_quoted(std::string_view text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += c;
  }
  return quoted + '"';
}

std::string format_dot(const GraphMap& map) {
  return format_dot(map, {});
}

std::string format_dot(const GraphMap& map, const NodeColumn& column) {
  const bool directed = map.graph.directed();
  std::string text = directed ? "digraph {\n" : "graph {\n";
  if (!map.places.unit.empty()) text += fmt::format("  graph [unit={}];\n", dot_quoted(map.places.unit));
  for (NodeId node = 0; node < map.graph.node_count(); ++node) {
    std::string attributes;
    const auto add = [&](std::string_view name, const std::string& value) {
      attributes += fmt::format("{}{}={}", attributes.empty() ? "" : ", ", name, value);
    };
    if (!map.labels.empty()) add("label", dot_quoted(map.labels[node]));
    if (map.blocked[node]) add("blocked", "true");
    if (!map.prizes.empty()) add("prize", fmt::format("\"{}\"", map.prizes[node]));
    if (!map.places.points.empty()) {
      add("pos", fmt::format("\"{},{}\"", map.places.points[node].x, map.places.points[node].y));
    }
    if (!column.name.empty() && !column.values[node].empty()) add(column.name, dot_quoted(column.values[node]));
    text += attributes.empty() ? fmt::format("  {};\n", node) : fmt::format("  {} [{}];\n", node, attributes);
  }
  for (const Edge& edge : map.graph.edges()) {
    text += fmt::format("  {} {} {}", edge.a, directed ? "->" : "--", edge.b);
    text += map.graph.weighted() ? fmt::format(" [weight=\"{}\"];\n", edge.cost) : ";\n";
  }
  return text + "}\n";
}

}  // namespace graphdrl
