// Grids as pictures: PNG, and the formats of Netpbm (PBM, PGM, PPM).
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "graphdrl/graph/grid_map.h"
#include "graphdrl/io/map_options.h"

namespace graphdrl {

// A picture in shades of grey, 0 is black. Row by row from the top.
struct GreyPicture {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> pixels;  // [width * height]
};

// What a picture may hold at most, so that a small file cannot fill the memory.
inline constexpr std::int64_t kMostPixels = 200'000'000;

bool is_png(std::string_view bytes);
bool is_netpbm(std::string_view bytes);

// Colours as their brightness; what is transparent is white. Throws Error, naming `source`, on a file that is damaged
// or holds more than kMostPixels.
GreyPicture read_png(std::string_view bytes, const std::string& source);

// P1 to P6. Throws Error likewise.
GreyPicture read_netpbm(std::string_view bytes, const std::string& source);

// Of either kind. Throws Error where it is none.
GreyPicture read_picture(std::string_view bytes, const std::string& source);

// A grid: a cell for every options.cell_pixels × options.cell_pixels pixels, blocked where one of them is darker than
// half. Pixels beyond the last whole cell are left out. Throws Error where no cell is free, or not one is whole.
GridMap parse_png_map(std::string_view bytes, const std::string& source, const MapOptions& options = {});
GridMap parse_netpbm_map(std::string_view bytes, const std::string& source, const MapOptions& options = {});

// A pixel a cell, black where blocked, white where free.
std::string format_png_map(const GridMap& map);
std::string format_pgm_map(const GridMap& map);

}  // namespace graphdrl
