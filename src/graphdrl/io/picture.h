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

// PNG, or P1 to P6 of Netpbm; channels as the file has them. Throws Error, naming `source`, on a file that is neither,
// is damaged, or holds more than kMostPixels.
Raster read_picture(std::string_view bytes, const std::string& source);

// A PNG of 8 bits a sample. channels: 1 grey, 3 colours. samples: [height, width, channels].
std::string format_png(int width, int height, int channels, const void* samples);

}  // namespace graphdrl
