#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <iterator>
#include <map>
#include <utility>

#include "graphdrl/base/error.h"
#include "graphdrl/io/graph_builder.h"
#include "graphdrl/io/readers.h"
#include "graphdrl/io/text.h"

namespace graphdrl {
namespace {

constexpr int kMostGraphsDeep = 100;  // graphs in each other

bool is_letter(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c < 0;  // bytes of UTF-8 too
}

// The words and signs of a text in DOT [graphviz.org/doc/info/lang.html].
class DotTokens {
 public:
  DotTokens(std::string_view text, const std::string& source) : text_(text), source_(source) { next(); }

  bool is_end() const { return kind_ == Kind::kEnd; }
  bool is_id() const { return kind_ == Kind::kId; }
  // Of an id without its quotes, two backslashes for one; a sign.
  const std::string& word() const { return word_; }
  bool is(std::string_view sign) const { return kind_ == Kind::kSign && word_ == sign; }
  // Keywords stand without quotes, in any case.
  bool is_keyword(std::string_view keyword) const {
    return kind_ == Kind::kId && !quoted_ && same_name(word_, keyword);
  }
  bool is_edge() const { return is("->") || is("--"); }

  // Whether it is this one; then goes on to the next.
  bool take(std::string_view sign) { return go_on_if(is(sign)); }
  bool take_keyword(std::string_view keyword) { return go_on_if(is_keyword(keyword)); }

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

  std::string place() const { return place_in(text_, begin_, source_); }
  [[noreturn]] void fail(const std::string& what, const std::string& expected) const {
    const std::string got = is_end() ? "the end of the file" : in_quotes(word_);
    throw Error({.what = what, .expected = expected, .got = got, .where = place()});
  }

 private:
  enum class Kind { kId, kSign, kEnd };

  bool go_on_if(bool found) {
    if (found) next();
    return found;
  }

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
        if (escape && after == '\\') word_ += '\\';
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
      if (text_[at_] == '\\') word_ += '\\';
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

// A text without its escapes; `\N` of a label is the node's name.
std::string unescaped(std::string_view text, std::string_view node_name = "\\N") {
  std::string result;
  for (std::size_t at = 0; at < text.size(); ++at) {
    const std::string_view two = text.substr(at, 2);
    if (two == "\\N") {
      result += node_name;
    } else {
      result += text[at];
    }
    if (two == "\\N" || two == "\\\\") ++at;
  }
  return result;
}

class DotReader {
 public:
  DotReader(std::string_view text, const std::string& source, const MapOptions& options)
      : tokens_(text, source),
        builder_(
            options, [this] { return tokens_.place(); }, std::ssize(text)) {}

  GraphMap read() {
    tokens_.take_keyword("strict");
    directed_ = tokens_.take_keyword("digraph");
    if (!directed_ && !tokens_.take_keyword("graph")) tokens_.fail("not a graph in DOT", "graph or digraph");
    if (tokens_.is_id()) tokens_.next();
    Scope scope;
    read_body(scope);
    if (!tokens_.is_end()) tokens_.fail("more than one graph", "the end of the file");
    if (directed_) take_start();
    return builder_.build();
  }

 private:
  using Attributes = std::vector<Attribute>;
  // A graph: its own defaults, the nodes that it names, and the graphs within it.
  struct Scope {
    const Scope* around = nullptr;
    Attributes of_nodes;
    Attributes of_edges;
    std::vector<NodeId> nodes;
    std::map<std::string, Scope> subgraphs;  // by name
  };

  // The defaults of a graph and of those around it, the outermost ones first.
  static Attributes defaults(const Scope& scope, Attributes Scope::*kind) {
    Attributes all = scope.around == nullptr ? Attributes() : defaults(*scope.around, kind);
    all.insert(all.end(), (scope.*kind).begin(), (scope.*kind).end());
    return all;
  }

  std::string take_id(const std::string& what) {
    if (!tokens_.is_id()) tokens_.fail(what, "a name, a number or a text in quotes");
    std::string word = unescaped(tokens_.word());
    tokens_.next();
    return word;
  }

