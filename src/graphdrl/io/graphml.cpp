#include "graphdrl/io/graphml.h"

#include <fmt/format.h>

#include <algorithm>
#include <pugixml.hpp>
#include <sstream>
#include <unordered_map>

#include "graphdrl/base/error.h"
#include "graphdrl/io/graph_builder.h"

namespace graphdrl {
namespace {

class GraphMlReader {
 public:
  GraphMlReader(std::string_view text, const std::string& source, const MapOptions& options)
      : text_(text), source_(source), builder_(options, [this] { return place(); }) {}

  GraphMap read() {
    pugi::xml_document document;
    const pugi::xml_parse_result result = document.load_buffer(text_.data(), text_.size());
    if (!result) {
      throw Error({.what = fmt::format("XML that is not well formed ({})", result.description()),
                   .where = fmt::format("{}:{}", source_, line_of(result.offset))});
    }
    const pugi::xml_node root = document.child("graphml");
    const pugi::xml_node graph = root.child("graph");
    if (!graph) throw Error({.what = "no graph", .expected = "an element `graph`", .where = source_});
    at_ = graph.next_sibling("graph");
    if (at_) fail("a second graph", "one graph");
    read_keys(root);
    directed_ = std::string_view(graph.attribute("edgedefault").value()) == "directed";
    for (const pugi::xml_node node : graph.children("node")) read_node(node);
    for (const pugi::xml_node edge : graph.children("edge")) read_edge(edge);
    at_ = graph.child("hyperedge");
    if (at_) fail("an edge between more than two nodes", "edges between two nodes");
    at_ = graph;
    GraphMap map = builder_.build();
    for (const pugi::xml_node data : graph.children("data")) {
      const auto key = graph_keys_.find(data.attribute("key").value());
      if (key != graph_keys_.end() && key->second.name == "unit") map.places.unit = data.text().get();
    }
    return map;
  }

 private:
  struct Key {
    std::string name;
    std::string fallback;  // the value where none is given; empty where there is none
    bool has_fallback = false;
  };
  using Keys = std::unordered_map<std::string, Key>;

  std::ptrdiff_t line_of(std::ptrdiff_t offset) const {
    offset = std::clamp<std::ptrdiff_t>(offset, 0, std::ssize(text_));
    return 1 + std::count(text_.begin(), text_.begin() + offset, '\n');
  }
  std::string place() const { return fmt::format("{}:{}", source_, line_of(at_.offset_debug())); }
  [[noreturn]] void fail(const std::string& what, const std::string& expected) const {
    throw Error({.what = what, .expected = expected, .where = place()});
  }

  void read_keys(const pugi::xml_node& root) {
    for (const pugi::xml_node key : root.children("key")) {
      const std::string_view kind = key.attribute("for").value();
      const pugi::xml_node fallback = key.child("default");
      const Key found{.name = key.attribute("attr.name").value(),
                      .fallback = fallback.text().get(),
                      .has_fallback = static_cast<bool>(fallback)};
      const std::string id = key.attribute("id").value();
      const bool all = kind.empty() || kind == "all";
      if (all || kind == "node") node_keys_[id] = found;
      if (all || kind == "edge") edge_keys_[id] = found;
      if (all || kind == "graph") graph_keys_[id] = found;
    }
  }

  // Calls set(name, value) for what is given, and for the defaults before.
  template <typename Set>
  static void read_data(const Keys& keys, const pugi::xml_node& item, const Set& set) {
    for (const auto& [id, key] : keys) {
      if (key.has_fallback) set(key.name, key.fallback);
    }
    for (const pugi::xml_node data : item.children("data")) {
      const auto key = keys.find(data.attribute("key").value());
      if (key != keys.end()) set(key->second.name, data.text().get());
    }
  }

  void read_node(const pugi::xml_node& item) {
    at_ = item;
    const pugi::xml_attribute id = item.attribute("id");
    if (!id) fail("a node without an id", "an attribute `id`");
    if (item.child("graph")) fail("a graph within a node", "one flat graph");
    const NodeId node = builder_.add_node(id.value());
    read_data(node_keys_, item,
              [&](const std::string& name, std::string_view value) { builder_.set_node(node, name, value); });
  }

