// Unknown maps: what becomes known of a world while a walk explores it.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "graphdrl/base/random.h"
#include "graphdrl/env/world.h"
#include "graphdrl/graph/node_set.h"
#include "graphdrl/graph/search.h"

namespace graphdrl {

// What a visit shows.
class Reveal {
 public:
  enum class Kind {
    kAll,     // the map is known beforehand
    kEdges,   // the edges that lead on from the node, and their ends: the fixed graph scenario [Kalyanasundaram and
              // Pruhs 1994]
    kRadius,  // all within a cost; of a node seen it shows whether more edges lead on
    kSight,   // on grids: what straight lines of a length meet, up to the first obstacle
  };

  // "all", "edges", "radius:R" or "sight:R". Throws Error on anything else, and unless R > 0.
  static Reveal parse(std::string_view text);

  Kind kind() const { return kind_; }
  bool all() const { return kind_ == Kind::kAll; }
  double range() const { return range_; }  // of a radius in units of cost, of sight in the map's unit; may be infinite
  std::string text() const;

 private:
  Kind kind_ = Kind::kAll;
  double range_ = 0;
};

// What is counted.
enum class Score {
  kVisited,  // nodes entered
  kSeen,     // nodes that visits showed
};

// "visited" or "seen". Throws Error on anything else.
Score parse_score(std::string_view text);

// What is worth something the first time.
enum class Cover {
  kNodes,  // a node's visit
  kEdges,  // an edge walked whole: a transition of a state machine
};

// "nodes" or "edges". Throws Error on anything else.
Cover parse_cover(std::string_view text);

// An old map of a world, which may have changed since.
struct BelievedMap {
  World world;
  std::vector<NodeId> node_of;  // [N of the world as it is], the node of the same name; kNoNode where there is none
};

// Pairs nodes by name: cells by place, others by label, or number where a map has no labels. Throws Error where the
// maps are not of one kind, cells of another size among them, and where no name is in both.
std::shared_ptr<const BelievedMap> believe(const World& old, const World& world);

// A graph that grows by what it is told. It numbers nodes in the order in which they are seen.
class Discovery {
 public:
  // name: of the world, for messages. ordered: see Known.
  Discovery(std::string name, EdgeKind kind, bool ordered = false);
  Discovery(const Discovery& other);  // grows on its own, and has a view of its own
  Discovery& operator=(const Discovery&) = delete;

  const View& view() const { return view_; }

  struct Seen {
    double prize = 1;                        // of its first visit
    std::optional<NodeId> believed_as = {};  // its node in an old map, kNoNode where that has none
    std::optional<Point> place = {};
  };
  // A new node is seen, on the frontier. REQUIRES: all nodes have a place, or none has; likewise a node of an old map.
  NodeId see(const Seen& seen);
  NodeId see() { return see(Seen()); }
  // Makes an edge between nodes seen known; does nothing where it is. Frontier nodes at its ends are seen again.
  // places: as Graph::add_edge().
  void connect(const Edge& edge, const Graph::Places& places = {});
  // An edge between two nodes is there no more; of many at once the costs kept are looked up once.
  void disconnect(NodeId from, NodeId to);
  void disconnect(std::span<const std::pair<NodeId, NodeId>> edges);
  // All edges of the node are known now: it is no frontier any more.
  void close(NodeId node);
  // What was seen turned out to be a node that was known before: the node, which must have no edges any more, is worth
  // nothing, and no frontier.
  void forget(NodeId node);
  // A node that was forgotten is there again, on the frontier. REQUIRES: no node has a prize of its own.
  void see_again(NodeId node);
  // What is shown from here on is a later visit's.
  void begin_visit() { ++known_->version; }

  // The cost from each node to one of them, kNoLimit where no way is known: [N], kept up to date from then on.
  std::shared_ptr<const std::vector<double>> keep_costs_to(NodeId end);
  std::shared_ptr<const std::vector<double>> costs_kept() const { return to_end_; }  // null where none are

 private:
  void count(NodeId node);
  void leave_frontier(NodeId node);
  void shorten(NodeId from, double cost);
  bool remove(NodeId from, NodeId to);
  void lengthen(NodeId from);

  std::shared_ptr<Known> known_;
  View view_;
  NodeId end_ = kNoNode;                         // of the costs kept
  std::shared_ptr<std::vector<double>> to_end_;  // null until it is asked for
};

// A world of which a walk sees no more than its visits show. Nodes have two numbers: the world's, and the one by which
// the walk knows them.
//
// A node seen shows its prize and, where the world has places, its place. Nothing else of the world gets through: where
// nodes have no cells, those that a visit shows for the first time are numbered in random order.
class HiddenWorld {
 public:
  // Begins at a node of the world, which it visits. Throws Error on a reveal that the world does not have: sight
  // without cells. seed: of the numbers of nodes. believed: null without an old map.
  HiddenWorld(const World& world, const Reveal& reveal, Score score, NodeId start, std::uint64_t seed,
              std::shared_ptr<const BelievedMap> believed = nullptr);

  const Discovery& discovery() const { return discovery_; }
  Discovery& discovery() { return discovery_; }
  const View& view() const { return discovery_.view(); }

  // A node is entered, and shows what it shows. Cost: what it shows.
  void visit(NodeId node);

  // What first visits walk through: nodes visited; where what is seen counts, those whose edges are all known, too.
  const NodeSet& ground() const { return ground_; }

  NodeId in_world(NodeId node) const { return in_world_[node]; }
  NodeId known_as(NodeId in_world) const { return known_as_[in_world]; }  // kNoNode: not seen yet

 private:
  NodeId see(NodeId in_world);
  void connect(NodeId from, int place);
  void close(NodeId node);
  void show_edges(NodeId node);
  void show_radius(NodeId node);
  void show_sight(NodeId node);
  void show_cells(std::vector<NodeId> cells);

  World world_;
  Reveal reveal_;
  Score score_;
  Rng rng_;
  std::shared_ptr<const BelievedMap> believed_;
  Discovery discovery_;
  std::vector<NodeId> in_world_;  // [seen]
  std::vector<NodeId> known_as_;  // [N of the world]
  std::vector<bool> seen_cells_;  // [cells], obstacles too; of sight
  std::vector<Cell> rays_;        // of sight: where lines end, from the position
  NodeSet ground_;
  NearestFirst search_;
};

}  // namespace graphdrl
