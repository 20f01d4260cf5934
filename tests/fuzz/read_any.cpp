// A target of libFuzzer for every reader of files: read_any --reader=NAME CORPUS. --reader=list prints the names.
// A reader may throw Error, and nothing else. What it takes becomes a world, and is the same after a round trip.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>

#include "graphdrl/base/error.h"
#include "graphdrl/env/load_worlds.h"
#include "graphdrl/io/map_formats.h"
#include "graphdrl/io/safetensors.h"

namespace {

using namespace graphdrl;

constexpr std::string_view kOption = "--reader=";
constexpr std::string_view kTensors = "safetensors";
constexpr NodeId kMostNodesWritten = 2000;  // larger maps take long to write

const MapFormat* chosen_format = nullptr;  // null: safetensors

[[noreturn]] void fail(const char* what) {
  std::fprintf(stderr, "read_any: %s\n", what);
  std::abort();
}

World world_of(const AnyMap& map) {
  if (const auto* const grid = std::get_if<GridMap>(&map)) return World("grid", *grid);
  const GraphMap& graph = std::get<GraphMap>(map);
  return World("graph", graph.graph, graph.blocked, graph.labels, graph.prizes, graph.task, graph.places);
}

// What is read again is what was written.
void write_and_read(const MapFormat& format, const AnyMap& map, const std::string& text) {
  const AnyMap again = format.read(text, "written", {});
  const GraphMap before = as_graph(map);
  const GraphMap after = as_graph(again);
  if (before.graph.node_count() != after.graph.node_count()) fail("nodes lost on a round trip");
  if (before.graph.edge_count() != after.graph.edge_count()) fail("edges lost on a round trip");
  if (before.blocked != after.blocked) fail("obstacles lost on a round trip");
}

void read_map(const MapFormat& format, std::string_view text) {
  const AnyMap map = format.read(text, "input", {});
  if (as_graph(map).graph.node_count() > kMostNodesWritten) return;
  try {
    world_of(map);
  } catch (const Error&) {
    return;  // every node is blocked
  }
  if (const auto* const grid = std::get_if<GridMap>(&map); grid != nullptr && format.write_grid != nullptr) {
    write_and_read(format, map, format.write_grid(*grid));
  } else if (const auto* const graph = std::get_if<GraphMap>(&map); graph != nullptr && format.write_graph != nullptr) {
    write_and_read(format, map, format.write_graph(*graph));
  }
}

void choose(std::string_view name) {
  if (name == "list") {
    for (const MapFormat& format : map_formats()) std::printf("%s\n", std::string(format.name).c_str());
    std::printf("%s\n", std::string(kTensors).c_str());
    std::exit(0);
  }
  for (const MapFormat& format : map_formats()) {
    if (format.name == name) chosen_format = &format;
  }
  if (chosen_format == nullptr && name != kTensors) fail("no such reader; --reader=list names them");
}

}  // namespace

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  std::string_view name = "list";
  for (int i = 1; i < *argc; ++i) {
    const std::string_view argument = (*argv)[i];
    if (argument.starts_with(kOption)) name = argument.substr(kOption.size());
  }
  choose(name);
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(data, data + size);  // NOLINT(cppcoreguidelines-pro-bounds-pointer-arithmetic)
  try {
    if (chosen_format != nullptr) {
      read_map(*chosen_format, text);
    } else {
      Safetensors::parse(text, "input");
    }
  } catch (const Error&) {
    return 0;
  }
  return 0;
}
