#include "graphdrl/io/picture.h"

#include <fmt/format.h>
#include <png.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <new>

#include "graphdrl/base/error.h"
#include "graphdrl/io/readers.h"

namespace graphdrl {
namespace {

constexpr std::string_view kPngMagic = "\x89PNG\r\n\x1a\n";
constexpr std::uint8_t kWhite = 255;
constexpr int kHalf = 128;  // darker pixels are blocked

constexpr std::int64_t kPixelsOfAnyPng = 2 * kCellsOfAnyFile;
constexpr std::int64_t kPixelsPerByteOfPng = 2048;  // of real ones, black on white

void check_size(std::int64_t width, std::int64_t height, const std::string& source) {
  if (width > 0 && height > 0 && width <= kMostPixels / height) return;
  throw Error({.what = "the picture has too many pixels",
               .expected = fmt::format("1 to {}", kMostPixels),
               .got = fmt::format("{} x {}", width, height),
               .where = source});
}

// Reads the numbers and samples of a file of Netpbm.
class NetpbmReader {
 public:
  NetpbmReader(std::string_view bytes, const std::string& source) : bytes_(bytes), source_(source) {}

  Raster read() {
    const char kind = bytes_[1];
    const bool plain = kind <= '3';
    const bool bits = kind == '1' || kind == '4';
    const int channels = kind == '3' || kind == '6' ? 3 : 1;
    at_ = 2;
    const double width = number(1e9);
    const double height = number(1e9);
    check_size(static_cast<std::int64_t>(width), static_cast<std::int64_t>(height), source_);
    most_ = bits ? 1 : number(65535);
    if (most_ == 0) fail("a maximum of 0", "1 to 65535");
    Raster picture{
        .width = static_cast<int>(width), .height = static_cast<int>(height), .channels = channels, .samples = {}};
    const std::int64_t samples = std::int64_t{picture.width} * picture.height * channels;
    if (!plain) ++at_;  // one white space
    const std::int64_t row_bytes =
        bits ? (picture.width + 7) / 8 : std::int64_t{picture.width} * channels * (most_ > 255 ? 2 : 1);
    const std::int64_t needed = plain ? samples : row_bytes * picture.height;
    if (std::ssize(bytes_) - static_cast<std::int64_t>(at_) < needed)
      fail("the file ends within the picture", "more bytes");
    picture.samples.reserve(static_cast<std::size_t>(samples));
    for (int row = 0; row < picture.height; ++row) {
      for (int col = 0; col < picture.width * channels; ++col) {
        if (bits && !plain) {
          const auto byte = static_cast<unsigned char>(bytes_[at_ + col / 8]);
          picture.samples.push_back((byte >> (7 - col % 8)) & 1 ? 0 : kWhite);
          continue;
        }
        const double value = sample(plain, bits);
        picture.samples.push_back(static_cast<std::uint8_t>(std::lround(kWhite * (bits ? 1 - value : value / most_))));
      }
      if (bits && !plain) at_ += row_bytes;
    }
    return picture;
  }

 private:
  [[noreturn]] void fail(const std::string& what, const std::string& expected) const {
    throw Error({.what = what, .expected = expected, .where = fmt::format("{}: byte {}", source_, at_)});
  }

  void skip_space() {
    for (; at_ < bytes_.size(); ++at_) {
      if (bytes_[at_] == '#') at_ = std::min(bytes_.find('\n', at_), bytes_.size() - 1);
      if (std::strchr(" \t\r\n\v\f", bytes_[at_]) == nullptr || bytes_[at_] == 0) return;
    }
  }

  double number(double most) {
    skip_space();
    double value = -1;
    for (; at_ < bytes_.size() && bytes_[at_] >= '0' && bytes_[at_] <= '9'; ++at_) {
      value = std::max(value, 0.0) * 10 + (bytes_[at_] - '0');
      if (value > most) break;
    }
    if (value < 0 || value > most) fail("not a number", fmt::format("a whole number up to {:.0f}", most));
    return value;
  }

