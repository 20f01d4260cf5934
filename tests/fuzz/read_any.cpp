// A target of libFuzzer for every reader of files: read_any --reader=NAME CORPUS. --reader=list prints the names.
// A reader may throw Error, and nothing else. A map that it takes becomes a world, and is the same after a round trip.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "graphdrl/base/error.h"
#include "graphdrl/env/load_worlds.h"
#include "graphdrl/io/map_formats.h"
#include "graphdrl/io/readers.h"
#include "graphdrl/io/safetensors.h"
#include "graphdrl/io/text.h"
#include "graphdrl/live/graph_walker_service.h"
#include "graphdrl/live/session.h"
#include "graphdrl/report/plan_files.h"

namespace {

using namespace graphdrl;

constexpr std::string_view kOption = "--reader=";
constexpr NodeId kMostNodesWritten = 2000;  // larger maps take long to write

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

void read_map(const MapFormat& format, const std::string& text) {
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

// A plan for a small world whose nodes have labels, one of them a number.
void read_plan_text(const std::string& text) {
  static const World world("house", Graph::from_edges(4, std::vector<Edge>{{0, 1}, {1, 2}, {2, 3}}),
                           std::vector<bool>(4), {"hall", "kitchen", "3", "attic"});
  const Answer answer = parse_plan(world, text, "input");
  if (answer.plan.walk.empty()) fail("an empty walk was taken");
  plan_json(answer);
}

// Messages of a live exploration, a line each.
void read_messages(const std::string& text) {
  if (text.find("\"policy\"") != std::string::npos) return;  // some plan for long
  LiveSession session({});
  std::vector<std::string> taken;
  std::vector<std::string> answers;
  LiveSession recorded({}, [&](std::string_view message, std::string_view answer) {
    taken.emplace_back(message);
    answers.emplace_back(answer);
  });
  for (Lines lines(text); lines.next();) {
    const std::string answer = session.answer(lines.line());
    if (answer != recorded.answer(lines.line())) fail("the same messages got other answers");
    if (nlohmann::json::parse(answer).empty()) fail("an empty answer");
  }
  LiveSession replayed({});
  for (std::size_t i = 0; i < taken.size(); ++i) {
    if (!replayed.replay(taken[i], answers[i])) fail("a transcript played again comes out otherwise");
  }
  if (const LiveExploration* const exploration = session.exploration()) {
    live_report_json(exploration->report()).dump();
    std::visit([](auto map) { World("map", std::move(map)); }, exploration->map());
    plan_json(exploration->answer("map"));
  }
}

// GraphWalker's models, walked for a while.
void read_walker_models(const std::string& text) {
  constexpr int kMostSteps = 2000;
  for (const WalkerModel& model : parse_walker_models(text, "input")) {
    ModelWalk walk(model);
    for (int step = 0; step < kMostSteps && walk.has_next(); ++step) walk.next();
  }
}

using Reader = std::function<void(const std::string&)>;

std::map<std::string, Reader, std::less<>> all_readers() {
  std::map<std::string, Reader, std::less<>> readers;
  for (const MapFormat& format : map_formats()) {
    readers.emplace(format.name, [&format](const std::string& text) { read_map(format, text); });
  }
  readers.emplace("map-text", [](const std::string& bytes) { map_text(bytes, "input", {}); });
  readers.emplace("safetensors", [](const std::string& text) { Safetensors::parse(text, "input"); });
  readers.emplace("plan", read_plan_text);
  readers.emplace("live", read_messages);
  readers.emplace("walker-models", read_walker_models);
  return readers;
}

Reader chosen;

void choose(std::string_view name) {
  const auto readers = all_readers();
  if (name == "list") {
    for (const auto& [reader, read] : readers) std::printf("%s\n", reader.c_str());
    std::exit(0);
  }
  const auto found = readers.find(name);
  if (found == readers.end()) fail("no such reader; --reader=list names them");
  chosen = found->second;
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
    chosen(text);
  } catch (const Error&) {
    return 0;
  }
  return 0;
}