  void read_body(Scope& scope) {
    if (!tokens_.take("{")) tokens_.fail("no graph", "'{'");
    if (++depth_ > kMostGraphsDeep)
      tokens_.fail("graphs within graphs, too deep", fmt::format("at most {}", kMostGraphsDeep));
    while (!tokens_.take("}")) {
      read_statement(scope);
      if (!tokens_.take(";")) tokens_.take(",");
    }
    --depth_;
  }

  void read_statement(Scope& scope) {
    if (tokens_.take_keyword("graph")) {
      for (const Attribute& attribute : read_attributes()) set_graph(attribute);
    } else if (tokens_.take_keyword("node")) {
      set_defaults(scope.of_nodes);
    } else if (tokens_.take_keyword("edge")) {
      set_defaults(scope.of_edges);
    } else if (at_subgraph()) {
      std::vector<NodeId> nodes = read_subgraph(scope);
      if (tokens_.is_edge()) return read_edges(std::move(nodes), scope);
      read_attributes();  // of the graph itself
    } else {
      const std::string name = take_id("not a node, an edge or an attribute");
      if (tokens_.take("=")) return set_graph({name, take_id("an attribute without a value")});
      std::vector<NodeId> nodes = read_nodes(name, scope);
      if (tokens_.is_edge()) return read_edges(std::move(nodes), scope);
      const Attributes attributes = read_attributes();
      for (const NodeId node : nodes) set_node(node, attributes);
    }
  }

  bool at_subgraph() const { return tokens_.is("{") || tokens_.is_keyword("subgraph"); }

  // One of the same name takes the place of the one before.
  void set_defaults(Attributes& own) {
    for (Attribute& attribute : read_attributes()) {
      builder_.spend(std::ssize(own));
      std::erase_if(own, [&](const Attribute& before) { return before.name == attribute.name; });
      own.push_back(std::move(attribute));
    }
  }

  void read_edges(std::vector<NodeId> from, Scope& scope) {
    std::vector<std::pair<NodeId, NodeId>> edges;
    while (tokens_.is_edge()) {
      if (tokens_.is("->") != directed_) {
        tokens_.fail("the wrong sign of an edge", directed_ ? "'->' in a digraph" : "'--' in a graph");
      }
      tokens_.next();
      std::vector<NodeId> to = at_subgraph() ? read_subgraph(scope) : read_nodes(take_id("an edge to nowhere"), scope);
      builder_.spend(std::ssize(from) * std::ssize(to));
      for (const NodeId one : from) {
        for (const NodeId other : to) edges.emplace_back(one, other);
      }
      from = std::move(to);
    }
    Attributes attributes = defaults(scope, &Scope::of_edges);
    std::ranges::move(read_attributes(), std::back_inserter(attributes));
    for (const auto& [one, other] : edges) {
      builder_.add_edge(one, other, directed_);
      builder_.set_edge(attributes);
      if (starts_.contains(other)) starts_.at(other).reached = true;
      if (starts_.contains(one)) starts_.at(one).targets.push_back(other);
    }
  }

  // The nodes that it names, each once. A graph named again is the one before, and goes on with its defaults.
  std::vector<NodeId> read_subgraph(Scope& scope) {
    std::string name;
    if (tokens_.take_keyword("subgraph") && tokens_.is_id()) name = take_id("");
    Scope unnamed;
    Scope& inner = name.empty() ? unnamed : scope.subgraphs[name];
    inner.around = &scope;
    read_body(inner);
    std::sort(inner.nodes.begin(), inner.nodes.end());
    inner.nodes.erase(std::unique(inner.nodes.begin(), inner.nodes.end()), inner.nodes.end());
    builder_.spend(std::ssize(inner.nodes));  // a graph may be named again and again
    scope.nodes.insert(scope.nodes.end(), inner.nodes.begin(), inner.nodes.end());
    return inner.nodes;
  }

  // A list of nodes: "a, b:port".
  std::vector<NodeId> read_nodes(const std::string& first, Scope& scope) {
    std::vector<NodeId> nodes = {node_of(first, scope)};
    while (tokens_.take(",")) nodes.push_back(node_of(take_id("not a node after a comma"), scope));
    return nodes;
  }

