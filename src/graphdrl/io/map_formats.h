// The file formats of maps.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "graphdrl/io/any_map.h"

namespace graphdrl {

struct MapFormat {
  // What has a meaning for some formats only.
  enum Option : unsigned {
    kNoOption = 0,
    kCostAttribute = 1,
    kPrizeAttribute = 2,
    kBothAttributes = kCostAttribute | kPrizeAttribute,
    kCellPixels = 4,
    kUnknown = 8,
    kDirected = 16
  };

  std::string_view name;
  std::string_view ending;   // of files that it writes: ".txt"
  std::string_view purpose;  // one line
  bool (*recognise)(std::string_view text);
  AnyMap (*read)(std::string_view text, const std::string& source, const MapOptions& options);  // throws Error
  unsigned options = kNoOption;
  std::string (*write_grid)(const GridMap& map) = nullptr;    // null where it holds no grids
  std::string (*write_graph)(const GraphMap& map) = nullptr;  // null where it does not hold all of a graph
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
