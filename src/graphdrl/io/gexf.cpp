#include "graphdrl/io/graph_builder.h"
#include "graphdrl/io/readers.h"
#include "graphdrl/io/xml.h"

namespace graphdrl {
namespace {

class GexfReader {
 public:
  GexfReader(std::string_view text, const std::string& source, const MapOptions& options)
      : file_(text, source),
        builder_(
            options, [this] { return file_.place(at_); }, std::ssize(text)) {}

  GraphMap read() {
    const pugi::xml_node root = file_.root("gexf");
    const pugi::xml_node graph = root.child("graph");
    if (!graph) file_.fail(root, "no graph", "an element `graph`");
    read_titles(graph);
    lists_ = {graph.child("nodes")};
    for (std::size_t i = 0; i < lists_.size(); ++i) {  // grows by the nodes within nodes
      const pugi::xml_node list = lists_[i];
      for (const pugi::xml_node node : list.children("node")) read_node(node);
    }
    const std::string_view directed = graph.attribute("defaultedgetype").value();
    for (const pugi::xml_node list : lists_) {
      for (const pugi::xml_node edge : list.parent().child("edges").children("edge")) read_edge(edge, directed);
    }
    at_ = graph;
    return builder_.build();
  }

 private:
  void read_titles(const pugi::xml_node& graph) {
    for (const pugi::xml_node list : graph.children("attributes")) {
      XmlKeys& keys = std::string_view(list.attribute("class").value()) == "edge" ? of_edges_ : of_nodes_;
      for (const pugi::xml_node key : list.children("attribute")) keys.add(key, "title");
    }
  }

  // The defaults, and after them what is given.
  static std::vector<Attribute> values_of(const XmlKeys& keys, const pugi::xml_node& item) {
    std::vector<Attribute> attributes = keys.defaults();
    for (const pugi::xml_node value : item.child("attvalues").children("attvalue")) {
      const pugi::xml_attribute id = value.attribute("for") ? value.attribute("for") : value.attribute("id");  // 1.0
      keys.append(id.value(), value.attribute("value").value(), attributes);
    }
    for (const char* const name : {"label", "weight"}) {
      if (item.attribute(name)) attributes.push_back({name, item.attribute(name).value()});
    }
    return attributes;
  }

  void read_node(const pugi::xml_node& item) {
    at_ = item;
    if (!item.attribute("id")) file_.fail(item, "a node without an id", "an attribute `id`");
    const NodeId node = builder_.add_node(item.attribute("id").value());
    std::vector<Attribute> attributes = values_of(of_nodes_, item);
    for (const pugi::xml_node part : item.children()) {
      if (local_name(part) != "position") continue;
      for (const char* const axis : {"x", "y"}) {
        if (part.attribute(axis)) attributes.push_back({axis, part.attribute(axis).value()});
      }
    }
    builder_.set_node(node, attributes);
    if (item.child("nodes")) lists_.push_back(item.child("nodes"));
  }

  void read_edge(const pugi::xml_node& item, std::string_view directed) {
    at_ = item;
    const NodeId from = builder_.node(item.attribute("source").value());
    const NodeId to = builder_.node(item.attribute("target").value());
    const std::string_view type = item.attribute("type").value();
    builder_.add_edge(from, to, (type.empty() ? directed : type) == "directed");
    builder_.set_edge(values_of(of_edges_, item));
  }

  const XmlFile file_;
  pugi::xml_node at_;                  // what is read, for errors
  std::vector<pugi::xml_node> lists_;  // of nodes
  XmlKeys of_nodes_;
  XmlKeys of_edges_;
  GraphBuilder builder_;
};

}  // namespace

bool is_gexf(std::string_view text) {
  return is_xml_with(text, "<gexf");
}

GraphMap parse_gexf(std::string_view text, const std::string& source, const MapOptions& options) {
  return GexfReader(text, source, options).read();
}

}  // namespace graphdrl
