// The file formats of maps.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <variant>

#include "graphdrl/graph/grid_map.h"
#include "graphdrl/io/map_options.h"
#include "graphdrl/io/node_link.h"

namespace graphdrl {

// A map as its file holds it.
using AnyMap = std::variant<GridMap, GraphMap>;

struct MapFormat {
  std::string_view name;
  std::string_view ending;   // of files that it writes: ".txt"
  std::string_view purpose;  // one line
  bool (*recognise)(std::string_view text);
  AnyMap (*read)(std::string_view text, const std::string& source, const MapOptions& options);  // throws Error
  std::string (*write_grid)(const GridMap& map) = nullptr;    // null where it holds no grids
  std::string (*write_graph)(const GraphMap& map) = nullptr;  // null where it does not hold all of a graph
  // Which options have a meaning here.
  bool takes_cost_attribute = false;
  bool takes_prize_attribute = false;
  bool takes_cell_pixels = false;
  bool takes_unknown = false;
  bool takes_directed = false;
};

// In the order in which they are tried.
std::span<const MapFormat> map_formats();

// The first format that knows a text as its own; the last one, ASCII maps, takes any.
const MapFormat& format_of(std::string_view text);

// A map in a format that can be written, known by the ending of `file`; a grid as a graph where the format holds no
// grids. Throws Error where there is none, or where it holds grids only and this is a graph.
std::string format_map(const AnyMap& map, const std::string& file);

// The map as a graph, with the places of its cells where it is a grid with a frame.
GraphMap as_graph(const AnyMap& map);

}  // namespace graphdrl
