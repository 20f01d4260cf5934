#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <sstream>
#include <unordered_set>

#include "graphdrl/io/graph_builder.h"
#include "graphdrl/io/readers.h"
#include "graphdrl/io/text.h"
#include "graphdrl/io/utf8.h"
#include "graphdrl/io/xml.h"

namespace graphdrl {
namespace {

class GraphMlReader {
 public:
  GraphMlReader(std::string_view text, const std::string& source, const MapOptions& options)
      : file_(text, source),
        builder_(
            options, [this] { return file_.place(at_); }, std::ssize(text)) {}

  GraphMap read() {
    const pugi::xml_node root = file_.root("graphml");
    const pugi::xml_node graph = root.child("graph");
    if (!graph) file_.fail(root, "no graph", "an element `graph`");
    if (const pugi::xml_node second = graph.next_sibling("graph")) file_.fail(second, "a second graph", "one graph");
    read_keys(root);
    graphs_ = {graph};
    for (std::size_t i = 0; i < graphs_.size(); ++i) {  // grows by the graphs within nodes
      const pugi::xml_node one = graphs_[i];
      for (const pugi::xml_node node : one.children("node")) read_node(node);
    }
    for (const pugi::xml_node one : graphs_) {
      const bool directed = std::string_view(one.attribute("edgedefault").value()) == "directed";
      for (const pugi::xml_node edge : one.children("edge")) read_edge(edge, directed);
      if (const pugi::xml_node hyper = one.child("hyperedge")) {
        file_.fail(hyper, "an edge between more than two nodes", "edges between two nodes");
      }
    }
    at_ = graph;
    leave_out_groups();
    for (const Attribute& attribute : data_of(graph_keys_, graph)) {
      if (attribute.name == "unit") builder_.set_unit(attribute.value);
    }
    return builder_.build();
  }

 private:
  void read_keys(const pugi::xml_node& root) {
    for (const pugi::xml_node key : root.children("key")) {
      const std::string_view kind = key.attribute("for").value();
      const bool all = kind.empty() || kind == "all";
      if (all || kind == "node") node_keys_.add(key, "attr.name");
      if (all || kind == "edge") edge_keys_.add(key, "attr.name");
      if (all || kind == "graph") graph_keys_.add(key, "attr.name");
    }
  }

  // The defaults, and after them what is given.
  static std::vector<Attribute> data_of(const XmlKeys& keys, const pugi::xml_node& item) {
    std::vector<Attribute> attributes = keys.defaults();
    for (const pugi::xml_node data : item.children("data")) {
      keys.append(data.attribute("key").value(), data.text().get(), attributes);
    }
    return attributes;
  }

  // What yEd draws of a node: its text and the upper left corner of its shape.
  static void append_drawing(const pugi::xml_node& item, std::vector<Attribute>& attributes) {
    for (const pugi::xml_node data : item.children("data")) {
      const auto find = [&](std::string_view name) {
        return data.find_node([&](pugi::xml_node one) { return local_name(one) == name; });
      };
      const pugi::xml_node label = find("NodeLabel");
      if (label) attributes.push_back({"label", std::string(trimmed(label.child_value(), " \t\n"))});
      const pugi::xml_node geometry = find("Geometry");
      for (const char* const axis : {"x", "y"}) {
        if (geometry.attribute(axis)) attributes.push_back({axis, geometry.attribute(axis).value()});
      }
    }
  }

  void read_node(const pugi::xml_node& item) {
    at_ = item;
    const pugi::xml_attribute id = item.attribute("id");
    if (!id) file_.fail(item, "a node without an id", "an attribute `id`");
    const NodeId node = builder_.add_node(id.value());
    if (const pugi::xml_node inner = item.child("graph")) {
      graphs_.push_back(inner);
      groups_.insert(node);
    }
    std::vector<Attribute> attributes;
    append_drawing(item, attributes);
    std::ranges::move(data_of(node_keys_, item), std::back_inserter(attributes));
    builder_.set_node(node, attributes);
  }

  void read_edge(const pugi::xml_node& item, bool directed) {
    at_ = item;
    const NodeId from = builder_.node(item.attribute("source").value());
    const NodeId to = builder_.node(item.attribute("target").value());
    const std::string_view one_way = item.attribute("directed").value();
    builder_.add_edge(from, to, one_way.empty() ? directed : one_way == "true");
    builder_.set_edge(data_of(edge_keys_, item));
    groups_.erase(from);
    groups_.erase(to);
  }

