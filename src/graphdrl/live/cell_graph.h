// What a client has told of cells: a grid without borders that is discovered patch by patch.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "graphdrl/env/discovery.h"
#include "graphdrl/graph/grid_map.h"
#include "graphdrl/graph/point.h"

namespace graphdrl {

// Cells of a rectangle, as ROS's nav_msgs/OccupancyGrid and map_msgs/OccupancyGridUpdate tell them. x leads to the
// right, y upward.
struct CellPatch {
  Point origin = {};      // the lower left corner of the lower left cell
  double resolution = 1;  // a side of a cell
  int width = 0;
  int height = 0;
  std::vector<std::int8_t> data = {};  // [height × width], rows from the bottom: -1, or how likely it is blocked, in %
};

// Free cells are nodes of an undirected graph [Discovery] once they are seen. Edges lead to the four or eight cells
// around, and cost what their centres are apart; diagonal ones need both cells beside them to be free. A cell that has
// an unknown one beside it, not diagonally, is at the frontier.
//
// Cells that turn out to be blocked keep their node, which has no edges till they are free again.
class CellGraph {
 public:
  static constexpr int kFree = 25;     // likely to be blocked at most so much
  static constexpr int kBlocked = 65;  // at least; what lies between says nothing, as -1
  // Of the rectangle around all cells known.
  static constexpr std::int64_t kMostCells = std::int64_t{1} << 26;
  // A goal that failed takes with it those so many cells around: they wait, or are given up.
  static constexpr int kFailsAround = 2;
  static constexpr int kMostFailures = 3;  // then a goal is given up

  CellGraph(int connectivity, Score score);  // connectivity: 4 or 8

  const Discovery& discovery() const { return discovery_; }
  Discovery& discovery() { return discovery_; }
  const View& view() const { return discovery_.view(); }
  // Nodes that first visits walk through: cells visited, and where what is seen counts all that are not at the
  // frontier; besides what is blocked, waits or was given up.
  const NodeSet& ground() const { return ground_; }

  // What is wrong with a patch; empty where nothing is.
  std::string fault(const CellPatch& patch) const;
  // What is shown from here on is a later visit's.
  void begin_visit() { changed_now_ = false; }
  // Something changed that policies must know of.
  void change();
  // Takes a patch without fault. Cells of which it says nothing stay as they were.
  void add(const CellPatch& patch);

  // The cell of something that is at a point: the one around it, unless that is blocked; then the nearest one that is
  // free. Empty where none is near, or the point is too far from all that is known. patch: null, or one without fault,
  // as if it had been added. Rows go downward, as a GridMap's.
  std::optional<Cell> standing_at(const Point& point, const CellPatch* patch) const;
  // Something stands in a cell, which is free by that. Gives its node.
  NodeId stand_in(const Cell& cell);
  // A node was walked through, or is stood on.
  void visit(NodeId node);

  const Cell& cell(NodeId node) const { return cells_[node]; }
  Point centre(const Cell& cell) const;
  Point centre(NodeId node) const { return centre(cells_[node]); }
  NodeId node_at(const Point& point) const;  // kNoNode where that is not free
  bool visited(NodeId node) const { return visited_[node]; }
  int visited_count() const { return visited_count_; }
  bool blocked(NodeId node) const { return value(cells_[node]) < 0; }
  int free_count() const { return free_count_; }
  // Nodes to be entered still: free, and at the frontier or, where visits count, not visited.
  int left_count() const;
  std::int64_t changes() const { return changes_; }  // cells that were free and then blocked, or blocked and then free

  // A goal could not be reached: those around it wait.
  void failed(NodeId goal);
  // Whether this very goal has failed kMostFailures times.
  bool given_up(NodeId goal) const;
  // Those that wait can be tried again. False where there are none.
  bool retry();
  struct Failure {
    NodeId goal = kNoNode;
    int failures = 0;
    bool waiting = false;
  };
  // Of goals that were not reached since, by row and column.
  using Failures = std::map<std::pair<int, int>, Failure>;
  const Failures& failures() const { return failures_; }

  // The rectangle around all cells known; those that are not known to be free are blocked.
  GridMap map() const;
  // The same for pictures: with cells beside free ones that are not known as free, and what was ever walked through.
  GridMap picture() const;
  // The cell of such a map.
  NodeId in_map(const Cell& cell) const {
    return (cell.row - first_.row) * (last_.col - first_.col + 1) + cell.col - first_.col;
  }

 private:
  static constexpr int kChunk = 64;  // a side
  static constexpr std::int32_t kUnknownCell = -1;
  static constexpr std::int32_t kBlockedCell = -2;    // and never free
  static constexpr std::int32_t kBlockedNode = -3;    // less the node that it was
  static constexpr std::int32_t kFarthest = 1 << 28;  // of rows and columns
  static constexpr int kStandsAround = 64;            // how far a free cell may be from where something stands

  using Chunk = std::vector<std::int32_t>;  // [kChunk × kChunk]

  struct Grid {
    Point origin;
    double resolution;
    std::optional<Cell> cell_at(const Point& point) const;  // empty where that is too far
  };

  std::int32_t value(const Cell& cell) const;
  std::int32_t& value(const Cell& cell);
  bool is_free(const Cell& cell) const { return value(cell) >= 0; }
  void set_free(const Cell& cell);
  void set_blocked(const Cell& cell);
  void settle(const std::vector<Cell>& changed);
  void connect_around(NodeId node);
  bool joins(const Cell& from, const Cell& step) const;
  bool has_unknown_beside(const Cell& cell) const;
  bool is_left(NodeId node) const;
  // The first failure near a cell that it holds for; null where there is none.
  template <typename Holds>
  const Failure* failure_near(const Cell& cell, const Holds& holds) const;
  bool is_put_off(const Cell& cell) const;
  void settle_ground(NodeId node);
  void settle_ground_around(const Cell& cell);
  // Whether a rectangle with all that is known is small enough.
  bool fits(const Cell& first, const Cell& last) const;
  void reach(const Cell& cell);

  int connectivity_;
  Score score_;
  Discovery discovery_;
  std::optional<Grid> grid_;  // as the first patch says
  std::unordered_map<std::uint64_t, Chunk> chunks_;
  std::vector<Cell> cells_;    // [N]
  std::vector<bool> visited_;  // [N]
  NodeSet ground_;
  Failures failures_;
  int visited_count_ = 0;
  int free_count_ = 0;
  std::int64_t changes_ = 0;
  bool changed_now_ = false;
  Cell first_ = {0, 0};   // the upper left corner of what is known …
  Cell last_ = {-1, -1};  // … and the lower right one; nothing is known while it is left of the first
};

}  // namespace graphdrl
