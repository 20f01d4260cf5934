#include "graphdrl/report/live_files.h"

#include <algorithm>
#include <array>
#include <filesystem>

#include "graphdrl/io/file.h"
#include "graphdrl/io/file_check.h"
#include "graphdrl/io/map_formats.h"
#include "graphdrl/report/plan_files.h"

namespace graphdrl {
namespace {

bool holds_a_map(const std::string& file) {
  const std::string ending = std::filesystem::path(file).extension().string();
  constexpr std::array kEndings = {".graphml", ".dot", ".json", ".gml", ".pgm", ".map", ".txt"};
  return std::ranges::find(kEndings, ending) != kEndings.end();
}

}  // namespace

void check_live_file(const std::string& file) {
  if (holds_a_map(file)) return check_writable(file);
  check_plan_file(file);
}

void write_live(const LiveExploration& exploration, const std::string& file) {
  if (holds_a_map(file)) return write_file(file, format_map(exploration.map(), file));
  write_plan(exploration.answer("live"), file);
}

}  // namespace graphdrl
