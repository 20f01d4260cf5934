#include "graphdrl/io/graph_builder.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_set>
#include <utility>

#include "graphdrl/base/error.h"
#include "graphdrl/io/text.h"

namespace graphdrl {
namespace {

constexpr std::string_view kBlockedName = "blocked";
constexpr std::string_view kEdgeLabelName = "label";

constexpr std::int64_t kMostItemsPerByte = 50;  // { a b } -> { c d } stands for four edges
constexpr std::int64_t kFreeAttributes = 4;     // of a node or an edge: these are limited themselves

constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();

// The value of a node in a column that is as long as it must be.
template <typename Value>
auto at(std::vector<Value>& column, NodeId node, Value fallback) -> decltype(column[0]) {
  if (std::ssize(column) <= node) column.resize(static_cast<std::size_t>(node) + 1, fallback);
  return column[node];
}

// left_out: [N], no shorter than the column.
template <typename Value>
void erase_where(std::vector<Value>& column, const std::vector<bool>& left_out) {
  std::size_t node = 0;
  std::erase_if(column, [&](const auto& /*value*/) { return left_out[node++]; });
}

}  // namespace

std::int64_t most_nodes_of(std::string_view text) {
  constexpr std::int64_t kWithoutEdges = 1000;
  return std::min<std::int64_t>(std::ssize(text) + kWithoutEdges, std::numeric_limits<NodeId>::max());
}

std::vector<std::string> labels_from_one(NodeId count) {
  std::vector<std::string> labels;
  for (NodeId node = 1; node <= count; ++node) labels.push_back(std::to_string(node));
  return labels;
}

GraphBuilder::GraphBuilder(const MapOptions& options, std::function<std::string()> place, std::ptrdiff_t text_bytes)
    : costs_(options.cost_attribute, kCostNames),
      prizes_(options.prize_attribute, kPrizeNames),
      edge_prizes_(options.prize_attribute == kNoAttribute ? options.prize_attribute : "", kEdgePrizeNames),
      note_(options.note),
      place_(std::move(place)),
      items_left_(text_bytes < 0 ? std::numeric_limits<std::int64_t>::max() : kMostItemsPerByte * text_bytes) {}

void GraphBuilder::spend(std::int64_t items) {
  items_left_ -= items;
  if (items_left_ >= 0) return;
  throw Error({.what = "far more edges or attributes than a file of this size holds", .where = place_()});
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
  const NodeId found = ids_.find(id);
  return found == kNoNode ? add_node(id) : found;
}

void GraphBuilder::leave_out(NodeId node) {
  at(left_out_, node, false) = true;
}

void GraphBuilder::add_edge(NodeId from, NodeId to, bool one_way) {
  last_ = one_way ? &one_way_ : &both_ways_;
  last_->edges.push_back({from, to, 1});
}

void GraphBuilder::EdgeList::add(const Edge& edge, const EdgeList& other, std::size_t place) {
  const auto here = static_cast<NodeId>(edges.size());
  edges.push_back(edge);
  if (place < other.labels.size()) at(labels, here, std::string()) = other.labels[place];
  if (place < other.prizes.size()) at(prizes, here, 1.0) = other.prizes[place];
}

double GraphBuilder::number(const Attribute& attribute, bool may_be_negative) const {
  const std::optional<double> found = parse_number(trimmed(attribute.value));
  if (found && (may_be_negative || *found >= 0)) return *found;
  throw Error({.what = fmt::format("bad {}", escaped(attribute.name)),
               .expected = may_be_negative ? "a number" : "a number from 0 up",
               .got = in_quotes(attribute.value),
               .where = place_()});
}

bool GraphBuilder::uses_of_node(std::string_view name) const {
  return prizes_.knows(name) || is_name_of(name, kLabelNames) || place_column(name) < kPlaceColumns ||
         same_name(name, kBlockedName);
}

void GraphBuilder::set_node(NodeId node, std::span<const Attribute> attributes) {
  spend(std::max<std::int64_t>(0, std::ssize(attributes) - kFreeAttributes));
  if (const Attribute* const prize = prizes_.best(attributes)) {
    at(prize_, node, 1.0) = number(*prize, /*may_be_negative=*/false);
  }
  for (const Attribute& attribute : attributes) {
    if (const std::size_t rank = rank_of(attribute.name, kLabelNames); rank < kLabelNames.size()) {
      std::string& label = at(label_, node, std::string());
      if (label.empty() || rank == 0) label = attribute.value;
    } else if (const std::size_t column = place_column(attribute.name); column < kPlaceColumns) {
      at(places_[column], node, kMissing) = number(attribute, /*may_be_negative=*/true);
    } else if (same_name(attribute.name, kBlockedName)) {
      const std::string_view text = trimmed(attribute.value);
      const bool yes = same_name(text, "true") || text == "1";
      if (!yes && !same_name(text, "false") && text != "0") {
        throw Error(
            {.what = "bad blocked", .expected = "true or false", .got = in_quotes(attribute.value), .where = place_()});
      }
      at(blocked_, node, false) = yes;
    }
  }
}

void GraphBuilder::set_node(NodeId node, std::string_view name, std::string_view value) {
  const Attribute attribute{std::string(name), std::string(value)};
  set_node(node, {&attribute, 1});
}

void GraphBuilder::set_edge(std::span<const Attribute> attributes) {
  spend(std::max<std::int64_t>(0, std::ssize(attributes) - kFreeAttributes));
  const Attribute* const cost = costs_.best(attributes);
  if (cost != nullptr) last_->edges.back().cost = number(*cost, /*may_be_negative=*/false);
  if (const Attribute* const prize = edge_prizes_.best(attributes)) {
    const auto last = static_cast<NodeId>(last_->edges.size() - 1);
    at(last_->prizes, last, 1.0) = number(*prize, /*may_be_negative=*/false);
  }
  for (const Attribute& attribute : attributes) {
    if (!same_name(attribute.name, kEdgeLabelName) || attribute.value.empty()) continue;
    at(last_->labels, static_cast<NodeId>(last_->edges.size() - 1), std::string()) = attribute.value;
  }
}

void GraphBuilder::set_edge(std::string_view name, std::string_view value) {
  const Attribute attribute{std::string(name), std::string(value)};
  set_edge({&attribute, 1});
}

void GraphBuilder::note(const std::string& text) const {
  if (note_) note_(fmt::format("{}: {}", place_(), text));
}

void GraphBuilder::drop_left_out() {
  if (left_out_.empty()) return;
  const NodeId count = ids_.count();
  left_out_.resize(count);
  std::vector<NodeId> number(count, kNoNode);
  const std::vector<std::string> labels = ids_.take_labels();  // empty: 0 … count - 1
  for (NodeId node = 0; node < count; ++node) {
    if (left_out_[node]) continue;
    number[node] = node_or_new(labels.empty() ? std::to_string(node) : labels[node]);
  }
  for (EdgeList* const list : {&both_ways_, &one_way_}) {
    const EdgeList all = std::exchange(*list, {});
    for (std::size_t i = 0; i < all.edges.size(); ++i) {
      const Edge& edge = all.edges[i];
      if (left_out_[edge.a] || left_out_[edge.b]) continue;
      list->add({number[edge.a], number[edge.b], edge.cost}, all, i);
    }
  }
  if (start_ != kNoNode) start_ = number[start_];
  erase_where(blocked_, left_out_);
  erase_where(prize_, left_out_);
  erase_where(label_, left_out_);
  for (auto& column : places_) erase_where(column, left_out_);
}

std::vector<std::string> GraphBuilder::take_labels() {
  std::unordered_set<std::string_view> different;
  for (const std::string& label : label_) {
    if (!label.empty()) different.insert(label);
  }
  if (std::ssize(different) == ids_.count()) return std::move(label_);
  if (!different.empty()) {
    note(fmt::format("the {} nodes have {} different labels, so ids name them", ids_.count(), different.size()));
  }
  return ids_.take_labels();
}

Places GraphBuilder::take_places() {
  NodeId most = 0;
  for (std::size_t kind = 0; kind < kPlaceNames.size(); ++kind) {
    const std::vector<double>& x = places_[2 * kind];
    const std::vector<double>& y = places_[2 * kind + 1];
    Places places{.points = {}, .unit = unit_.empty() ? std::string(kPlaceNames[kind].unit) : unit_};
    for (std::size_t node = 0; node < std::min(x.size(), y.size()); ++node) {
      if (!std::isnan(x[node]) && !std::isnan(y[node])) places.points.push_back({x[node], y[node]});
    }
    const auto placed = static_cast<NodeId>(places.points.size());
    if (placed == ids_.count()) return places;
    most = std::max(most, placed);
  }
  if (most > 0) note(fmt::format("only {} of {} nodes have coordinates, so none are used", most, ids_.count()));
  return {};
}

// Of a directed graph, those that lead both ways come last.
GraphBuilder::EdgeList GraphBuilder::take_edges() {
  directed_ = directed_ || !one_way_.edges.empty();
  if (!directed_) return std::move(both_ways_);
  one_way_.leading_back = both_ways_.edges.size();
  for (std::size_t i = 0; i < both_ways_.edges.size(); ++i) {
    const Edge& edge = both_ways_.edges[i];
    one_way_.add(edge, both_ways_, i);
  }
  return std::move(one_way_);
}

GraphMap GraphBuilder::build() {
  costs_.check("edge", place_());
  prizes_.check("node", place_());
  drop_left_out();
  const NodeId count = ids_.count();
  blocked_.resize(count);
  if (std::find(blocked_.begin(), blocked_.end(), false) == blocked_.end()) {
    throw Error({.what = "the graph has no free node", .where = place_()});
  }
  for (const AmountNames* const names : {&costs_, &prizes_}) {
    const std::string mixed = names->mixed();
    if (!mixed.empty()) note(fmt::format("{} come from {}", names == &costs_ ? "costs" : "prizes", mixed));
  }
  EdgeList all = take_edges();
  GraphMap map;
  if (!all.labels.empty()) all.labels.resize(all.edges.size());
  if (!all.prizes.empty()) all.prizes.resize(all.edges.size(), 1.0);
  std::vector<bool> both_ways;
  if (all.leading_back > 0) {
    both_ways.resize(all.edges.size());
    std::fill_n(both_ways.rbegin(), all.leading_back, true);
  }
  set_edges(map, count, {std::move(all.edges), std::move(all.labels), std::move(all.prizes), std::move(both_ways)},
            directed_ ? EdgeKind::kDirected : EdgeKind::kUndirected);
  map.blocked = std::move(blocked_);
  if (std::any_of(prize_.begin(), prize_.end(), [](double prize) { return prize != 1; })) {
    prize_.resize(count, 1.0);
    map.prizes = std::move(prize_);
  }
  map.places = take_places();
  map.task.start = start_;
  map.labels = take_labels();
  return map;
}

}  // namespace graphdrl
