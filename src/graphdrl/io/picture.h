// Grids as pictures: PNG, and the formats of Netpbm (PBM, PGM, PPM).
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "graphdrl/graph/grid_map.h"
#include "graphdrl/io/map_options.h"

namespace graphdrl {

// Row by row from the top; 0 is black, and transparent.
struct Raster {
  int width = 0;
  int height = 0;
  int channels = 1;                   // 1 grey, 2 grey and alpha, 3 red, green, blue, 4 these and alpha
  std::vector<std::uint8_t> samples;  // [height, width, channels]
};

// What a picture may hold at most, so that a small file cannot fill the memory.
inline constexpr std::int64_t kMostPixels = 200'000'000;

bool is_png(std::string_view bytes);
bool is_netpbm(std::string_view bytes);

// PNG, or P1 to P6 of Netpbm; channels as the file has them. Throws Error, naming `source`, on a file that is neither,
// is damaged, or holds more than kMostPixels.
Raster read_picture(std::string_view bytes, const std::string& source);

// A grid: a cell for every options.cell_pixels × options.cell_pixels pixels, blocked where one of them is darker than
// half. Colours count by their brightness; what is transparent is white. Pixels beyond the last whole cell are left
// out. Throws Error where no cell is free, or not one is whole.
GridMap parse_png_map(std::string_view bytes, const std::string& source, const MapOptions& options = {});
GridMap parse_netpbm_map(std::string_view bytes, const std::string& source, const MapOptions& options = {});

// A pixel a cell, black where blocked, white where free.
std::string format_png_map(const GridMap& map);
std::string format_pgm_map(const GridMap& map);

}  // namespace graphdrl
