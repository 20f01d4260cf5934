#include <fmt/format.h>

#include <memory>

#include "graphdrl/base/error.h"
#include "graphdrl/cli/commands.h"
#include "graphdrl/cli/program.h"
#include "graphdrl/env/load_worlds.h"
#include "graphdrl/env/walk.h"
#include "graphdrl/graph/search.h"
#include "graphdrl/io/file.h"
#include "graphdrl/report/map_drawing.h"

namespace graphdrl {
namespace {

struct MapsOptions {
  std::string map;
  std::vector<NodeId> walk;
  std::string svg;
  bool json = false;
};

void show_info(const MapsOptions& options) {
  Json maps = Json::array();
  for (const World& world : load_worlds({options.map})) {
    const int components = count_components(world.graph(), world.blocked());
    maps.push_back({{"map", world.name()},
                    {"nodes", world.graph().node_count()},
                    {"edges", world.graph().edge_count()},
                    {"directed", world.graph().directed()},
                    {"weighted", world.graph().weighted()},
                    {"valid_nodes", world.valid_count()},
                    {"components", components},
                    {"connected", components == 1}});
  }
  if (options.json) {
    print_json(maps.size() == 1 ? maps[0] : maps);
    return;
  }
  for (const Json& map : maps) {
    print_text(fmt::format(
        "{}: {} nodes, {}{}{} edges, {} valid nodes in {} connected component{}\n", map["map"].get<std::string>(),
        map["nodes"].get<int>(), map["directed"].get<bool>() ? "directed " : "",
        map["weighted"].get<bool>() ? "weighted " : "", map["edges"].get<int>(), map["valid_nodes"].get<int>(),
        map["components"].get<int>(), map["connected"].get<bool>() ? "" : "s"));
  }
}

void show_map(const MapsOptions& options) {
  const std::vector<World> worlds = load_worlds({options.map});
  if (worlds.size() > 1 && (!options.walk.empty() || !options.svg.empty())) {
    throw Error({.what = "a walk or a picture needs one map",
                 .expected = "one map",
                 .got = fmt::format("{} maps", worlds.size()),
                 .where = options.map});
  }
  std::string text;
  for (const World& world : worlds) {
    if (!world.is_grid()) throw Error({.what = "only grid maps can be drawn", .where = world.name()});
    std::string title = fmt::format("{}: {} valid nodes", world.name(), world.valid_count());
    if (!options.walk.empty()) {
      Episode episode(world, {.budget = static_cast<double>(options.walk.size())});
      follow_walk(episode, options.walk);
      title += fmt::format(", {} visited in {} steps; numbers are steps of first visits", episode.visited_count(),
                           options.walk.size() - 1);
    }
    text += fmt::format("{}{}\n{}", text.empty() ? "" : "\n", title, draw_map_text(world, options.walk));
  }
  if (!options.svg.empty()) write_file(options.svg, draw_map_svg(worlds.front(), options.walk));
  print_text(text);
}

}  // namespace

void add_maps_command(CLI::App& app) {
  CLI::App* const maps = app.add_subcommand("maps", "Look at maps");
  maps->require_subcommand(1);
  const auto options = std::make_shared<MapsOptions>();
  const auto add = [&](const std::string& name, const std::string& description) {
    CLI::App* const command = maps->add_subcommand(name, description);
    command->add_option("map", options->map, "paper, paper:a to paper:j, a file, or a folder")
        ->required()
        ->type_name("MAP");
    return command;
  };
  CLI::App* const info = add("info", "Count nodes, edges and connected components");
  info->add_flag("--json", options->json, "Print one JSON document");
  info->callback([options] { show_info(*options); });

  CLI::App* const show = add("show", "Draw a map, and a walk on it");
  show->add_option("--walk", options->walk, "Node ids, as 0,1,1,2; a repeated id is a blocked move")
      ->delimiter(',')
      ->check(not_empty())
      ->type_name("IDS");
  show->add_option("--svg", options->svg, "Also write the picture to this file")->type_name("FILE");
  show->callback([options] { show_map(*options); });
}

}  // namespace graphdrl