  // A group that no edge leads to is a frame around its nodes.
  void leave_out_groups() {
    for (const NodeId group : groups_) builder_.leave_out(group);
    if (groups_.empty()) return;
    builder_.note(fmt::format("groups without edges of their own are left out: {}", groups_.size()));
  }

  const XmlFile file_;
  pugi::xml_node at_;  // what is read, for errors
  std::vector<pugi::xml_node> graphs_;
  std::unordered_set<NodeId> groups_;  // that no edge has led to so far
  XmlKeys node_keys_;
  XmlKeys edge_keys_;
  XmlKeys graph_keys_;
  GraphBuilder builder_;
};

// name: null where it is the id.
void append_key(pugi::xml_node root, const char* id, const char* kind, const char* type, const char* name = nullptr) {
  pugi::xml_node key = root.append_child("key");
  key.append_attribute("id") = id;
  key.append_attribute("for") = kind;
  key.append_attribute("attr.name") = name != nullptr ? name : id;
  key.append_attribute("attr.type") = type;
}

void append_data(pugi::xml_node item, const char* key, const std::string& value) {
  pugi::xml_node data = item.append_child("data");
  data.append_attribute("key") = key;
  data.text() = xml_text(value).c_str();
}

}  // namespace

bool is_graphml(std::string_view text) {
  return is_xml_with(text, "<graphml");
}

GraphMap parse_graphml(std::string_view text, const std::string& source, const MapOptions& options) {
  return GraphMlReader(text, source, options).read();
}

std::string format_graphml(const GraphMap& map, const NodeColumn& column) {
  pugi::xml_document document;
  pugi::xml_node declaration = document.append_child(pugi::node_declaration);
  declaration.append_attribute("version") = "1.0";
  declaration.append_attribute("encoding") = "UTF-8";
  pugi::xml_node root = document.append_child("graphml");
  root.append_attribute("xmlns") = "http://graphml.graphdrawing.org/xmlns";
  const bool blocked = std::find(map.blocked.begin(), map.blocked.end(), true) != map.blocked.end();
  if (blocked) append_key(root, "blocked", "node", "boolean");
  if (!map.prizes.empty()) append_key(root, "prize", "node", "double");
  const std::vector<Point>& points = map.places.points;
  if (!points.empty()) {
    append_key(root, "x", "node", "double");
    append_key(root, "y", "node", "double");
  }
  if (!map.places.unit.empty()) append_key(root, "unit", "graph", "string");
  if (!column.name.empty()) append_key(root, column.name.c_str(), "node", "string");
  const Multigraph all = all_edges(map);
  const bool weighted = all.weighted();
  if (weighted) append_key(root, "weight", "edge", "double");
  if (!all.labels.empty()) append_key(root, "label", "edge", "string");
  if (!all.prizes.empty()) append_key(root, "edge_prize", "edge", "double", "prize");
  pugi::xml_node graph = root.append_child("graph");
  graph.append_attribute("edgedefault") = map.graph.directed() ? "directed" : "undirected";
  if (!map.places.unit.empty()) append_data(graph, "unit", map.places.unit);
  const std::vector<std::string> labels = fitted_labels(map.labels, xml_text);
  const auto id_of = [&](NodeId node) { return labels.empty() ? std::to_string(node) : labels[node]; };
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
  for (std::size_t i = 0; i < all.edges.size(); ++i) {
    const Edge& edge = all.edges[i];
    pugi::xml_node item = graph.append_child("edge");
    item.append_attribute("source") = id_of(edge.a).c_str();
    item.append_attribute("target") = id_of(edge.b).c_str();
    if (all.leads_back(i)) item.append_attribute("directed") = "false";
    if (weighted) append_data(item, "weight", fmt::format("{}", edge.cost));
    if (const std::string label = all.label(i); !label.empty()) append_data(item, "label", xml_text(label));
    if (all.prize(i) != 1) append_data(item, "edge_prize", fmt::format("{}", all.prize(i)));
  }
  std::ostringstream stream;
  document.save(stream, "  ");
  return stream.str();
}

}  // namespace graphdrl
