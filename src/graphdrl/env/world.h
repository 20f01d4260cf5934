// A graph with its blocked nodes and prizes: the truth that episodes are walked in.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "graphdrl/env/view.h"
#include "graphdrl/graph/given_task.h"
#include "graphdrl/graph/graph.h"
#include "graphdrl/graph/grid_map.h"
#include "graphdrl/io/any_map.h"

namespace graphdrl {

// A handle to an immutable world: copies share it, and it lives as long as any of them. Any number of threads may use
// one. It is all there is to know [Known], with what planners need not know: names, places, what the file asks for.
class World {
 public:
  // A grid: has cells, and directions where it has no diagonals. Throws Error where every cell is blocked.
  World(std::string name, GridMap map);

  // Any graph. Throws Error where every node is blocked, and where prizes add up to more than a number holds.
  // REQUIRES: blocked has a value per node, and so have labels, prizes and places where there are any; prizes are
  // finite and not negative.
  World(std::string name, GraphMap map);
  World(std::string name, Graph graph, std::vector<bool> blocked, std::vector<std::string> labels = {},
        std::vector<double> prizes = {}, GivenTask given = {}, Places places = {});

  // The same the other way round; of a grid, its graph with places where it has a frame.
  GraphMap to_map() const;

  // All of it, known beforehand. A world is used as its own view.
  const View& view() const { return data_->view; }
  operator const View&() const { return data_->view; }  // NOLINT(google-explicit-constructor)

  const std::string& name() const { return view().name(); }
  NodeId node_count() const { return view().node_count(); }
  const std::vector<bool>& blocked() const { return data_->known->blocked; }
  bool is_blocked(NodeId node) const { return view().is_blocked(node); }
  std::span<const NodeId> valid_nodes() const { return view().valid_nodes(); }  // ascending
  int valid_count() const { return view().valid_count(); }
  bool is_grid() const { return view().is_grid(); }
  bool has_cells() const { return data_->known->grid != nullptr; }  // whose steps may lead to eight neighbours
  const GridMap* map() const { return has_cells() ? &view().grid().map() : nullptr; }
  const std::vector<std::string>& labels() const { return data_->labels; }  // what users call the nodes; mostly empty

  bool has_prizes() const { return view().has_prizes(); }
  double prize(NodeId node) const { return view().prize(node); }
  const std::vector<double>& prizes() const { return data_->known->prizes; }
  double total_prize() const { return view().total_prize(); }
  double percent_of_all(double prize) const { return total_prize() > 0 ? 100.0 * prize / total_prize() : 100.0; }

  // Where nodes lie, if that is known: cells do [GridMap::place], other nodes where the file says so.
  bool has_places() const { return has_cells() || !data_->places.points.empty(); }
  Point place(NodeId node) const;   // REQUIRES: has_places()
  const std::string& unit() const;  // of places: "m", "degrees", "cells"; empty where it is not known

  // What the file says of the walk asked for.
  const GivenTask& given() const { return data_->given; }

  // All edges of the file, where graph() leaves some out or they have labels; else null.
  const Multigraph* multigraph() const { return data_->multigraph.get(); }

  // The graph with its blocked nodes, and without their edges: what can be walked.
  const Graph& graph() const;
  const Graph& open() const { return view().open(); }
  const Graph& into() const { return view().into(); }
  const Graph& both_ways() const { return view().both_ways(); }
  std::span<const NodeId> open_neighbours(NodeId node) const { return view().open_neighbours(node); }
  double spending_limit(double budget) const { return view().spending_limit(budget); }

  // Where a direction leads; the node itself where the move is blocked. REQUIRES: is_grid().
  NodeId direction_target(NodeId node, int direction) const { return view().grid().direction_target(node, direction); }

  // Whether both are handles to one world.
  friend bool operator==(const World& one, const World& other) { return one.data_ == other.data_; }

 private:
  struct Data {
    std::shared_ptr<const Known> known;
    View view;
    std::optional<Graph> graph = {};  // with its blocked nodes, where it is no grid and has any
    std::vector<std::string> labels = {};
    GivenTask given = {};
    Places places = {};
    std::shared_ptr<const Multigraph> multigraph = {};
  };

  std::shared_ptr<const Data> data_;
};

}  // namespace graphdrl
