// Pictures: PNG, and the formats of Netpbm (PBM, PGM, PPM).
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

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

// Throws Error where a grid has more cells than a file of so many bytes may hold. Packed, a blank grid takes a
// thousandth of a byte a cell, where a world takes 50 bytes: a tiny file must not ask for gigabytes.
inline constexpr std::int64_t kCellsOfAnyFile = 4096 * 4096;
inline constexpr std::int64_t kCellsPerByte = 256;
void check_cells(double cells, std::size_t file_bytes, const std::string& source);

// PNG, or P1 to P6 of Netpbm; channels as the file has them. Throws Error, naming `source`, on a file that is neither,
// is damaged, holds more than kMostPixels, or more cells of so many pixels a side than check_cells() allows.
Raster read_picture(std::string_view bytes, const std::string& source, double cell_pixels = 1);

// A PNG of 8 bits a sample. channels: 1 grey, 3 colours. samples: [height, width, channels].
std::string format_png(int width, int height, int channels, const void* samples);

}  // namespace graphdrl
