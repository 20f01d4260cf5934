#include "graphdrl/io/node_link.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "graphdrl/base/error.h"
#include "graphdrl/io/graph_builder.h"
#include "graphdrl/io/json.h"
#include "graphdrl/io/node_ids.h"

namespace graphdrl {
namespace {

using nlohmann::json;

// The keys of nodes and links that are looked at. Of several for one thing the first one counts.
enum Key {
  kId,
  kBlocked,
  kPrize,
  kScore,
  kX,
  kLon,
  kLongitude,
  kY,
  kLat,
  kLatitude,
  kLabel,
  kName,
  kSource,
  kTarget,
  kWeight,
  kCost,
  kLength,
  kDistance,
  kKeyCount
};
constexpr std::array<const char*, kKeyCount> kKeyNames = {
    "id",       "blocked", "prize", "score",  "x",      "lon",    "longitude", "y",      "lat",
    "latitude", "label",   "name",  "source", "target", "weight", "cost",      "length", "distance"};

// What stands under one of these keys.
struct Field {
  enum class Kind { kMissing, kBoolean, kWhole, kNegative, kFraction, kText, kOther };

  Kind kind = Kind::kMissing;
  bool truth = false;       // kBoolean
  std::uint64_t whole = 0;  // kWhole
  double number = 0;        // kWhole, kNegative, kFraction

  bool given() const { return kind != Kind::kMissing; }
  bool is_id() const { return kind == Kind::kWhole || kind == Kind::kNegative || kind == Kind::kText; }
  bool is_number() const { return kind == Kind::kWhole || kind == Kind::kNegative || kind == Kind::kFraction; }
};

// The item with this index of the array under a key of the document, or with kNoIndex what stands under the key itself:
// for an error's message.
constexpr std::int64_t kNoIndex = -1;
json value_at(std::string_view text, const std::string& key, std::int64_t index) {
  const int wanted_depth = index == kNoIndex ? 1 : 2;
  json found;
  bool under_key = false;
  std::int64_t at = 0;
  const auto keep = [&](int depth, json::parse_event_t event, json& parsed) {
    using Event = json::parse_event_t;
    if (event == Event::key && depth == 1) under_key = parsed == key;
    const bool whole = event == Event::value || event == Event::object_end || event == Event::array_end;
    if (!whole || !under_key || depth != wanted_depth) return true;
    if (index == kNoIndex || at++ == index) found = std::move(parsed);
    return false;  // so that the document is never held whole
  };
  [[maybe_unused]] const json rest = json::parse(text, keep, /*allow_exceptions=*/false);
  return found;
}

// Takes nlohmann's SAX events (their names are the library's) and fills the arrays of a graph.
class NodeLinkReader {
 public:
  NodeLinkReader(std::string_view text, const std::string& source, const MapOptions& options)
      : text_(text), source_(source), cost_attribute_(options.cost_attribute) {}

  GraphMap read();

  bool null() { return value({.kind = Field::Kind::kOther}); }
  bool boolean(bool truth) { return value({.kind = Field::Kind::kBoolean, .truth = truth}); }
  bool number_integer(json::number_integer_t number) {
    if (number >= 0) return number_unsigned(static_cast<json::number_unsigned_t>(number));  // -0
    return value({.kind = Field::Kind::kNegative, .number = static_cast<double>(number)}, std::to_string(number));
  }
  bool number_unsigned(json::number_unsigned_t number) {
    return value({.kind = Field::Kind::kWhole, .whole = number, .number = static_cast<double>(number)});
  }
  bool number_float(json::number_float_t number, const std::string&) {
    return value({.kind = Field::Kind::kFraction, .number = number});
  }
  bool string(std::string& text) { return value({.kind = Field::Kind::kText}, text); }
  bool binary(json::binary_t&) { return value({.kind = Field::Kind::kOther}); }
  bool key(std::string& name);
  bool start_object(std::size_t);
  bool end_object();
  bool start_array(std::size_t);
  bool end_array();
  bool parse_error(std::size_t position, const std::string&, const json::exception& complaint) {
    throw json_error(complaint, position, text_, source_, "a graph in node-link form");
  }

