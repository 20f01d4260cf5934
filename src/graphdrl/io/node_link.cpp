#include "graphdrl/io/node_link.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <unordered_map>

#include "graphdrl/base/error.h"

namespace graphdrl {
namespace {

using nlohmann::json;

json parse_json(std::string_view text, const std::string& source) {
  try {
    return json::parse(text);
  } catch (const json::parse_error& error) {
    const std::string_view before = text.substr(0, error.byte);
    throw Error({.what = "not JSON",
                 .expected = "a graph in node-link form",
                 .where = fmt::format("{}:{}", source, 1 + std::count(before.begin(), before.end(), '\n'))});
  } catch (const json::out_of_range&) {
    throw Error({.what = "a number too large", .where = source});
  }
}

// What a graph is read from, with the errors about it.
class Reader {
 public:
  Reader(const json& document, const std::string& source) : document_(document), source_(source) {}

  GraphMap read();

 private:
  [[noreturn]] void fail(const std::string& place, const std::string& what, const std::string& expected,
                         const json& got) const {
    throw Error({.what = what,
                 .expected = expected,
                 .got = in_quotes(got.dump(-1, ' ', false, json::error_handler_t::replace)),
                 .where = source_ + ": " + place});
  }

  // The array under the first of two keys that is there.
  const json& array(const char* key, const char* other) const {
    const char* const found = document_.contains(key) ? key : other;
    const auto value = document_.find(found);
    if (value == document_.end()) throw Error({.what = fmt::format("no key \"{}\"", key), .where = source_});
    if (!value->is_array()) fail(found, "bad value", "an array", *value);
    return *value;
  }

  // A node's id as text: 5 and "5" are the same.
  std::string id_of(const json& item, const char* key, const std::string& place) const {
    const auto id = item.is_object() ? item.find(key) : item.end();
    if (!item.is_object() || id == item.end())
      fail(place, fmt::format("no key \"{}\"", key), "an object with it", item);
    if (id->is_string()) return id->get<std::string>();
    if (!id->is_number_integer()) fail(place, fmt::format("bad \"{}\"", key), "a text or a whole number", *id);
    return id->dump();
  }

  void read_nodes();
  std::vector<Edge> read_edges() const;

  const json& document_;
  const std::string& source_;
  GraphMap map_;
  std::unordered_map<std::string, NodeId> node_of_;
};

void Reader::read_nodes() {
  const json& nodes = array("nodes", "nodes");
  bool plain = true;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const std::string place = fmt::format("nodes[{}]", i);
    std::string id = id_of(nodes[i], "id", place);
    if (!node_of_.try_emplace(id, static_cast<NodeId>(i)).second)
      fail(place, "an id used twice", "ids all different", nodes[i]);
    const auto blocked = nodes[i].find("blocked");
    if (blocked != nodes[i].end() && !blocked->is_boolean()) fail(place, "bad \"blocked\"", "true or false", *blocked);
    map_.blocked.push_back(blocked != nodes[i].end() && blocked->get<bool>());
    plain = plain && id == std::to_string(i);
    map_.labels.push_back(std::move(id));
  }
  if (plain) map_.labels.clear();
}

std::vector<Edge> Reader::read_edges() const {
  const bool links = document_.contains("links");
  const json& items = array("links", "edges");
  std::vector<Edge> edges;
  for (std::size_t i = 0; i < items.size(); ++i) {
    const std::string place = fmt::format("{}[{}]", links ? "links" : "edges", i);
    const auto end = [&](const char* key) {
      const auto node = node_of_.find(id_of(items[i], key, place));
      if (node == node_of_.end()) fail(place, fmt::format("\"{}\" is no node", key), "the id of a node", items[i][key]);
      return node->second;
    };
    Edge edge{.a = end("source"), .b = end("target")};
    const char* const cost_key = items[i].contains("weight") ? "weight" : "cost";
    if (const auto cost = items[i].find(cost_key); cost != items[i].end()) {
      const bool positive = cost->is_number() && cost->get<double>() > 0;
      if (!positive) fail(place, fmt::format("bad \"{}\"", cost_key), "a positive number", *cost);
      edge.cost = cost->get<double>();
    }
    edges.push_back(edge);
  }
  return edges;
}

GraphMap Reader::read() {
  if (!document_.is_object())
    throw Error({.what = "not a graph in node-link form", .expected = "an object", .where = source_});
  const auto directed = document_.find("directed");
  if (directed != document_.end() && !directed->is_boolean()) fail("directed", "bad value", "true or false", *directed);
  const bool one_way = directed != document_.end() && directed->get<bool>();
  read_nodes();
  if (std::find(map_.blocked.begin(), map_.blocked.end(), false) == map_.blocked.end()) {
    throw Error({.what = "the graph has no free node", .where = source_});
  }
  map_.graph = Graph::from_edges(static_cast<NodeId>(map_.blocked.size()), read_edges(),
                                 one_way ? EdgeKind::kDirected : EdgeKind::kUndirected);
  return std::move(map_);
}

}  // namespace

GraphMap parse_node_link(std::string_view text, const std::string& source) {
  const json document = parse_json(text, source);
  return Reader(document, source).read();
}

std::string format_node_link(const GraphMap& map) {
  const auto id_of = [&](NodeId node) { return map.labels.empty() ? json(node) : json(map.labels[node]); };
  nlohmann::ordered_json document;
  document["directed"] = map.graph.directed();
  document["multigraph"] = false;
  document["graph"] = nlohmann::ordered_json::object();
  document["nodes"] = nlohmann::ordered_json::array();
  for (NodeId node = 0; node < map.graph.node_count(); ++node) {
    nlohmann::ordered_json item{{"id", id_of(node)}};
    if (map.blocked[node]) item["blocked"] = true;
    document["nodes"].push_back(std::move(item));
  }
  document["links"] = nlohmann::ordered_json::array();
  for (const Edge& edge : map.graph.edges()) {
    nlohmann::ordered_json item{{"source", id_of(edge.a)}, {"target", id_of(edge.b)}};
    if (map.graph.weighted()) item["weight"] = edge.cost;
    document["links"].push_back(std::move(item));
  }
  return document.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + '\n';
}

}  // namespace graphdrl
