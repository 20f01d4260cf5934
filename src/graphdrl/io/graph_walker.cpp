#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <unordered_map>

#include "graphdrl/base/error.h"
#include "graphdrl/io/graph_builder.h"
#include "graphdrl/io/json.h"
#include "graphdrl/io/readers.h"

namespace graphdrl {
namespace {

using nlohmann::json;

class GraphWalkerReader {
 public:
  GraphWalkerReader(const std::string& source, const MapOptions& options)
      : source_(source),
        cost_attribute_(options.cost_attribute),
        builder_(options, [this] { return fmt::format("{}: {}", source_, place_); }) {}

  GraphMap read(const json& document) {
    const json& models = list_in(document, "models");
    if (models.size() != 1) fail("GraphWalker's models", "one model", json(models.size()));
    const json& model = models.front();
    for (const json& vertex : list_in(model, "vertices")) read_vertex(vertex);
    for (const json& edge : list_in(model, "edges")) read_edge(edge);
    place_ = "models[0]";
    const std::string first = text_in(model, "startElementId");
    if (!first.empty()) {
      const auto entered = targets_.find(first);
      builder_.set_start(entered != targets_.end() ? entered->second : builder_.node(first));
    } else if (entries_.size() == 1) {
      builder_.set_start(entries_.front());
      builder_.note("the model names no start, so its only edge from nowhere does");
    } else if (entries_.size() > 1) {
      builder_.note(
          fmt::format("the model names no start, and none of its {} edges from nowhere is taken", entries_.size()));
    }
    builder_.direct_all();
    return builder_.build();
  }

 private:
  [[noreturn]] void fail(const std::string& what, const std::string& expected, const json& got) const {
    throw Error(
        {.what = what, .expected = expected, .got = shortened(got), .where = fmt::format("{}: {}", source_, place_)});
  }

  const json& list_in(const json& object, const char* key) {
    if (object.is_object()) {
      const auto found = object.find(key);
      if (found != object.end() && found->is_array()) return *found;
    }
    fail(fmt::format("no list \"{}\"", key), "a model of GraphWalker", object);
  }

  // Empty where there is no text.
  static std::string text_in(const json& object, const char* key) {
    const auto found = object.is_object() ? object.find(key) : object.end();
    return found != object.end() && found->is_string() ? found->get<std::string>() : std::string();
  }

  void read_vertex(const json& vertex) {
    place_ = fmt::format("vertices[{}]", builder_.node_count());
    const std::string id = text_in(vertex, "id");
    if (id.empty()) fail("no \"id\"", "a text", vertex);
    const NodeId node = builder_.add_node(id);
    builder_.set_node(node, "name", text_in(vertex, "name"));
    const auto properties = vertex.find("properties");
    if (properties == vertex.end() || !properties->is_object()) return;
    std::vector<Attribute> attributes;
    for (const auto& [name, value] : properties->items()) {
      if (place_column(name) < kPlaceColumns && value.is_number()) attributes.push_back({name, value.dump()});
    }
    builder_.set_node(node, attributes);
  }

  // An edge from nowhere leads to where a walk may begin.
  void read_edge(const json& edge) {
    place_ = fmt::format("edges[{}]", edge_++);
    const NodeId target = builder_.node(text_in(edge, "targetVertexId"));
    const std::string source = text_in(edge, "sourceVertexId");
    targets_[text_in(edge, "id")] = target;
    if (source.empty()) {
      entries_.push_back(target);
      return;
    }
    builder_.add_edge(builder_.node(source), target, /*one_way=*/false);  // as all of them in the end
    if (cost_attribute_.empty()) return;
    std::vector<Attribute> attributes;
    for (const auto& [name, value] : edge.items()) {
      if (value.is_number()) attributes.push_back({name, value.dump()});
    }
    builder_.set_edge(attributes);
  }

  const std::string& source_;
  const std::string& cost_attribute_;
  std::string place_ = "models";  // of what is read, for errors
  int edge_ = 0;
  std::unordered_map<std::string, NodeId> targets_;  // of edges, by their ids
  std::vector<NodeId> entries_;
  GraphBuilder builder_;
};

}  // namespace

bool is_graph_walker(std::string_view text) {
  constexpr std::size_t kLooked = 4096;
  const std::string_view begin = text.substr(0, kLooked);
  const std::size_t first = begin.find_first_not_of(" \t\r\n");
  const auto has = [](std::string_view part, std::string_view key) { return part.find(key) != std::string_view::npos; };
  return first != std::string_view::npos && begin[first] == '{' && has(begin, "\"models\"") &&
         !has(begin, "\"nodes\"") && has(text, "\"vertices\"");
}

GraphMap parse_graph_walker(std::string_view text, const std::string& source, const MapOptions& options) {
  return GraphWalkerReader(source, options).read(parse_json(text, source, "a model of GraphWalker"));
}

}  // namespace graphdrl