  // The node of this name, and its port skipped.
  NodeId node_of(const std::string& name, Scope& scope) {
    const NodeId before = builder_.node_count();
    const NodeId node = builder_.node_or_new(name);
    if (node == before) {
      if (name.starts_with("__start")) starts_[node] = {};
      set_node(node, defaults(scope, &Scope::of_nodes));
    }
    scope.nodes.push_back(node);
    for (int i = 0; i < 2 && tokens_.take(":"); ++i) take_id("a port without a name");
    return node;
  }

  Attributes read_attributes() {
    Attributes attributes;
    while (tokens_.take("[")) {
      while (!tokens_.take("]")) {
        Attribute attribute{.name = take_id("not an attribute"), .value = "true"};
        if (tokens_.take("=")) {
          attribute.value = tokens_.word();  // with its escapes
          take_id("an attribute without a value");
        }
        attributes.push_back(std::move(attribute));
        if (!tokens_.take(",")) tokens_.take(";");
      }
    }
    return attributes;
  }

  void set_graph(const Attribute& attribute) {
    if (attribute.name == "unit" && depth_ == 1) builder_.set_unit(attribute.value);
  }

  void set_node(NodeId node, const Attributes& attributes) {
    Attributes plain;
    for (const auto& [name, value] : attributes) {
      const std::size_t comma = value.find(',');
      if (name != "pos") {
        if (value == "\\N") continue;  // the node's name, which it has already
        plain.push_back({name, unescaped(value, builder_.id(node))});
        const auto start = starts_.find(node);
        if (start != starts_.end() && name == "label") start->second.labelled = !value.empty();
      } else if (comma != std::string::npos) {  // "x,y", and what may follow
        const std::string y = value.substr(comma + 1);
        plain.push_back({"x", value.substr(0, comma)});
        plain.push_back({"y", y.substr(0, y.find_first_of(",!"))});
      }
    }
    builder_.set_node(node, plain);
  }

  // A node `__start…` without a label that no edge leads to is no state: it points at the one where a model begins.
  void take_start() {
    NodeId start = kNoNode;
    int count = 0;
    for (const auto& [node, found] : starts_) {
      if (found.labelled || found.reached || found.targets.empty()) continue;
      builder_.leave_out(node);
      count += static_cast<int>(found.targets.size());
      if (start == kNoNode) start = found.targets.front();
    }
    if (start == kNoNode) return;
    builder_.set_start(start);
    const std::string first = in_quotes(builder_.id(start));
    builder_.note(count == 1 ? fmt::format("`__start` points at {}, the start, and is left out", first)
                             : fmt::format("{} starts, of which {} is taken", count, first));
  }

  // Of a node that may stand for the start.
  struct Start {
    std::vector<NodeId> targets;
    bool labelled = false;
    bool reached = false;
  };

  DotTokens tokens_;
  bool directed_ = false;
  int depth_ = 0;
  std::map<NodeId, Start> starts_;
  GraphBuilder builder_;
};

}  // namespace

bool is_dot(std::string_view text) {
  constexpr std::size_t kLooked = 4096;
  const std::string nowhere;
  try {
    DotTokens tokens(text.substr(0, kLooked), nowhere);
    tokens.take_keyword("strict");
    if (!tokens.take_keyword("graph") && !tokens.take_keyword("digraph")) return false;
    if (tokens.is_id()) tokens.next();
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
  const Multigraph all = one_way(all_edges(map));
  const bool weighted = all.weighted();
  for (std::size_t i = 0; i < all.edges.size(); ++i) {
    const Edge& edge = all.edges[i];
    std::string attributes;
    if (const std::string label = all.label(i); !label.empty()) attributes = "label=" + dot_quoted(label);
    if (weighted) attributes += fmt::format("{}weight=\"{}\"", attributes.empty() ? "" : ", ", edge.cost);
    if (all.prize(i) != 1) attributes += fmt::format("{}prize=\"{}\"", attributes.empty() ? "" : ", ", all.prize(i));
    text += fmt::format("  {} {} {}{};\n", edge.a, directed ? "->" : "--", edge.b,
                        attributes.empty() ? "" : fmt::format(" [{}]", attributes));
  }
  return text + "}\n";
}

}  // namespace graphdrl
