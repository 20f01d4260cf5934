#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <utility>

#include "graphdrl/base/error.h"
#include "graphdrl/io/graph_builder.h"
#include "graphdrl/io/json.h"
#include "graphdrl/io/readers.h"
#include "graphdrl/io/text.h"
#include "graphdrl/io/utf8.h"

namespace graphdrl {
namespace {

using nlohmann::json;

// As JSON writes it; numbers, of which there are many, by a faster way than dump().
std::string text_of(const json& value) {
  if (value.is_number_unsigned()) return fmt::format_int(value.get<std::uint64_t>()).str();
  if (value.is_number_float()) return fmt::format("{}", value.get<double>());
  return value.dump();
}

// A list as Python writes a tuple: networkx calls the nodes of its grids (0, 0). Empty where it holds something else
// than texts, numbers and such lists.
std::string tuple_text(const json& list) {
  std::string text;
  for (const json& item : list) {
    std::string part;
    if (item.is_array()) part = tuple_text(item);
    if (item.is_number()) part = item.dump();
    if (item.is_string()) part = fmt::format("'{}'", item.get_ref<const std::string&>());
    if (part.empty()) return {};
    text += text.empty() ? part : ", " + part;
  }
  return fmt::format("({}{})", text, list.size() == 1 ? "," : "");
}

// Reads nodes and links one by one as the parser comes by them: the document is never held whole.
class NodeLinkReader {
 public:
  NodeLinkReader(std::string_view text, const std::string& source, const MapOptions& options)
      : text_(text), source_(source), builder_(options, [this] { return place(); }) {}

  GraphMap read() {
    parse();
    if (!nodes_read_) throw Error({.what = "no key \"nodes\"", .where = source_});
    if (links_key_.empty()) throw Error({.what = "no key \"links\"", .where = source_});
    if (!links_read_) {
      links_only_ = true;
      parse();
    }
    if (directed_) builder_.direct_all();
    key_.clear();
    return builder_.build();
  }

 private:
  using Event = json::parse_event_t;
  // The document's keys that are looked at.
  enum class Section { kOther, kDirected, kGraph, kNodes, kLinks };

  std::string place() const {
    if (key_.empty()) return source_;
    return in_list_ ? fmt::format("{}: {}[{}]", source_, key_, index_) : fmt::format("{}: {}", source_, key_);
  }
  [[noreturn]] void fail(const std::string& what, const std::string& expected, const json& got) const {
    throw Error({.what = what, .expected = expected, .got = shortened(got), .where = place()});
  }

  void parse() {
    const auto take = [this](int depth, Event event, json& value) {
      if (depth == 0 && event != Event::object_start && event != Event::object_end) {
        throw Error({.what = "not a graph in node-link form", .expected = "an object", .where = source_});
      }
      if (depth > kMaxJsonDepth) require_shallow_json(text_, source_);
      return depth == 0 || take_event(depth, event, value);
    };
    try {
      [[maybe_unused]] const json nothing = json::parse(text_, take);
    } catch (const json::parse_error& complaint) {
      throw json_error(complaint, complaint.byte, text_, source_, "a graph in node-link form");
    } catch (const json::exception& complaint) {
      throw json_error(complaint, 0, text_, source_, "a graph in node-link form");
    }
  }

  // Depth 1: a value of the document. 2: an item of its lists. Whether the parser is to hold the value for what it
  // stands in.
  bool take_event(int depth, Event event, json& value) {
    if (depth == 1 && event == Event::key) {
      key_ = value.get<std::string>();
      section_ = section_of(key_);
      in_list_ = false;
      return section_ != Section::kOther;
    }
    const bool list = section_ == Section::kNodes || section_ == Section::kLinks;
    if (depth == 1 && event == Event::array_start && list) {
      in_list_ = true;
      index_ = 0;
    }
    if (event == Event::object_start || event == Event::array_start || event == Event::key) return true;
    if (depth == 1) {
      leave_key(value, event);
    } else if (depth == 2 && in_list_) {
      section_ == Section::kNodes ? read_node(value) : read_link(value);
      ++index_;
      return false;
    }
    return depth > 1;
  }

  Section section_of(const std::string& key) {
    if (links_only_) return key == links_key_ ? Section::kLinks : Section::kOther;
    if (key == "directed") return Section::kDirected;
    if (key == "graph") return Section::kGraph;
    const bool links = key == "links" || (key == "edges" && links_key_ != "links");
    if (key != "nodes" && !links) return Section::kOther;
    if (links ? key == links_key_ : nodes_read_) {
      throw Error({.what = fmt::format("the key \"{}\" stands twice", key), .where = source_});
    }
    if (!links) return Section::kNodes;
    links_key_ = key;
    links_read_ = false;
    builder_.clear_edges();  // those called `edges`
    return nodes_read_ ? Section::kLinks : Section::kOther;
  }

