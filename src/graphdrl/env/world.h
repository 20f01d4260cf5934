// A graph with its blocked nodes and prizes: the truth that episodes are walked in.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "graphdrl/env/view.h"
#include "graphdrl/graph/graph_map.h"
#include "graphdrl/graph/grid_map.h"

namespace graphdrl {

// A handle to an immutable world: all there is to know, known beforehand, with what policies and planners need not
// know: names, places, what the file asks for. Copies share it; any number of threads may use one.
class World : public View {
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

  const View& view() const { return *this; }  // what policies may see of it
  const std::vector<bool>& blocked() const { return known().blocked; }
  const std::vector<double>& prizes() const { return known().prizes; }
  double percent_of_all(double prize) const { return total_prize() > 0 ? 100.0 * prize / total_prize() : 100.0; }
  bool has_cells() const { return known().grid != nullptr; }  // whose steps may lead to eight neighbours
  const GridMap* map() const { return has_cells() ? &grid().map() : nullptr; }
  const std::vector<std::string>& labels() const { return rest_->labels; }  // what users call the nodes; mostly empty

  // Where nodes lie, if that is known: cells do [GridMap::place], other nodes where the file says so.
  bool has_places() const { return has_cells() || !rest_->places.points.empty(); }
  Point place(NodeId node) const;   // REQUIRES: has_places()
  const std::string& unit() const;  // of places: "m", "degrees", "cells"; empty where it is not known

  // What the file says of the walk asked for.
  const GivenTask& given() const { return rest_->task; }

  // All edges of the file, where graph() leaves some out or they have labels; else null.
  const Multigraph* multigraph() const { return rest_->multigraph.get(); }

  // The graph with its blocked nodes, and without their edges: open(), what can be walked.
  const Graph& graph() const;

 private:
  std::shared_ptr<const GraphMap> rest_;  // what is not known(); its graph where it has blocked nodes
};

}  // namespace graphdrl
