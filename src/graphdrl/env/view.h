// What is known of a world: all that policies and planners may see of it.
#pragma once

#include "graphdrl/env/world.h"

namespace graphdrl {

// Of a known map that is all there is to know, at no cost. Policies, planners, bounds and features stand on this side
// of the border; episodes, which know the truth, on the other. A handle, as World is.
class View {
 public:
  View(World world) : world_(std::move(world)) {}  // NOLINT(google-explicit-constructor): a known map is its own view

  const std::string& name() const { return world_.name(); }
  NodeId node_count() const { return world_.node_count(); }
  std::span<const NodeId> valid_nodes() const { return world_.valid_nodes(); }  // ascending
  int valid_count() const { return world_.valid_count(); }
  bool is_blocked(NodeId node) const { return world_.is_blocked(node); }

  bool has_prizes() const { return world_.has_prizes(); }
  double prize(NodeId node) const { return world_.prize(node); }
  double total_prize() const { return world_.total_prize(); }

  // What can be walked, the same turned round, and the same with every edge leading both ways.
  const Graph& open() const { return world_.open(); }
  const Graph& into() const { return world_.into(); }
  const Graph& both_ways() const { return world_.both_ways(); }
  std::span<const NodeId> open_neighbours(NodeId node) const { return world_.open_neighbours(node); }
  double spending_limit(double budget) const { return world_.spending_limit(budget); }

  // Of grids: the cells, the graph with its obstacles, and where a direction leads (the node itself where blocked).
  bool is_grid() const { return world_.is_grid(); }
  const GridMap& map() const { return *world_.map(); }
  const Graph& graph() const { return world_.graph(); }
  NodeId direction_target(NodeId node, int direction) const { return world_.direction_target(node, direction); }

  friend bool operator==(const View& one, const View& other) { return one.world_ == other.world_; }

 private:
  World world_;
};

}  // namespace graphdrl