  void leave_key(const json& value, Event event) {
    if (section_ == Section::kDirected) {
      if (!value.is_boolean()) fail("bad value", "true or false", value);
      directed_ = value.get<bool>();
    } else if (section_ == Section::kGraph && value.is_object()) {
      const auto unit = value.find("unit");
      if (unit != value.end() && unit->is_string()) builder_.set_unit(unit->get_ref<const std::string&>());
    } else if (section_ == Section::kNodes || section_ == Section::kLinks) {
      if (event != Event::array_end) fail("bad value", "an array", value);
      (section_ == Section::kNodes ? nodes_read_ : links_read_) = true;
    }
  }

  // The text of an id.
  std::string id_at(const json& item, const char* key) const {
    const auto found = item.is_object() ? item.find(key) : item.end();
    if (found == item.end()) fail(fmt::format("no key \"{}\"", key), "an object with it", item);
    if (found->is_string()) return found->get<std::string>();
    std::string text = found->is_array() ? tuple_text(*found) : found->is_number_integer() ? text_of(*found) : "";
    if (text.empty()) fail(fmt::format("bad \"{}\"", key), "a text or a whole number", *found);
    return text;
  }

  // Costs and prizes are numbers, also in JSON; a label that is no text and a coordinate that is no number are skipped.
  void read_node(const json& item) {
    const NodeId node = builder_.add_node(id_at(item, "id"));
    attributes_.clear();
    for (const auto& [name, value] : item.items()) {
      const bool label = is_name_of(name, kLabelNames);
      const bool skipped = (label && !value.is_string()) || (place_column(name) < kPlaceColumns && !value.is_number());
      if (same_name(name, "blocked") && !value.is_boolean()) fail("bad \"blocked\"", "true or false", value);
      if (skipped) continue;
      std::string text;
      if (label) text = value.get<std::string>();
      if (!label && builder_.uses_of_node(name)) text = text_of(value);
      attributes_.push_back({name, std::move(text)});
    }
    builder_.set_node(node, attributes_);
  }

  void read_link(const json& item) {
    const NodeId source = builder_.node(id_at(item, "source"));
    builder_.add_edge(source, builder_.node(id_at(item, "target")), /*one_way=*/false);
    attributes_.clear();
    for (const auto& [name, value] : item.items()) {
      attributes_.push_back({name, builder_.uses_of_edge(name) ? text_of(value) : ""});
    }
    builder_.set_edge(attributes_);
  }

  std::string_view text_;
  const std::string& source_;
  Section section_ = Section::kOther;
  std::string key_;         // of the document, at hand
  bool in_list_ = false;    // of nodes or links
  std::int64_t index_ = 0;  // in it
  std::string links_key_;   // `links` or `edges`
  bool nodes_read_ = false;
  bool links_read_ = false;
  bool links_only_ = false;  // the second reading, where links stand before nodes
  bool directed_ = false;
  std::vector<Attribute> attributes_;
  GraphBuilder builder_;
};

}  // namespace

bool is_node_link(std::string_view text) {
  return trimmed(text, " \t\r\n").starts_with('{');
}

GraphMap parse_node_link(std::string_view text, const std::string& source, const MapOptions& options) {
  return NodeLinkReader(text, source, options).read();
}

std::string format_node_link(const GraphMap& map) {
  const auto& [graph, blocked, labels, prizes, places, task, multigraph] = map;
  const Multigraph all = one_way(all_edges(map));
  const bool weighted = all.weighted();
  std::string text;
  const std::vector<std::string> ids = fitted_labels(labels, valid_utf8);
  const auto append_id = [&](NodeId node) { text += ids.empty() ? std::to_string(node) : json(ids[node]).dump(); };
  const std::string unit = places.unit.empty() ? "" : R"("unit":)" + json(valid_utf8(places.unit)).dump();
  text += fmt::format(R"({{"directed":{},"multigraph":{},"graph":{{{}}},"nodes":[)", graph.directed(),
                      multigraph != nullptr, unit);
  for (NodeId node = 0; node < graph.node_count(); ++node) {
    text += node == 0 ? R"({"id":)" : R"(,{"id":)";
    append_id(node);
    if (blocked[node]) text += R"(,"blocked":true)";
    if (!prizes.empty() && prizes[node] != 1) text += R"(,"prize":)" + json(prizes[node]).dump();
    if (!places.points.empty()) {
      const auto [x, y] = places.points[node];
      text += R"(,"x":)" + json(x).dump() + R"(,"y":)" + json(y).dump();
    }
    text += '}';
  }
  text += R"(],"links":[)";
  for (std::size_t i = 0; i < all.edges.size(); ++i) {
    text += i == 0 ? R"({"source":)" : R"(,{"source":)";
    append_id(all.edges[i].a);
    text += R"(,"target":)";
    append_id(all.edges[i].b);
    if (weighted) text += R"(,"weight":)" + json(all.edges[i].cost).dump();
    if (all.prize(i) != 1) text += R"(,"prize":)" + json(all.prize(i)).dump();
    if (const std::string label = all.label(i); !label.empty()) {
      text += R"(,"label":)" + json(valid_utf8(label)).dump();
    }
    text += '}';
  }
  text += "]}\n";
  return text;
}

}  // namespace graphdrl