 private:
  // What the events are directly inside of; deeper ones are skipped.
  enum Depth { kOutside, kDocument, kArray, kItem };
  // The document's keys that are looked at.
  enum class Section { kOther, kDirected, kGraph, kNodes, kLinks };

  Section section_of(const std::string& key);
  bool value(const Field& field, std::string_view text = {});
  void enter();
  void read_node();
  void read_link();
  Key first_given(std::initializer_list<Key> keys) const;
  NodeId node_at(Key key) const;
  double number_at(Key key) const;
  const char* name_of(Key key) const;

  // Throws Error about the item at hand, showing what stands under its key, or it whole where it has no such key.
  [[noreturn]] void fail(const std::string& what, const std::string& expected, Key key = kKeyCount) const;
  // Throws Error about what stands under the document's key at hand.
  [[noreturn]] void fail_at_key(const std::string& expected) const;

  std::string_view text_;
  const std::string& source_;
  const std::string& cost_attribute_;  // read as kWeight, the other costs not at all; empty: as they are called
  bool cost_attribute_met_ = false;

  bool links_only_ = false;  // the second reading
  int depth_ = kOutside;
  std::string section_key_;
  Section section_ = Section::kOther;
  bool reading_ = false;    // inside of an array whose items are looked at
  std::int64_t index_ = 0;  // in that array
  Key key_ = kKeyCount;     // of the item at hand
  std::array<Field, kKeyCount> fields_;
  std::array<std::string, kKeyCount> texts_;  // of kText and kNegative; kept from item to item, with their memory