  // 0 to most_.
  double sample(bool plain, bool bit) {
    if (!plain) {
      const int bytes = most_ > 255 ? 2 : 1;
      int value = 0;
      for (int i = 0; i < bytes; ++i) value = value << 8 | static_cast<unsigned char>(bytes_[at_++]);
      return std::min<double>(value, most_);
    }
    if (!bit) return number(most_);
    skip_space();  // bits may stand without spaces
    if (at_ >= bytes_.size() || (bytes_[at_] != '0' && bytes_[at_] != '1')) fail("not a bit", "0 or 1");
    return bytes_[at_++] - '0';
  }

  std::string_view bytes_;
  const std::string& source_;
  std::size_t at_ = 0;
  double most_ = 1;
};

// Of what libpng says.
bool is_lack_of_memory(std::string_view complaint) {
  return complaint.ends_with("memory");
}

void check_png(double pixels, double cell_pixels, std::size_t file_bytes, const std::string& source) {
  check_cells(pixels / (cell_pixels * cell_pixels), file_bytes, source);
  const auto most = std::max(kPixelsOfAnyPng, kPixelsPerByteOfPng * static_cast<std::int64_t>(file_bytes));
  if (pixels <= static_cast<double>(most)) return;
  throw Error({.what = "a PNG file of more pixels than its size allows",
               .expected = fmt::format("at most {}, or a PGM file", most),
               .got = fmt::format("{:.0f}", pixels),
               .where = source});
}

// Of 8 bits a sample. grey: colours as their brightness, transparent pixels as white.
Raster read_png(std::string_view bytes, const std::string& source, double cell_pixels, bool grey) {
  png_image image = {};
  image.version = PNG_IMAGE_VERSION;
  const auto fail = [&] {
    const std::string complaint = image.message;
    png_image_free(&image);
    if (is_lack_of_memory(complaint)) throw std::bad_alloc();
    throw Error({.what = fmt::format("a PNG file that cannot be read ({})", escaped(complaint)), .where = source});
  };
  if (png_image_begin_read_from_memory(&image, bytes.data(), bytes.size()) == 0) fail();
  const std::int64_t width = image.width;
  const std::int64_t height = image.height;
  try {
    check_size(width, height, source);
    check_png(static_cast<double>(width) * static_cast<double>(height), cell_pixels, bytes.size(), source);
  } catch (const Error&) {
    png_image_free(&image);
    throw;
  }
  image.format = grey ? PNG_FORMAT_GRAY : image.format & (PNG_FORMAT_FLAG_COLOR | PNG_FORMAT_FLAG_ALPHA);
  if (!grey) image.flags |= PNG_IMAGE_FLAG_16BIT_sRGB;  // samples as they are, not as light
  const auto channels = static_cast<int>(PNG_IMAGE_SAMPLE_CHANNELS(image.format));
  Raster picture{
      .width = static_cast<int>(width), .height = static_cast<int>(height), .channels = channels, .samples = {}};
  picture.samples.resize(static_cast<std::size_t>(width) * height * channels);
  const png_color white = {kWhite, kWhite, kWhite};
  if (png_image_finish_read(&image, &white, picture.samples.data(), 0, nullptr) == 0) fail();
  return picture;
}

// Colours as their brightness [ITU-R BT.709].
Raster grey_of(Raster picture) {
  if (picture.channels == 1) return picture;
  std::vector<std::uint8_t> grey;
  grey.reserve(picture.samples.size() / 3);
  for (std::size_t at = 0; at < picture.samples.size(); at += 3) {
    const std::uint8_t* const colour = &picture.samples[at];
    grey.push_back(
        static_cast<std::uint8_t>(std::lround(0.2126 * colour[0] + 0.7152 * colour[1] + 0.0722 * colour[2])));
  }
  return {.width = picture.width, .height = picture.height, .channels = 1, .samples = std::move(grey)};
}

GridMap grid_of(const Raster& picture, int cell_pixels, const std::string& source) {
  GridMap map{.rows = picture.height / cell_pixels, .cols = picture.width / cell_pixels, .blocked = {}};
  if (map.rows == 0 || map.cols == 0) {
    throw Error({.what = "the picture is smaller than a cell",
                 .expected = fmt::format("{0} x {0} pixels or more", cell_pixels),
                 .got = fmt::format("{} x {}", picture.width, picture.height),
                 .where = source});
  }
  map.blocked.resize(static_cast<std::size_t>(map.rows) * map.cols);
  for (int y = 0; y < map.rows * cell_pixels; ++y) {
    for (int x = 0; x < map.cols * cell_pixels; ++x) {
      if (picture.samples[static_cast<std::size_t>(y) * picture.width + x] >= kHalf) continue;
      map.blocked[map.node({y / cell_pixels, x / cell_pixels})] = true;
    }
  }
  if (std::find(map.blocked.begin(), map.blocked.end(), false) == map.blocked.end()) {
    throw Error({.what = "the picture has no free cell", .expected = "cells brighter than half", .where = source});
  }
  return map;
}

std::string pixels_of(const GridMap& map) {
  std::string pixels(map.blocked.size(), static_cast<char>(kWhite));
  for (std::size_t node = 0; node < pixels.size(); ++node) {
    if (map.blocked[node]) pixels[node] = 0;
  }
  return pixels;
}

}  // namespace

bool is_png(std::string_view bytes) {
  return bytes.starts_with(kPngMagic);
}

// An edge list may begin with a node P5; a picture has its sizes below, or all three numbers beside.
bool is_netpbm(std::string_view bytes) {
  if (bytes.size() < 3 || bytes[0] != 'P' || bytes[1] < '1' || bytes[1] > '6') return false;
  if (bytes[2] == '\n' || bytes[2] == '\r' || bytes.substr(2).starts_with(" #")) return true;
  constexpr std::size_t kLongestHeader = 60;
  int numbers = 0;
  for (std::string_view rest = bytes.substr(2, kLongestHeader); rest.starts_with(' ') || rest.starts_with('\t');) {
    rest.remove_prefix(std::min(rest.find_first_not_of(" \t"), rest.size()));
    const std::size_t digits = std::min(rest.find_first_not_of("0123456789"), rest.size());
    if (digits == 0) break;
    rest.remove_prefix(digits);
    ++numbers;
  }
  return numbers >= 3;
}

void check_cells(double cells, std::size_t file_bytes, const std::string& source) {
  const auto most = std::max(kCellsOfAnyFile, kCellsPerByte * static_cast<std::int64_t>(file_bytes));
  if (cells <= static_cast<double>(most)) return;
  throw Error(
      {.what = "a grid of more cells than a file of this size may hold",
       .expected = fmt::format("at most {}: larger ones, by --cell-pixels or --cell-size, or a file that is not "
                               "packed",
                               most),
       .got = fmt::format("{:.0f}", cells),
       .where = source});
}

Raster read_picture(std::string_view bytes, const std::string& source, double cell_pixels) {
  if (is_png(bytes)) return read_png(bytes, source, cell_pixels, /*grey=*/false);
  if (is_netpbm(bytes)) return NetpbmReader(bytes, source).read();
  throw Error({.what = "not a picture", .expected = "PNG, PGM, PBM or PPM", .where = source});
}

GridMap parse_png_map(std::string_view bytes, const std::string& source, const MapOptions& options) {
  return grid_of(read_png(bytes, source, options.cell_pixels, /*grey=*/true), options.cell_pixels, source);
}

GridMap parse_netpbm_map(std::string_view bytes, const std::string& source, const MapOptions& options) {
  return grid_of(grey_of(NetpbmReader(bytes, source).read()), options.cell_pixels, source);
}

std::string format_png(int width, int height, int channels, const void* samples) {
  png_image image = {};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(width);
  image.height = static_cast<png_uint_32>(height);
  image.format = channels == 1 ? PNG_FORMAT_GRAY : PNG_FORMAT_RGB;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(image);
  std::string bytes(size, '\0');
  if (png_image_write_to_memory(&image, bytes.data(), &size, 0, samples, 0, nullptr) == 0) {
    if (is_lack_of_memory(image.message)) throw std::bad_alloc();
    throw Error({.what = fmt::format("the picture cannot be written as PNG ({})", escaped(image.message))});
  }
  bytes.resize(size);
  return bytes;
}

std::string format_png_map(const GridMap& map) {
  return format_png(map.cols, map.rows, 1, pixels_of(map).data());
}

std::string format_pgm_map(const GridMap& map) {
  return fmt::format("P5\n{} {}\n255\n", map.cols, map.rows) + pixels_of(map);
}

}  // namespace graphdrl
