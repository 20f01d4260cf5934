#include "graphdrl/env/discovery.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numbers>
#include <numeric>
#include <queue>
#include <unordered_map>
#include <utility>

#include "graphdrl/base/error.h"
#include "graphdrl/io/text.h"

namespace graphdrl {
namespace {

constexpr int kMostPaired = 5;    // neighbours of a node whose edges among each other are counted
constexpr int kRaysAround = 720;  // of sight, half a degree apart

void shuffle(std::vector<NodeId>& nodes, Rng& rng) {
  for (int left = static_cast<int>(nodes.size()); left > 1; --left) std::swap(nodes[rng.index(left)], nodes[left - 1]);
}

// Where straight lines of a length end, from the cell where they begin. Those that end in the same cell are one.
std::vector<Cell> rays_within(double range, const GridMap& map) {
  const double cells =
      std::min(range / (map.frame ? map.frame->cell_size : 1.0), static_cast<double>(map.rows + map.cols));
  std::vector<Cell> rays;
  for (int ray = 0; ray < kRaysAround; ++ray) {
    const double angle = 2 * std::numbers::pi * ray / kRaysAround;
    const Cell end = {static_cast<int>(std::lround(cells * std::sin(angle))),
                      static_cast<int>(std::lround(cells * std::cos(angle)))};
    if (rays.empty() || end != rays.back()) rays.push_back(end);
  }
  return rays;
}

std::shared_ptr<Known> nothing_known(std::string name, EdgeKind kind, bool ordered) {
  auto known = std::make_shared<Known>();
  known->name = std::move(name);
  known->version = 1;
  known->ordered = ordered;
  known->open = Graph(kind);
  if (kind == EdgeKind::kDirected) {
    known->into = Graph(kind);
    known->both_ways = Graph(EdgeKind::kUndirected);
  }
  return known;
}

}  // namespace

Reveal Reveal::parse(std::string_view text) {
  Reveal reveal;
  const std::size_t colon = std::min(text.find(':'), text.size());
  const std::string_view name = text.substr(0, colon);
  const bool ranged = colon < text.size();
  bool good = true;
  if (name == "all" || name == "edges") {
    reveal.kind_ = name == "all" ? Kind::kAll : Kind::kEdges;
    good = !ranged;
  } else if (name == "radius" || name == "sight") {
    reveal.kind_ = name == "radius" ? Kind::kRadius : Kind::kSight;
    const std::string_view number = ranged ? text.substr(colon + 1) : "";
    const auto [rest, error] = std::from_chars(number.data(), number.data() + number.size(), reveal.range_);
    good = error == std::errc() && rest == number.data() + number.size() && reveal.range_ > 0;
  } else {
    good = false;
  }
  if (good) return reveal;
  throw Error(
      {.what = "bad reveal", .expected = "all, edges, radius:R or sight:R with R above 0", .got = in_quotes(text)});
}

std::string Reveal::text() const {
  switch (kind_) {
    case Kind::kAll:
      return "all";
    case Kind::kEdges:
      return "edges";
    case Kind::kRadius:
      return fmt::format("radius:{}", range_);
    case Kind::kSight:
      break;
  }
  return fmt::format("sight:{}", range_);
}

Score parse_score(std::string_view text) {
  if (text == "visited") return Score::kVisited;
  if (text == "seen") return Score::kSeen;
  throw Error({.what = "bad score", .expected = "visited or seen", .got = in_quotes(text)});
}

Cover parse_cover(std::string_view text) {
  if (text == "nodes") return Cover::kNodes;
  if (text == "edges") return Cover::kEdges;
  throw Error({.what = "bad cover", .expected = "nodes or edges", .got = in_quotes(text)});
}

std::shared_ptr<const BelievedMap> believe(const World& old, const World& world) {
  const auto refuse = [&](const std::string& expected) {
    throw Error({.what = "the believed map is of another kind", .expected = expected, .where = old.name()});
  };
  if (old.has_cells() != world.has_cells()) refuse(world.has_cells() ? "cells" : "a graph");
  if (world.has_cells() && (old.map()->rows != world.map()->rows || old.map()->cols != world.map()->cols)) {
    refuse(fmt::format("{}×{} cells", world.map()->rows, world.map()->cols));
  }
  if (old.open().directed() != world.open().directed()) refuse(world.open().directed() ? "arcs" : "edges both ways");
  if (old.open().is_complete()) refuse("a graph of which some edges are missing");
  std::vector<NodeId> node_of(world.node_count(), kNoNode);
  if (world.has_cells()) {
    std::iota(node_of.begin(), node_of.end(), 0);
  } else {
    const auto name = [](const World& of, NodeId node) {
      return of.labels().empty() ? std::to_string(node) : of.labels()[node];
    };
    std::unordered_map<std::string, NodeId> by_name;
    for (NodeId node = 0; node < old.node_count(); ++node) by_name.emplace(name(old, node), node);
    for (NodeId node = 0; node < world.node_count(); ++node) {
      const auto found = by_name.find(name(world, node));
      if (found != by_name.end()) node_of[node] = found->second;
    }
  }
  if (std::ranges::all_of(node_of, [](NodeId node) { return node == kNoNode; })) {
    throw Error({.what = "the believed map has other nodes", .expected = "the same names", .where = old.name()});
  }
  return std::make_shared<const BelievedMap>(BelievedMap{.world = old, .node_of = std::move(node_of)});
}

Discovery::Discovery(std::string name, EdgeKind kind, bool ordered)
    : known_(nothing_known(std::move(name), kind, ordered)), view_(known_) {}

Discovery::Discovery(const Discovery& other)
    : known_(std::make_shared<Known>(*other.known_)),
      view_(known_),
      end_(other.end_),
      to_end_(other.to_end_ ? std::make_shared<std::vector<double>>(*other.to_end_) : nullptr) {}

NodeId Discovery::see(const Seen& seen) {
  Known& known = *known_;
  const NodeId node = known.open.add_node();
  if (known.into) {
    known.into->add_node();
    known.both_ways->add_node();
  }
  if (known.prizes.empty() && seen.prize != 1) known.prizes.assign(node, 1);
  if (!known.prizes.empty()) known.prizes.push_back(seen.prize);
  known.blocked.push_back(false);
  known.valid_nodes.push_back(node);
  known.total_prize += seen.prize;
  known.frontier.push_back(true);
  known.first_seen.push_back(static_cast<std::uint32_t>(known.version));
  known.seen_at.push_back(static_cast<std::uint32_t>(known.version));
  known.frontier_neighbours.push_back(0);
  if (seen.believed_as) known.believed_as.push_back(*seen.believed_as);
  if (seen.place) known.places.push_back(*seen.place);
  ++known.frontier_count;
  known.recent.push_back(node);
  if (to_end_ != nullptr) to_end_->push_back(kNoLimit);
  return node;
}

void Discovery::connect(const Edge& edge, const Graph::Places& places) {
  Known& known = *known_;
  if (known.open.index_of(edge.a, edge.b) >= 0) return;
  const bool joined = known.into && known.both_ways->index_of(edge.a, edge.b) >= 0;  // by an edge the other way
  known.open.add_edge(edge, places);
  if (known.into) {
    known.into->add_edge({edge.b, edge.a, edge.cost});
    if (!joined) known.both_ways->add_edge({edge.a, edge.b, 1});
  }
  if (!joined) {
    known.frontier_neighbours[edge.a] += known.frontier[edge.b];
    known.frontier_neighbours[edge.b] += known.frontier[edge.a];
  }
  for (const NodeId node : {edge.a, edge.b}) {
    if (!known.frontier[node]) continue;
    known.seen_at[node] = static_cast<std::uint32_t>(known.version);
    if (known.recent.empty() || known.recent.back() != node) known.recent.push_back(node);
  }
  if (to_end_ == nullptr) return;
  shorten(edge.a, (*to_end_)[edge.b] + edge.cost);
  if (!known.open.directed()) shorten(edge.b, (*to_end_)[edge.a] + edge.cost);
}

// Gives whether the edge was on ways to the end.
bool Discovery::remove(NodeId from, NodeId to) {
  Known& known = *known_;
  const double cost = known.open.cost(from, known.open.index_of(from, to));
  known.open.remove_edge(from, to);
  bool apart = true;
  if (known.into) {
    known.into->remove_edge(to, from);
    apart = known.open.index_of(to, from) < 0;
    if (apart) known.both_ways->remove_edge(from, to);
  }
  if (apart) {
    known.frontier_neighbours[from] -= known.frontier[to];
    known.frontier_neighbours[to] -= known.frontier[from];
  }
  if (to_end_ == nullptr) return false;
  const std::vector<double>& costs = *to_end_;
  const auto is_on_way = [&](NodeId a, NodeId b) { return costs[b] < kNoLimit && costs[a] == cost + costs[b]; };
  return is_on_way(from, to) || (!known.open.directed() && is_on_way(to, from));
}

void Discovery::disconnect(NodeId from, NodeId to) {
  if (remove(from, to)) lengthen(from);
}

void Discovery::disconnect(std::span<const std::pair<NodeId, NodeId>> edges) {
  bool any = false;
  for (const auto& [from, to] : edges) any = remove(from, to) || any;
  if (any) *to_end_ = costs_to(view_.into(), end_);
}

// An edge that leaves a node is gone that was on ways to the end.
void Discovery::lengthen(NodeId from) {
  std::vector<double>& costs = *to_end_;
  const Graph& open = known_->open;
  if (!open.directed() || view_.into().degree(from) > 0 || from == end_) {
    costs = costs_to(view_.into(), end_);
    return;
  }
  // Nobody's way leads through it.
  costs[from] = kNoLimit;
  for (int i = 0; i < open.degree(from); ++i) {
    costs[from] = std::min(costs[from], open.cost(from, i) + costs[open.neighbours(from)[i]]);
  }
}

void Discovery::close(NodeId node) {
  if (!known_->frontier[node]) return;
  count(node);
  leave_frontier(node);
}

void Discovery::forget(NodeId node) {
  Known& known = *known_;
  known.total_prize -= view_.prize(node);
  if (!known.prizes.empty()) known.prizes[node] = 0;
  if (known.frontier[node]) leave_frontier(node);
}

void Discovery::see_again(NodeId node) {
  Known& known = *known_;
  known.total_prize += 1;
  known.frontier[node] = true;
  known.seen_at[node] = static_cast<std::uint32_t>(known.version);
  ++known.frontier_count;
  known.recent.push_back(node);
  for (const NodeId next : view_.both_ways().neighbours(node)) ++known.frontier_neighbours[next];
}

void Discovery::leave_frontier(NodeId node) {
  Known& known = *known_;
  known.frontier[node] = false;
  --known.frontier_count;
  for (const NodeId next : view_.both_ways().neighbours(node)) --known.frontier_neighbours[next];
  while (!known.recent.empty() && !known.frontier[known.recent.back()]) known.recent.pop_back();
}

void Discovery::count(NodeId node) {
  const Known& known = *known_;
  Census& census = known_->census;
  const auto neighbours = view_.both_ways().neighbours(node);
  std::array<NodeId, kMostPaired> met{};
  int met_count = 0;
  bool fresh = false;
  for (const NodeId next : neighbours) {
    fresh = fresh || known.first_seen[next] == known.version;
    if (known.frontier[next]) continue;
    if (met_count < kMostPaired) met[met_count] = next;
    ++met_count;
  }
  const auto degree = static_cast<double>(neighbours.size());
  ++census.nodes;
  census.degrees += degree;
  census.squared_degrees += degree * degree;
  census.met += met_count;
  census.meetings += met_count > 1;
  census.low += degree <= 2;
  census.dead_ends += !fresh;
  for (int a = 0; a < std::min(met_count, kMostPaired); ++a) {
    for (int b = 0; b < a; ++b) {
      ++census.pairs;
      census.closed_pairs += view_.both_ways().index_of(met[a], met[b]) >= 0;
    }
  }
}

std::shared_ptr<const std::vector<double>> Discovery::keep_costs_to(NodeId end) {
  end_ = end;
  to_end_ = std::make_shared<std::vector<double>>(costs_to(view_.into(), end));
  return to_end_;
}

// There may be a cheaper way from a node to the end. Dijkstra's algorithm, among those whose way gets cheaper by it.
void Discovery::shorten(NodeId from, double cost) {
  using Reached = std::pair<double, NodeId>;
  std::priority_queue<Reached, std::vector<Reached>, std::greater<>> heap;
  std::vector<double>& costs = *to_end_;
  const auto reach = [&](NodeId node, double cheaper) {
    if (cheaper >= costs[node]) return;
    costs[node] = cheaper;
    heap.emplace(cheaper, node);
  };
  reach(from, cost);
  const Graph& into = view_.into();
  while (!heap.empty()) {
    const auto [here, node] = heap.top();
    heap.pop();
    if (here > costs[node]) continue;
    for (int i = 0; i < into.degree(node); ++i) reach(into.neighbours(node)[i], here + into.cost(node, i));
  }
}

HiddenWorld::HiddenWorld(const World& world, const Reveal& reveal, Score score, NodeId start, std::uint64_t seed,
                         std::shared_ptr<const BelievedMap> believed)
    : world_(world),
      reveal_(reveal),
      score_(score),
      rng_(seed),
      believed_(std::move(believed)),
      discovery_(world.name(), world.open().directed() ? EdgeKind::kDirected : EdgeKind::kUndirected,
                 world.has_cells()),
      known_as_(world.node_count(), kNoNode) {
  if (reveal.kind() == Reveal::Kind::kSight) {
    if (!world.has_cells()) {
      throw Error({.what = "sight needs a map of cells", .got = reveal.text(), .where = world.name()});
    }
    seen_cells_.resize(world.node_count());
    rays_ = rays_within(reveal.range(), *world.map());
  }
  visit(see(start));
}

NodeId HiddenWorld::see(NodeId in_world) {
  NodeId& node = known_as_[in_world];
  if (node != kNoNode) return node;
  Discovery::Seen seen{.prize = world_.prize(in_world)};
  if (believed_) seen.believed_as = believed_->node_of[in_world];
  if (world_.has_places()) seen.place = world_.place(in_world);
  node = discovery_.see(seen);
  in_world_.push_back(in_world);
  ground_.grow(node + 1);
  return node;
}

// Makes the edge to a node's neighbour at a place known. REQUIRES: both ends are seen. In lists of cells neighbours
// keep the order of directions, which cells show.
void HiddenWorld::connect(NodeId from, int place) {
  const Graph& open = world_.open();
  const NodeId to = open.neighbours(from)[place];
  const auto knows = [&](NodeId a, NodeId b) {
    return known_as_[b] != kNoNode && view().open().index_of(known_as_[a], known_as_[b]) >= 0;
  };
  if (knows(from, to)) return;
  Graph::Places places;
  if (world_.has_cells()) {
    const auto place_of = [&](NodeId a, NodeId b) {
      const auto neighbours = open.neighbours(a);
      return static_cast<int>(std::count_if(neighbours.begin(), std::ranges::find(neighbours, b),
                                            [&](NodeId before) { return knows(a, before); }));
    };
    places = {.of_b = place_of(from, to), .of_a = place_of(to, from)};
  }
  discovery_.connect({known_as_[from], known_as_[to], open.cost(from, place)}, places);
}

void HiddenWorld::close(NodeId node) {
  discovery_.close(node);
  if (score_ == Score::kSeen) ground_.insert(node);
}

void HiddenWorld::visit(NodeId node) {
  discovery_.begin_visit();
  ground_.insert(node);
  if (reveal_.kind() == Reveal::Kind::kSight) return show_sight(node);
  show_edges(node);
  if (reveal_.kind() == Reveal::Kind::kRadius) show_radius(node);
}

void HiddenWorld::show_edges(NodeId node) {
  const NodeId here = in_world_[node];
  const auto neighbours = world_.open_neighbours(here);
  std::vector<NodeId> fresh;
  for (const NodeId next : neighbours) {
    if (known_as_[next] == kNoNode) fresh.push_back(next);
  }
  if (!world_.has_cells()) shuffle(fresh, rng_);
  for (const NodeId next : fresh) see(next);
  for (int place = 0; place < std::ssize(neighbours); ++place) connect(here, place);
  close(node);
}

void HiddenWorld::show_radius(NodeId node) {
  const Graph& open = world_.open();
  std::vector<NodeId> near;
  search_.run_cheapest(open, in_world_[node], reveal_.range(), [&](NodeId next, double) {
    near.push_back(next);
    return NearestFirst::Next::kThrough;
  });
  std::vector<NodeId> order = near;
  if (!world_.has_cells()) shuffle(order, rng_);
  for (const NodeId next : order) see(next);
  for (const NodeId next : near) {
    bool whole = true;
    for (int place = 0; place < open.degree(next); ++place) {
      const bool seen = known_as_[open.neighbours(next)[place]] != kNoNode;
      if (seen) connect(next, place);
      whole = whole && seen;
    }
    if (whole) close(known_as_[next]);
  }
}

// Bresenham's lines from the middle of the cell, a point on the circle each, up to the first obstacle or the map's
// edge.
void HiddenWorld::show_sight(NodeId node) {
  const GridMap& map = *world_.map();
  const Cell here = map.cell(in_world_[node]);
  std::vector<NodeId> fresh;
  const auto look_at = [&](const Cell& cell) {
    const NodeId seen = map.node(cell);
    if (!seen_cells_[seen]) {
      seen_cells_[seen] = true;
      fresh.push_back(seen);
    }
    return map.is_free(cell);
  };
  look_at(here);
  for (const auto& [rows, cols] : rays_) {
    const int steps = std::max(std::abs(rows), std::abs(cols));
    for (int step = 1; step <= steps; ++step) {
      const Cell cell = {here.row + static_cast<int>(std::lround(static_cast<double>(rows) * step / steps)),
                         here.col + static_cast<int>(std::lround(static_cast<double>(cols) * step / steps))};
      if (!map.contains(cell) || !look_at(cell)) break;
    }
  }
  // A robot feels the cells around it.
  for (const Cell& step : map.steps()) {
    if (map.contains(here + step)) look_at(here + step);
  }
  show_cells(std::move(fresh));
}

// Cells are seen for the first time. An edge is known once its ends are, and of a diagonal the cells beside it.
void HiddenWorld::show_cells(std::vector<NodeId> cells) {
  const GridMap& map = *world_.map();
  std::sort(cells.begin(), cells.end());
  std::vector<NodeId> touched;  // free cells whose edges may be known now
  for (const NodeId cell : cells) {
    if (!map.blocked[cell]) see(cell);
    for (int row = -1; row <= 1; ++row) {
      for (int col = -1; col <= 1; ++col) {
        const Cell near = map.cell(cell) + Cell{row, col};
        if (map.contains(near) && map.is_free(near) && seen_cells_[map.node(near)]) touched.push_back(map.node(near));
      }
    }
  }
  std::sort(touched.begin(), touched.end());
  touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
  for (const NodeId from : touched) {
    const auto neighbours = world_.open_neighbours(from);
    const Cell at = map.cell(from);
    for (int place = 0; place < std::ssize(neighbours); ++place) {
      const Cell to = map.cell(neighbours[place]);
      const bool seen = seen_cells_[neighbours[place]] && seen_cells_[map.node({at.row, to.col})] &&
                        seen_cells_[map.node({to.row, at.col})];
      if (seen && known_as_[neighbours[place]] != kNoNode) connect(from, place);
    }
    const auto unseen = [&](const Cell& step) { return map.contains(at + step) && !seen_cells_[map.node(at + step)]; };
    if (view().is_frontier(known_as_[from]) && std::ranges::none_of(map.steps(), unseen)) close(known_as_[from]);
  }
}

}  // namespace graphdrl
