// What is known of a world, and a handle to it: all that policies, planners, bounds and features may see.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "graphdrl/graph/graph.h"
#include "graphdrl/graph/grid_map.h"
#include "graphdrl/graph/point.h"

namespace graphdrl {

// A grid as it is known: its cells, and where steps lead.
class KnownGrid {
 public:
  explicit KnownGrid(GridMap map);

  const GridMap& map() const { return map_; }
  // Where one of the four directions leads; the node itself where the move is blocked. REQUIRES: no diagonals.
  NodeId direction_target(NodeId node, int direction) const { return targets_[node][direction]; }
  // The graph with its obstacles as nodes like others. Made when it is first asked for.
  const Graph& graph() const;

 private:
  GridMap map_;
  std::vector<std::array<NodeId, 4>> targets_;  // [N]; empty where the grid has diagonals
  mutable std::once_flag graph_made_;
  mutable Graph graph_;
};

// What has been seen of an unknown map, added up over the nodes whose edges are all known.
struct Census {
  int nodes = 0;
  double degrees = 0;          // sum, whichever way edges lead
  double squared_degrees = 0;  // sum
  double met = 0;              // neighbours counted before, the sum
  int meetings = 0;            // nodes with two of them and more
  int low = 0;                 // nodes of a degree of two at most
  int dead_ends = 0;           // nodes that showed none for the first time
  double pairs = 0;            // of neighbours counted before, the first few of each node …
  double closed_pairs = 0;     // … and those joined by an edge
};

// Of a known map it is immutable once it is made [make_known()]: any number of threads may read it. Of an unknown one
// it grows [Discovery], between the moves of the one walk that explores it: nodes are numbered in the order of their
// discovery and keep their numbers, so that vectors by node only grow.
struct Known {
  std::string name;                 // for messages
  std::uint64_t version = 0;        // 0 for ever of a known map; else one more each time that something becomes known
  Graph open;                       // what can be walked: without the edges of obstacles
  std::vector<bool> blocked;        // [N], known obstacles
  std::vector<double> prizes = {};  // [N], of first visits; empty where each is 1
  std::shared_ptr<const KnownGrid> grid = {};  // null where there are no cells

  // Of an unknown map; empty of a known one:
  std::vector<bool> frontier = {};             // [N], nodes whose edges may not all be known
  std::vector<std::uint32_t> first_seen = {};  // [N], the version in which the node was first seen: visits, counted
  std::vector<std::uint32_t> seen_at = {};     // [N], likewise last
  // [N], the node of the same name in an old map of the world, kNoNode where that has none; empty without an old map.
  std::vector<NodeId> believed_as = {};
  std::vector<Point> places = {};                      // [N], where nodes lie; empty where the world does not say
  std::vector<std::int32_t> frontier_neighbours = {};  // [N], how many, whichever way edges lead
  int frontier_count = 0;
  Census census = {};
  // Frontier nodes in the order in which they were last seen. Some may stand there earlier, too, and some are no
  // frontier any more, but the last is.
  std::vector<NodeId> recent = {};
  // Whether the order of neighbours is shown, as directions are by cells; else it means nothing.
  bool ordered = true;

  // What follows from these, filled in by make_known():
  std::optional<Graph> into = {};        // of directed graphs: edges turned round
  std::optional<Graph> both_ways = {};   // likewise: every edge leads both ways
  std::vector<NodeId> valid_nodes = {};  // that are no obstacles, ascending
  double total_prize = 0;                // of these
};

// Throws Error where every node is blocked. REQUIRES: a value per node in each vector that is not empty; prizes are
// finite and not negative.
std::shared_ptr<const Known> make_known(Known&& known);

// Policies, planners, bounds, features and masks stand on this side of the border; episodes, which know the truth
// [World], on the other. Of a known map both are the same data. Copies share it.
class View {
 public:
  View(std::shared_ptr<const Known> known) : known_(std::move(known)) {}  // NOLINT(google-explicit-constructor)

  const std::string& name() const { return known_->name; }
  std::uint64_t version() const { return known_->version; }
  NodeId node_count() const { return known_->open.node_count(); }
  std::span<const NodeId> valid_nodes() const { return known_->valid_nodes; }  // ascending
  int valid_count() const { return static_cast<int>(known_->valid_nodes.size()); }
  bool is_blocked(NodeId node) const { return known_->blocked[node]; }
  // Whether the map was not known beforehand, and what is known of it grows.
  bool grows() const { return version() > 0; }
  // Whether edges that lead on from a node may be unknown. Never in a known map.
  bool is_frontier(NodeId node) const { return grows() && known_->frontier[node]; }
  // When a node was last seen; later is more. REQUIRES: grows().
  std::uint32_t seen_at(NodeId node) const { return known_->seen_at[node]; }
  std::uint32_t first_seen(NodeId node) const { return known_->first_seen[node]; }
  // As Known's. REQUIRES: there is an old map.
  NodeId believed_as(NodeId node) const { return known_->believed_as[node]; }
  int frontier_neighbours(NodeId node) const { return known_->frontier_neighbours[node]; }
  int frontier_count() const { return known_->frontier_count; }
  const Census& census() const { return known_->census; }
  std::span<const Point> places() const { return known_->places; }  // [N]; empty where not known, and of a known map
  // As Known's.
  bool ordered() const { return known_->ordered; }
  std::span<const NodeId> recent() const { return known_->recent; }

  bool has_prizes() const { return !known_->prizes.empty(); }
  double prize(NodeId node) const { return known_->prizes.empty() ? 1.0 : known_->prizes[node]; }
  double total_prize() const { return known_->total_prize; }  // of the valid nodes

  // What can be walked, the same turned round, and the same with every edge leading both ways.
  const Graph& open() const { return known_->open; }
  const Graph& into() const { return known_->into ? *known_->into : known_->open; }
  const Graph& both_ways() const { return known_->both_ways ? *known_->both_ways : known_->open; }
  std::span<const NodeId> open_neighbours(NodeId node) const { return known_->open.neighbours(node); }

  // What may be spent of a budget in all. Where costs are whole numbers that is the budget; else sums of costs may be
  // off by rounding, so a billionth of it comes on top.
  double spending_limit(double budget) const { return open().integer_costs() ? budget : budget * (1 + 1e-9); }

  // A grid whose steps lead in the paper's four directions.
  bool is_grid() const { return known_->grid && !known_->grid->map().diagonals; }
  const KnownGrid& grid() const { return *known_->grid; }  // REQUIRES: the world has cells

  // Whether both are of one world, of an unknown one in one exploration.
  friend bool operator==(const View& one, const View& other) { return one.known_ == other.known_; }

 protected:
  const Known& known() const { return *known_; }

 private:
  std::shared_ptr<const Known> known_;
};

}  // namespace graphdrl
