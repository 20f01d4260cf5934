// A map as its file holds it, and what users say beside the file.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "graphdrl/graph/graph_map.h"
#include "graphdrl/graph/grid_map.h"

namespace graphdrl {

using AnyMap = std::variant<GridMap, GraphMap>;

// As an attribute's name: every edge costs 1, every first visit is worth 1.
inline constexpr std::string_view kNoAttribute = "none";

struct MapOptions {
  std::string cost_attribute = {};   // the edges' attribute that is their cost; empty: the first of kCostNames
  std::string prize_attribute = {};  // the nodes' attribute that is their prize; empty: the first of kPrizeNames
  bool directed = false;             // of formats that do not say: edges lead one way

  // Of grids.
  int cell_pixels = 1;                   // of pictures: pixels a side of a cell
  bool unknown_is_free = false;          // of ROS maps: cells that nobody has looked at
  double robot_radius = 0;               // obstacles grow by it; in the frame's unit, or in cells
  std::optional<double> cell_size = {};  // a side of the cells wanted, in the frame's unit
  bool diagonals = false;                // eight neighbours
  bool cut_corners = false;              // a diagonal step may have a blocked cell beside it

  // Is told in one line what a user should know, as what was lost by larger cells.
  std::function<void(const std::string&)> note = {};
  // Is told now and then how much of long work is done, 0 to 1; 1 at its end.
  std::function<void(double share)> progress = {};
};

}  // namespace graphdrl
