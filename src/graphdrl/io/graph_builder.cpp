#include "graphdrl/io/graph_builder.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <unordered_set>

#include "graphdrl/base/error.h"
#include "graphdrl/io/text.h"

namespace graphdrl {
namespace {

constexpr std::array<std::string_view, 4> kCostNames = {"weight", "cost", "length", "distance"};
constexpr std::array<std::string_view, 2> kPrizeNames = {"prize", "score"};
constexpr std::array<std::string_view, 2> kLabelNames = {"label", "name"};
constexpr std::array<std::string_view, 3> kXNames = {"x", "lon", "longitude"};
constexpr std::array<std::string_view, 3> kYNames = {"y", "lat", "latitude"};

constexpr std::size_t kNamesShown = 8;  // of attributes, in an error's message

char lower(char c) {
  return static_cast<char>(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
}

// The place of a name among names; behind the last where it is none of them.
int rank_of(std::string_view name, std::span<const std::string_view> names) {
  const auto found =
      std::find_if(names.begin(), names.end(), [&](std::string_view one) { return same_name(name, one); });
  return static_cast<int>(found - names.begin());
}

}  // namespace

std::span<const std::string_view> cost_names() {
  return kCostNames;
}

std::span<const std::string_view> prize_names() {
  return kPrizeNames;
}

std::span<const std::string_view> label_names() {
  return kLabelNames;
}

std::span<const std::string_view> x_names() {
  return kXNames;
}

std::span<const std::string_view> y_names() {
  return kYNames;
}

std::int64_t most_nodes_of(std::string_view text) {
  constexpr std::int64_t kWithoutEdges = 1000;
  return std::min<std::int64_t>(std::ssize(text) + kWithoutEdges, std::numeric_limits<NodeId>::max());
}

std::vector<std::string> labels_if_unique(std::vector<std::string> labels, NodeId count) {
  std::unordered_set<std::string_view> different;
  for (const std::string& label : labels) {
    if (!label.empty()) different.insert(label);
  }
  if (std::ssize(different) != count) labels.clear();
  return labels;
}

bool same_name(std::string_view one, std::string_view other) {
  return std::equal(one.begin(), one.end(), other.begin(), other.end(),
                    [](char a, char b) { return lower(a) == lower(b); });
}

bool is_name_of(std::string_view name, std::span<const std::string_view> names) {
  return rank_of(name, names) < std::ssize(names);
}

NodeId GraphBuilder::add_node(std::string_view id) {
  if (!ids_.add(id)) {
    throw Error({.what = "an id used twice", .expected = "ids all different", .got = in_quotes(id), .where = place_()});
  }
  return ids_.count() - 1;
}

NodeId GraphBuilder::node(std::string_view id) const {
  const NodeId found = ids_.find(id);
  if (found == kNoNode) {
    throw Error({.what = "no such node", .expected = "the id of a node", .got = in_quotes(id), .where = place_()});
  }
  return found;
}

NodeId GraphBuilder::node_or_new(std::string_view id) {
  if (ids_.add(id)) return ids_.count() - 1;
  return ids_.find(id);
}

void GraphBuilder::add_edge(NodeId from, NodeId to, bool one_way) {
  links_.push_back({{from, to, 1}, one_way, static_cast<int>(kCostNames.size())});
  directed_ = directed_ || one_way;
}

double GraphBuilder::number(std::string_view name, std::string_view value, bool may_be_negative) const {
  const std::optional<double> found = parse_number(trimmed(value));
  if (found && (may_be_negative || *found >= 0)) return *found;
  throw Error({.what = fmt::format("bad {}", escaped(name)),
               .expected = may_be_negative ? "a number" : "a number from 0 up",
               .got = in_quotes(value),
               .where = place_()});
}

void GraphBuilder::set_node(NodeId node, std::string_view name, std::string_view value) {
  const bool known = is_name_of(name, kPrizeNames) || is_name_of(name, kLabelNames) || is_name_of(name, kXNames) ||
                     is_name_of(name, kYNames) || same_name(name, "blocked");
  if (!known) return;
  if (std::ssize(nodes_) <= node) nodes_.resize(node + 1);
  Attributes& attributes = nodes_[node];
  if (is_name_of(name, kPrizeNames)) {
    attributes.prize = number(name, value, /*may_be_negative=*/false);
  } else if (is_name_of(name, kLabelNames)) {
    if (attributes.label.empty() || same_name(name, kLabelNames.front())) attributes.label = value;
  } else if (is_name_of(name, kXNames)) {
    attributes.x = number(name, value, /*may_be_negative=*/true);
    attributes.degrees = !same_name(name, kXNames.front());
  } else if (is_name_of(name, kYNames)) {
    attributes.y = number(name, value, /*may_be_negative=*/true);
  } else {
    const std::string_view text = trimmed(value);
    attributes.blocked = same_name(text, "true") || text == "1";
    if (!attributes.blocked && !same_name(text, "false") && text != "0") {
      throw Error({.what = "bad blocked", .expected = "true or false", .got = in_quotes(value), .where = place_()});
    }
  }
}

void GraphBuilder::set_edge(std::string_view name, std::string_view value) {
  Link& link = links_.back();
  if (!cost_attribute_.empty()) {
    if (same_name(name, cost_attribute_)) {
      link.edge.cost = number(name, value, /*may_be_negative=*/false);
      cost_attribute_met_ = true;
    } else if (edge_attributes_.size() < kNamesShown) {
      const std::string met(name);
      if (std::find(edge_attributes_.begin(), edge_attributes_.end(), met) == edge_attributes_.end()) {
        edge_attributes_.push_back(met);
      }
    }
    return;
  }
  const int rank = rank_of(name, kCostNames);
  if (rank >= link.cost_rank) return;
  link.edge.cost = number(name, value, /*may_be_negative=*/false);
  link.cost_rank = rank;
}

void GraphBuilder::check_cost_attribute() const {
  if (cost_attribute_.empty() || cost_attribute_met_) return;
  std::string names;
  for (const std::string& name : edge_attributes_) names += (names.empty() ? "" : ", ") + escaped(name);
  throw Error({.what = "no edge has this attribute",
               .expected = names.empty() ? "edges with attributes" : names,
               .got = in_quotes(cost_attribute_),
               .where = place_()});
}

std::vector<std::string> GraphBuilder::take_labels() {
  std::vector<std::string> labels;
  for (Attributes& node : nodes_) labels.push_back(std::move(node.label));
  labels = labels_if_unique(std::move(labels), ids_.count());
  return labels.empty() ? ids_.take_labels() : labels;
}

void GraphBuilder::take_places(GraphMap& map) const {
  const auto has_place = [](const Attributes& node) { return node.x && node.y; };
  const auto placed = std::count_if(nodes_.begin(), nodes_.end(), has_place);
  if (placed < std::ssize(nodes_)) {
    if (placed > 0 && note_) {
      note_(fmt::format("{}: only {} of {} nodes have coordinates, so none are used", place_(), placed, nodes_.size()));
    }
    return;
  }
  for (const Attributes& node : nodes_) map.places.points.push_back({*node.x, *node.y});
  if (!nodes_.empty() && nodes_.front().degrees) map.places.unit = "degrees";
}

GraphMap GraphBuilder::build() {
  check_cost_attribute();
  const NodeId count = ids_.count();
  nodes_.resize(count);
  std::vector<Edge> edges;
  edges.reserve(links_.size());
  for (const Link& link : links_) {
    edges.push_back(link.edge);
    if (directed_ && !link.one_way) edges.push_back({link.edge.b, link.edge.a, link.edge.cost});
  }
  GraphMap map;
  map.graph = Graph::from_edges(count, edges, directed_ ? EdgeKind::kDirected : EdgeKind::kUndirected);
  bool prizes = false;
  for (const Attributes& node : nodes_) {
    map.blocked.push_back(node.blocked);
    prizes = prizes || node.prize != 1;
  }
  for (const Attributes& node : nodes_) {
    if (prizes) map.prizes.push_back(node.prize);
  }
  if (std::find(map.blocked.begin(), map.blocked.end(), false) == map.blocked.end()) {
    throw Error({.what = "the graph has no free node", .where = place_()});
  }
  take_places(map);
  map.labels = take_labels();
  return map;
}

}  // namespace graphdrl