  void read_edge(const pugi::xml_node& item) {
    at_ = item;
    const NodeId from = builder_.node(item.attribute("source").value());
    const NodeId to = builder_.node(item.attribute("target").value());
    const std::string_view one_way = item.attribute("directed").value();
    builder_.add_edge(from, to, one_way.empty() ? directed_ : one_way == "true");
    read_data(edge_keys_, item,
              [&](const std::string& name, std::string_view value) { builder_.set_edge(name, value); });
  }

  std::string_view text_;
  const std::string& source_;
  pugi::xml_node at_;  // what is read, for errors
  Keys node_keys_;
  Keys edge_keys_;
  Keys graph_keys_;
  bool directed_ = false;
  GraphBuilder builder_;
};

void append_key(pugi::xml_node root, const char* id, const char* kind, const char* name, const char* type) {
  pugi::xml_node key = root.append_child("key");
  key.append_attribute("id") = id;
  key.append_attribute("for") = kind;
  key.append_attribute("attr.name") = name;
  key.append_attribute("attr.type") = type;
}

void append_data(pugi::xml_node item, const char* key, const std::string& value) {
  pugi::xml_node data = item.append_child("data");
  data.append_attribute("key") = key;
  data.text() = value.c_str();
}

}  // namespace

bool is_graphml(std::string_view text) {
  constexpr std::size_t kLooked = 4096;  // comments may stand before it
  const std::size_t begin = text.find_first_not_of(" \t\r\n");
  if (begin == std::string_view::npos || text[begin] != '<') return false;
  return text.substr(0, kLooked).find("<graphml") != std::string_view::npos;
}

GraphMap parse_graphml(std::string_view text, const std::string& source, const MapOptions& options) {
  return GraphMlReader(text, source, options).read();
}

std::string format_graphml(const GraphMap& map) {
  return format_graphml(map, {});
}

std::string format_graphml(const GraphMap& map, const NodeColumn& column) {
  pugi::xml_document document;
  pugi::xml_node declaration = document.append_child(pugi::node_declaration);
  declaration.append_attribute("version") = "1.0";
  declaration.append_attribute("encoding") = "UTF-8";
  pugi::xml_node root = document.append_child("graphml");
  root.append_attribute("xmlns") = "http://graphml.graphdrawing.org/xmlns";
  const bool blocked = std::find(map.blocked.begin(), map.blocked.end(), true) != map.blocked.end();
  if (blocked) append_key(root, "blocked", "node", "blocked", "boolean");
  if (!map.prizes.empty()) append_key(root, "prize", "node", "prize", "double");
  const std::vector<Point>& points = map.places.points;
  if (!points.empty()) {
    append_key(root, "x", "node", "x", "double");
    append_key(root, "y", "node", "y", "double");
  }
  if (!map.places.unit.empty()) append_key(root, "unit", "graph", "unit", "string");
  if (!column.name.empty()) append_key(root, column.name.c_str(), "node", column.name.c_str(), "string");
  if (map.graph.weighted()) append_key(root, "weight", "edge", "weight", "double");
  pugi::xml_node graph = root.append_child("graph");
  graph.append_attribute("edgedefault") = map.graph.directed() ? "directed" : "undirected";
  if (!map.places.unit.empty()) append_data(graph, "unit", map.places.unit);
  const auto id_of = [&](NodeId node) { return map.labels.empty() ? std::to_string(node) : map.labels[node]; };
  for (NodeId node = 0; node < map.graph.node_count(); ++node) {
    pugi::xml_node item = graph.append_child("node");
    item.append_attribute("id") = id_of(node).c_str();
    if (map.blocked[node]) append_data(item, "blocked", "true");
    if (!map.prizes.empty()) append_data(item, "prize", fmt::format("{}", map.prizes[node]));
    if (!column.name.empty() && !column.values[node].empty()) {
      append_data(item, column.name.c_str(), column.values[node]);
    }
    if (points.empty()) continue;
    append_data(item, "x", fmt::format("{}", points[node].x));
    append_data(item, "y", fmt::format("{}", points[node].y));
  }
  for (const Edge& edge : map.graph.edges()) {
    pugi::xml_node item = graph.append_child("edge");
    item.append_attribute("source") = id_of(edge.a).c_str();
    item.append_attribute("target") = id_of(edge.b).c_str();
    if (map.graph.weighted()) append_data(item, "weight", fmt::format("{}", edge.cost));
  }
  std::ostringstream stream;
  document.save(stream, "  ");
  return stream.str();
}

}  // namespace graphdrl