  bool directed_ = false;
  bool nodes_read_ = false;
  bool links_read_ = false;
  std::string nodes_key_;  // "nodes" once met
  std::string links_key_;  // "links", or "edges" where there are no links
  NodeIds ids_;
  GraphMap map_;
  std::vector<Edge> edges_;
  std::vector<std::string> names_;  // of the nodes that have one
  bool at_unit_ = false;            // of the key "graph"
};

const char* NodeLinkReader::name_of(Key key) const {
  return key == kWeight && !cost_attribute_.empty() ? cost_attribute_.c_str() : kKeyNames[key];
}

void NodeLinkReader::fail(const std::string& what, const std::string& expected, Key key) const {
  require_shallow_json(text_, source_);
  json item = value_at(text_, section_key_, index_);
  const bool under_key = key != kKeyCount && item.is_object() && item.contains(name_of(key));
  throw Error({.what = what,
               .expected = expected,
               .got = shortened(under_key ? item[name_of(key)] : item),
               .where = fmt::format("{}: {}[{}]", source_, section_key_, index_)});
}

void NodeLinkReader::fail_at_key(const std::string& expected) const {
  require_shallow_json(text_, source_);
  throw Error({.what = "bad value",
               .expected = expected,
               .got = shortened(value_at(text_, section_key_, kNoIndex)),
               .where = fmt::format("{}: {}", source_, section_key_)});
}

NodeLinkReader::Section NodeLinkReader::section_of(const std::string& key) {
  if (links_only_) return key == links_key_ ? Section::kLinks : Section::kOther;
  if (key == "directed") return Section::kDirected;
  if (key == "graph") return Section::kGraph;
  const bool links = key == "links" || (key == "edges" && links_key_ != "links");
  if (key != "nodes" && !links) return Section::kOther;
  if (key == (links ? links_key_ : nodes_key_)) {
    throw Error({.what = fmt::format("the key \"{}\" stands twice", key), .where = source_});
  }
  (links ? links_key_ : nodes_key_) = key;
  if (!links) return Section::kNodes;
  edges_.clear();
  links_read_ = false;
  return Section::kLinks;
}

bool NodeLinkReader::key(std::string& name) {
  if (depth_ == kDocument) {
    section_ = section_of(name);
    section_key_ = std::move(name);
  } else if (depth_ == kArray) {
    at_unit_ = section_ == Section::kGraph && name == "unit";
  } else if (depth_ == kItem && reading_) {
    key_ = static_cast<Key>(std::find(kKeyNames.begin(), kKeyNames.end(), name) - kKeyNames.begin());
    if (!cost_attribute_.empty()) {
      const bool cost = key_ == kWeight || key_ == kCost || key_ == kLength || key_ == kDistance;
      if (cost) key_ = kKeyCount;
      if (section_ == Section::kLinks && name == cost_attribute_) key_ = kWeight;
    }
  }
  return true;
}

bool NodeLinkReader::value(const Field& field, std::string_view text) {
  if (depth_ == kOutside) {
    throw Error({.what = "not a graph in node-link form", .expected = "an object", .where = source_});
  }
  if (depth_ == kDocument && section_ == Section::kDirected) {
    if (field.kind != Field::Kind::kBoolean) fail_at_key("true or false");
    directed_ = field.truth;
  } else if (depth_ == kDocument && (section_ == Section::kNodes || section_ == Section::kLinks)) {
    fail_at_key("an array");
  } else if (depth_ == kArray && at_unit_) {
    map_.places.unit = text;
  } else if (depth_ == kArray && reading_) {
    fail(fmt::format("no key \"{}\"", kKeyNames[section_ == Section::kNodes ? kId : kSource]), "an object with it");
  } else if (depth_ == kItem && reading_ && key_ != kKeyCount) {
    fields_[key_] = field;
    texts_[key_] = text;
  }
  return true;
}

// Goes one level deeper.
void NodeLinkReader::enter() {
  if (++depth_ > kMaxJsonDepth) require_shallow_json(text_, source_);
}

bool NodeLinkReader::start_object(std::size_t) {
  if (depth_ == kDocument && section_ == Section::kGraph) {
    at_unit_ = false;
  } else if (depth_ == kArray && reading_) {
    for (Field& field : fields_) field.kind = Field::Kind::kMissing;
  } else if (depth_ != kOutside) {
    value({.kind = Field::Kind::kOther});
  }
  enter();
  return true;
}

bool NodeLinkReader::end_object() {
  if (--depth_ != kArray || !reading_) return true;
  if (section_ == Section::kNodes) {
    read_node();
  } else {
    read_link();
  }
  ++index_;
  return true;
}

bool NodeLinkReader::start_array(std::size_t) {
  const bool items = depth_ == kDocument && (section_ == Section::kNodes || section_ == Section::kLinks);
  if (!items) value({.kind = Field::Kind::kOther});
  if (items) {
    reading_ = section_ == Section::kNodes || nodes_read_;
    index_ = 0;
  }
  enter();
  return true;
}

bool NodeLinkReader::end_array() {
  if (--depth_ != kDocument || !reading_) return true;
  (section_ == Section::kNodes ? nodes_read_ : links_read_) = true;
  reading_ = false;
  return true;
}

// The first of them where none is given.
Key NodeLinkReader::first_given(std::initializer_list<Key> keys) const {
  const auto* const found = std::find_if(keys.begin(), keys.end(), [&](Key key) { return fields_[key].given(); });
  return found == keys.end() ? *keys.begin() : *found;
}

NodeId NodeLinkReader::node_at(Key key) const {
  const Field& field = fields_[key];
  if (!field.given()) fail(fmt::format("no key \"{}\"", kKeyNames[key]), "an object with it");
  if (!field.is_id()) fail(fmt::format("bad \"{}\"", kKeyNames[key]), "a text or a whole number", key);
  const NodeId node = field.kind == Field::Kind::kWhole ? ids_.find(field.whole) : ids_.find(texts_[key]);
  if (node == kNoNode) fail(fmt::format("\"{}\" is no node", kKeyNames[key]), "the id of a node", key);
  return node;
}

// A cost or a prize; 1 unless given.
double NodeLinkReader::number_at(Key key) const {
  const Field& field = fields_[key];
  if (!field.given()) return 1;
  if (!field.is_number() || !(field.number >= 0)) {
    fail(fmt::format("bad \"{}\"", name_of(key)), "a number from 0 up", key);
  }
  return field.number + 0.0;  // turns -0 into 0
}

void NodeLinkReader::read_node() {
  const Field& id = fields_[kId];
  if (!id.given()) fail("no key \"id\"", "an object with it");
  if (!id.is_id()) fail("bad \"id\"", "a text or a whole number", kId);
  const bool fresh = id.kind == Field::Kind::kWhole ? ids_.add(id.whole) : ids_.add(texts_[kId]);
  if (!fresh) fail("an id used twice", "ids all different");
  const Field& blocked = fields_[kBlocked];
  if (blocked.given() && blocked.kind != Field::Kind::kBoolean) fail("bad \"blocked\"", "true or false", kBlocked);
  map_.blocked.push_back(blocked.given() && blocked.truth);
  const Key x = first_given({kX, kLon, kLongitude});
  const Field& y = fields_[first_given({kY, kLat, kLatitude})];
  if (fields_[x].is_number() && y.is_number()) {
    map_.places.points.push_back({fields_[x].number, y.number});
    if (x != kX) map_.places.unit = "degrees";
  }
  const Key name = first_given({kLabel, kName});
  if (fields_[name].kind == Field::Kind::kText) names_.push_back(texts_[name]);
  const double prize = number_at(first_given({kPrize, kScore}));
  if (prize == 1 && map_.prizes.empty()) return;
  map_.prizes.resize(map_.blocked.size(), 1.0);
  map_.prizes.back() = prize;
}

void NodeLinkReader::read_link() {
  const NodeId source = node_at(kSource);
  const Key cost = first_given({kWeight, kCost, kLength, kDistance});
  cost_attribute_met_ = cost_attribute_met_ || fields_[cost].given();
  edges_.push_back({source, node_at(kTarget), number_at(cost)});
}

GraphMap NodeLinkReader::read() {
  json::sax_parse(text_, this);
  if (!nodes_read_) throw Error({.what = "no key \"nodes\"", .where = source_});
  if (std::find(map_.blocked.begin(), map_.blocked.end(), false) == map_.blocked.end()) {
    throw Error({.what = "the graph has no free node", .where = source_});
  }
  if (links_key_.empty()) throw Error({.what = "no key \"links\"", .where = source_});
  if (!links_read_) {
    links_only_ = true;
    json::sax_parse(text_, this);
  }
  map_.graph = Graph::from_edges(ids_.count(), edges_, directed_ ? EdgeKind::kDirected : EdgeKind::kUndirected);
  if (!cost_attribute_.empty() && !cost_attribute_met_) {
    throw Error({.what = "no edge has this attribute", .got = in_quotes(cost_attribute_), .where = source_});
  }
  map_.labels = labels_if_unique(std::move(names_), ids_.count());
  if (map_.labels.empty()) map_.labels = ids_.take_labels();
  if (map_.places.points.size() != map_.blocked.size()) map_.places = {};
  return std::move(map_);
}

void append_text(std::string& text, const std::string& value) {
  text += json(value).dump(-1, ' ', false, json::error_handler_t::replace);
}

}  // namespace

GraphMap parse_node_link(std::string_view text, const std::string& source, const MapOptions& options) {
  return NodeLinkReader(text, source, options).read();
}

std::string format_node_link(const GraphMap& map) {
  return format_node_link(map.graph, map.blocked, map.labels, map.prizes, map.places);
}

std::string format_node_link(const Graph& graph, const std::vector<bool>& blocked, std::span<const std::string> labels,
                             std::span<const double> prizes, const Places& places) {
  std::string text;
  const auto append_id = [&](NodeId node) {
    if (labels.empty()) {
      text += fmt::format_int(node).c_str();
    } else {
      append_text(text, labels[node]);
    }
  };
  const std::string unit = places.unit.empty() ? "" : R"("unit":)" + json(places.unit).dump();
  text += fmt::format(R"({{"directed":{},"multigraph":false,"graph":{{{}}},"nodes":[)", graph.directed(), unit);
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
  bool first = true;
  for (NodeId node = 0; node < graph.node_count(); ++node) {
    for (int i = 0; i < graph.degree(node); ++i) {
      const NodeId next = graph.neighbours(node)[i];
      if (!graph.directed() && next < node) continue;  // stands with the other node
      text += first ? R"({"source":)" : R"(,{"source":)";
      first = false;
      append_id(node);
      text += R"(,"target":)";
      append_id(next);
      if (graph.weighted()) text += R"(,"weight":)" + json(graph.cost(node, i)).dump();
      text += '}';
    }
  }
  text += "]}\n";
  return text;
}

}  // namespace graphdrl
