#include "graphdrl/io/map_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "graphdrl/base/error.h"
#include "graphdrl/io/file.h"
#include "graphdrl/io/picture.h"
#include "graphdrl/io/readers.h"

namespace graphdrl {
namespace {

constexpr std::string_view kPaperLetters = "abcdefghij";

void refuse_option(const char* option, const std::string& what, const std::string& source) {
  throw Error({.what = fmt::format("{} goes with {}", option, what), .where = source});
}

// Robot, cells and neighbours, as the options say.
void shape_grid(GridMap& map, const MapOptions& options, const std::string& source) {
  const double side = map.frame ? map.frame->cell_size : 1;
  const std::string unit = map.frame ? map.frame->unit : "cells";
  const double free_before = static_cast<double>(map.free_count()) * side * side;
  double scale = 1;
  if (options.cell_size) {
    if (!map.frame) refuse_option("--cell-size", "maps that say how large their cells are", source);
    scale = *options.cell_size / side;
    const double most = std::min(map.rows, map.cols);
    if (!(scale >= 1 - 1e-9 && scale <= most)) {
      throw Error({.what = "bad cell size",
                   .expected = fmt::format("{:g} to {:g} {}", side, side * most, unit),
                   .got = fmt::format("{:g}", *options.cell_size),
                   .where = source});
    }
    scale = std::max(1.0, scale);
  }
  if (options.robot_radius > 0) map = with_obstacles_grown(std::move(map), options.robot_radius / side);
  const std::int64_t cells_before = map.free_count();
  if (scale > 1) map = coarsened(map, scale);
  map.diagonals = options.diagonals;
  map.cut_corners = options.cut_corners;
  const double free_after = static_cast<double>(map.free_count()) * side * side * scale * scale;
  if (free_after == 0) {
    throw Error({.what = "no cell is left free",
                 .expected = "a smaller robot or smaller cells",
                 .got = fmt::format("{} free cells of {:g} {}", cells_before, side, unit),
                 .where = source});
  }
  if (free_after >= free_before || !options.note) return;
  options.note(fmt::format("{}: {:.4g} of {:.4g} square {} of free ground, {:.1f} %, became blocked", source,
                           free_before - free_after, free_before, unit, 100 * (1 - free_after / free_before)));
}

void shape_map(AnyMap& map, const MapOptions& options, const std::string& source) {
  if (auto* const grid = std::get_if<GridMap>(&map)) return shape_grid(*grid, options, source);
  if (options.cell_size) refuse_option("--cell-size", "grids", source);
  if (options.robot_radius > 0) refuse_option("--robot-radius", "grids", source);
  if (options.diagonals) refuse_option("--connectivity", "grids", source);
}

void check_options(const MapFormat& format, const MapOptions& options, const std::string& source) {
  using enum MapFormat::Option;
  const auto refuse = [&](MapFormat::Option option, bool given, const char* name, const char* what) {
    if (given && (format.options & option) == 0) refuse_option(name, what, source);
  };
  refuse(kCostAttribute, !options.cost_attribute.empty(), "--cost-attribute", "graphs whose edges have attributes");
  refuse(kPrizeAttribute, !options.prize_attribute.empty(), "--prize-attribute", "graphs whose nodes have attributes");
  refuse(kDirected, options.directed, "--directed", "edge lists and TGF: other formats say it themselves");
  refuse(kCellPixels, options.cell_pixels != 1, "--cell-pixels", "pictures");
  refuse(kUnknown, options.unknown_is_free, "--unknown", "ROS maps");
}

NamedMap file_map(const std::filesystem::path& path, const MapOptions& options) {
  const std::string source = path.string();
  std::string bytes = read_file(path);
  const std::size_t file_bytes = bytes.size();
  const std::string text = map_text(std::move(bytes), source, options.note);
  const MapFormat& format = format_of(text);
  check_options(format, options, source);
  const std::filesystem::path name = path.extension() == ".gz" ? path.stem() : path;
  NamedMap named{escaped(name.stem().string()), format.read(text, source, options)};
  shape_map(named.map, options, source);
  const auto* const grid = std::get_if<GridMap>(&named.map);
  // The picture of a ROS map is a file of its own, whose reader checks it.
  if (grid != nullptr && format.name != "ros")
    check_cells(static_cast<double>(grid->blocked.size()), file_bytes, source);
  return named;
}

NamedMap paper_map(char letter, const MapOptions& options) {
  const std::string name = std::string("paper:") + letter;
  NamedMap named{name, parse_ascii_map(paper_map_text(letter), name)};
  check_options(format_of("."), options, name);
  shape_map(named.map, options, name);
  return named;
}

std::vector<std::string> files_of(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  std::error_code error;
  for (std::filesystem::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    std::error_code unknown;
    if (!entry->is_regular_file(unknown) || entry->path().filename().string().starts_with('.')) continue;
    files.push_back(entry->path());
  }
  if (error) throw Error({.what = "cannot read the folder (" + error.message() + ")", .where = folder.string()});
  if (files.empty()) throw Error({.what = "no map files in the folder", .where = folder.string()});
  std::sort(files.begin(), files.end());
  // The picture of a ROS map is no map of its own.
  const std::set<std::filesystem::path> all(files.begin(), files.end());
  std::erase_if(files, [&](std::filesystem::path file) {
    return (file.extension() == ".pgm" || file.extension() == ".png") && all.contains(file.replace_extension(".yaml"));
  });
  return {files.begin(), files.end()};
}

NamedMap one_map(const std::string& source, const MapOptions& options) {
  if (source.starts_with("paper:")) {
    const std::string_view letter = std::string_view(source).substr(6);
    if (letter.size() != 1 || kPaperLetters.find(letter) == std::string_view::npos) {
      throw Error({.what = "no such map", .expected = "paper:a to paper:j", .got = in_quotes(source)});
    }
    return paper_map(letter.front(), options);
  }
  std::error_code error;
  if (std::filesystem::exists(source, error)) return file_map(source, options);
  throw Error({.what = "no such map",
               .expected = "paper, paper:a to paper:j, a file or a folder of files",
               .got = in_quotes(source, 200)});
}

}  // namespace

std::vector<std::string> map_sources(const std::string& source) {
  std::vector<std::string> sources;
  std::error_code error;
  if (source == "paper") {
    for (const char letter : kPaperLetters) sources.push_back(std::string("paper:") + letter);
  } else if (std::filesystem::is_directory(source, error)) {
    sources = files_of(source);
  } else {
    sources.push_back(source);
  }
  return sources;
}

std::vector<NamedMap> load_maps(const std::string& source, const MapOptions& options) {
  std::vector<NamedMap> maps;
  for (const std::string& one : map_sources(source)) maps.push_back(one_map(one, options));
  return maps;
}

NamedMap load_map(const std::string& source, const MapOptions& options) {
  std::vector<NamedMap> maps = load_maps(source, options);
  if (maps.size() != 1) {
    throw Error(
        {.what = "more than one map", .expected = "one map", .got = std::to_string(maps.size()), .where = source});
  }
  return std::move(maps.front());
}

}  // namespace graphdrl
