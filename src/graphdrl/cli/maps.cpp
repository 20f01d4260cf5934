#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <optional>

#include "graphdrl/answer/least_budget.h"
#include "graphdrl/base/error.h"
#include "graphdrl/cli/commands.h"
#include "graphdrl/cli/program.h"
#include "graphdrl/env/episode.h"
#include "graphdrl/env/load_worlds.h"
#include "graphdrl/env/world_families.h"
#include "graphdrl/graph/components.h"
#include "graphdrl/graph/search.h"
#include "graphdrl/io/file.h"
#include "graphdrl/io/map_source.h"
#include "graphdrl/io/readers.h"
#include "graphdrl/report/map_drawing.h"
#include "graphdrl/report/picture.h"
#include "graphdrl/report/terminal_picture.h"

namespace graphdrl {
namespace {

constexpr double kMostSpent = 1e300;  // walks that are shown cost what they cost

struct MapsOptions {
  std::string map;
  MapOptions reading;
  std::vector<NodeId> walk;
  std::string svg;
  std::string png;
  bool json = false;
};

struct ConvertOptions {
  std::string map;
  MapOptions reading;
  std::string out;
};

struct GenerateOptions {
  WorldSpec spec{.family = {}, .size = 0};
  int count = 10;
  std::string split;
  std::uint64_t seed = 1;
  std::string out;
};

template <typename T>
struct Spread {
  T min;
  double mean;
  T max;
};

struct Box {
  double left = kNoLimit, bottom = kNoLimit, right = -kNoLimit, top = -kNoLimit;
};

// What there is to say of a map.
struct MapInfo {
  const World& world;
  Components components;
  Spread<int> degrees;                 // of valid nodes
  Spread<double> costs;                // of the edges that can be walked
  NodeId start;                        // the file's, else the first valid node
  std::optional<double> least_budget;  // of walks from there; empty where nothing is known
  std::optional<Box> box;              // around the places
};

// What a user calls a node.
std::string spoken_name(const World& world, NodeId node) {
  if (!world.labels().empty()) return world.labels()[node];
  if (!world.has_cells()) return std::to_string(node);
  const Cell cell = world.map()->cell(node);
  return fmt::format("{},{}", cell.row, cell.col);
}

MapInfo describe(const World& world, const std::function<void(double share)>& progress) {
  const Graph& open = world.open();
  const NodeId given = world.given().start;
  const double arcs = static_cast<double>(open.edge_count()) * (open.directed() ? 1 : 2);
  const double mean_cost = open.max_cost() > 0 ? open.mean_cost() : 0;
  MapInfo info{.world = world,
               .components = find_components(open, world.blocked()),
               .degrees = {std::numeric_limits<int>::max(), arcs / world.valid_count(), 0},
               .costs = {open.min_cost(), mean_cost, open.max_cost()},
               .start = given == kNoNode ? world.valid_nodes().front() : given,
               .least_budget = {},
               .box = {}};
  for (const NodeId node : world.valid_nodes()) {
    info.degrees.min = std::min(info.degrees.min, open.degree(node));
    info.degrees.max = std::max(info.degrees.max, open.degree(node));
  }
  if (info.components.count() == 1) info.least_budget = least_budget(world, info.start, progress);
  if (!world.has_places()) return info;
  info.box = Box();
  for (NodeId node = 0; node < world.node_count(); ++node) {
    const Point at = world.place(node);
    info.box = {std::min(info.box->left, at.x), std::min(info.box->bottom, at.y), std::max(info.box->right, at.x),
                std::max(info.box->top, at.y)};
  }
  return info;
}

template <typename T>
Json spread_json(const Spread<T>& spread) {
  return {{"min", spread.min}, {"mean", spread.mean}, {"max", spread.max}};
}

Json info_json(const MapInfo& info) {
  const World& world = info.world;
  Json json = {{"map", world.name()},
               {"nodes", world.node_count()},
               {"edges", world.graph().edge_count()},
               {"directed", world.graph().directed()},
               {"weighted", world.graph().weighted()},
               {"valid_nodes", world.valid_count()},
               {"components", info.components.count()},
               {"connected", info.components.count() == 1},
               {"largest_component", info.components.sizes[info.components.largest()]},
               {"degrees", spread_json(info.degrees)},
               {"costs", spread_json(info.costs)},
               {"least_budget", or_null(info.least_budget)},
               {"least_budget_start", info.least_budget ? Json(info.start) : Json()},
               {"bounding_box", nullptr},
               {"unit", world.has_places() ? Json(world.unit()) : Json()}};
  if (const Multigraph* const all = world.multigraph()) {
    json["loops"] = all->loops();
    json["parallel_edges"] = all->parallel_edges(world.graph());
  }
  if (world.has_cells()) json["cells"] = {world.map()->rows, world.map()->cols};
  if (info.box) json["bounding_box"] = {info.box->left, info.box->bottom, info.box->right, info.box->top};
  return json;
}

std::string info_text(const MapInfo& info) {
  const World& world = info.world;
  const Graph& graph = world.graph();
  const int components = info.components.count();
  std::string text = fmt::format(
      "{}: {} nodes, {}{}{} edges, {} valid nodes in {} connected component{}\n", escaped(world.name()),
      world.node_count(), graph.directed() ? "directed " : "", graph.weighted() ? "weighted " : "", graph.edge_count(),
      world.valid_count(), components,
      components == 1 ? "" : fmt::format("s, the largest of {}", info.components.sizes[info.components.largest()]));
  if (const Multigraph* const all = world.multigraph()) {
    const auto loops = all->loops();
    const auto parallel = all->parallel_edges(graph);
    if (loops + parallel > 0) {
      text +=
          fmt::format("  besides  {} loops and {} parallel edges, which no walk over nodes needs\n", loops, parallel);
    }
  }
  if (world.has_cells()) text += fmt::format("  cells    {} rows, {} columns\n", world.map()->rows, world.map()->cols);
  text +=
      fmt::format("  degrees  {} to {}, {:.3g} in the mean\n", info.degrees.min, info.degrees.max, info.degrees.mean);
  if (graph.weighted()) {
    text += fmt::format("  costs    {} to {}, {:.6g} in the mean\n", info.costs.min, info.costs.max, info.costs.mean);
  }
  if (info.least_budget) {
    text += fmt::format("  budget   no walk from {} visits every node for less than {}\n",
                        escaped(spoken_name(world, info.start)), *info.least_budget);
  }
  if (info.box) {
    text += fmt::format("  lies     x from {:.6g} to {:.6g}, y from {:.6g} to {:.6g}{}{}\n", info.box->left,
                        info.box->right, info.box->bottom, info.box->top, world.unit().empty() ? "" : " ",
                        escaped(world.unit()));
  }
  return text;
}

void show_info(const MapsOptions& options) {
  const std::vector<World> worlds = load_worlds({options.map}, options.reading);
  Json maps = Json::array();
  std::string text;
  for (const World& world : worlds) {
    const MapInfo info = describe(world, options.reading.progress);
    if (options.json) maps.push_back(info_json(info));
    if (!options.json) text += info_text(info);
  }
  if (!options.json) return print_text(text);
  print_json(maps.size() == 1 ? maps[0] : maps);
}

void show_map(const MapsOptions& options) {
  const std::vector<World> worlds = load_worlds({options.map}, options.reading);
  if (worlds.size() > 1 && (!options.walk.empty() || !options.svg.empty() || !options.png.empty())) {
    throw Error({.what = "a walk or a picture needs one map",
                 .expected = "one map",
                 .got = fmt::format("{} maps", worlds.size()),
                 .where = options.map});
  }
  std::string text;
  for (const World& world : worlds) {
    std::string title = fmt::format("{}: {} valid nodes", world.name(), world.valid_count());
    if (!options.walk.empty()) {
      Episode episode(world, {.budget = kMostSpent, .action_space = action_space_of(world)});
      follow_walk(episode, options.walk);
      title += fmt::format(", {} visited in {} steps", episode.visited_count(), options.walk.size() - 1);
    }
    text += fmt::format("{}{}\n", text.empty() ? "" : "\n", title);
    if (world.has_cells()) {
      text += options.walk.empty() ? draw_map_text(world) : draw_walk(world, options.walk, screen_of(stdout));
    }
    if (options.svg.empty() && options.png.empty()) continue;
    const Picture picture(world, options.walk, title, {});
    if (!options.svg.empty()) write_file(options.svg, picture.svg());
    if (!options.png.empty()) write_file(options.png, picture.png());
  }
  print_text(text);
}

void convert_map(const ConvertOptions& options) {
  const NamedMap named = load_map(options.map, options.reading);
  write_file(options.out, format_map(named.map, options.out));
  const auto* const graph = std::get_if<GraphMap>(&named.map);
  const bool given = graph != nullptr && (graph->task.budget || graph->task.start != kNoNode);
  std::string text = fmt::format("Wrote {}", options.out);
  if (given) text += ", without the budget and the ends of the file";
  if (graph != nullptr && graph->multigraph != nullptr) {
    const auto left_out = std::ssize(graph->multigraph->edges) - graph->graph.edge_count();
    if (left_out > 0) text += fmt::format(", without {} loops and parallel edges", left_out);
  }
  print_text(text + '\n');
}

std::string describe_formats() {
  std::string text = "Maps are read in any of these formats, known by their content:\n";
  for (const MapFormat& format : map_formats()) {
    const bool written = format.write_grid != nullptr || format.write_graph != nullptr;
    text += fmt::format("  {:10} {:6} {}\n", format.name, written ? format.ending : "", format.purpose);
  }
  text += "With an ending: can be written.\n";
  return text;
}

const std::map<std::string, Split> kSplits = {
    {"train", Split::kTrain}, {"validation", Split::kValidation}, {"test", Split::kTest}};

// The file of a world: a grid as text, a graph as node-link JSON.
std::string format_world(const World& world) {
  if (world.is_grid()) return format_ascii_map(*world.map());
  return format_node_link({.graph = world.graph(), .blocked = world.blocked()});
}

void generate_maps(const GenerateOptions& options) {
  const WorldSpec spec = options.spec;
  const std::filesystem::path folder = options.out.empty() ? spec.name() : options.out;
  std::error_code error;
  if (std::filesystem::exists(folder, error) && !std::filesystem::is_empty(folder, error)) {
    throw Error({.what = "the folder is not empty", .expected = "a new one", .where = folder.string()});
  }
  const auto split = kSplits.find(options.split);
  // The first one shows whether there are such worlds, before anything is made.
  const auto world_at = [&](int index) {
    if (split != kSplits.end()) return split_world(spec, split->second, index);
    Rng rng(derive_seed(options.seed, 0, static_cast<std::uint64_t>(index)));
    return random_world(spec, rng);
  };
  for (int index = 0; index < options.count; ++index) {
    const World world = world_at(index);
    if (index == 0) prepare_folder(folder);
    write_file(folder / fmt::format("{}-{:04}.{}", spec.name(), index, world.is_grid() ? "txt" : "json"),
               format_world(world));
  }
  print_text(fmt::format("Wrote {} world{} to {}\n", options.count, options.count == 1 ? "" : "s", folder.string()));
}

std::string describe_families() {
  std::string text = "Families; sizes are cells a side or nodes:\n";
  for (const WorldFamily& family : world_families()) {
    text += fmt::format("  {:16} {:6} {}\n", family.name, family.grid ? "cells" : "nodes", family.description);
  }
  return text;
}

}  // namespace

void add_maps_command(CLI::App& app) {
  CLI::App* const maps = app.add_subcommand("maps", "Look at maps, convert them, and make random ones");
  maps->require_subcommand(1);
  const auto options = std::make_shared<MapsOptions>();
  const auto add = [&](const std::string& name, const std::string& description) {
    CLI::App* const command = maps->add_subcommand(name, description);
    command->add_option("map", options->map, "paper, paper:a to paper:j, a file, or a folder")
        ->required()
        ->type_name("MAP");
    add_map_options(*command, options->reading);
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
  show->add_option("--svg", options->svg, "Also write the picture to this file")->check(not_empty())->type_name("FILE");
  show->add_option("--png", options->png, "Likewise, as PNG")->check(not_empty())->type_name("FILE");
  show->callback([options] { show_map(*options); });

  CLI::App* const convert = maps->add_subcommand("convert", "Write a map in another format");
  const auto converting = std::make_shared<ConvertOptions>();
  convert->add_option("map", converting->map, "paper:a to paper:j, or a file")->required()->type_name("MAP");
  convert->add_option("--out", converting->out, "The file; its ending names the format")
      ->required()
      ->check(not_empty())
      ->type_name("FILE");
  add_map_options(*convert, converting->reading);
  convert->footer(describe_formats());
  convert->callback([converting] { convert_map(*converting); });

  CLI::App* const generate = maps->add_subcommand("generate", "Make random worlds, each family with its own ranges");
  const auto making = std::make_shared<GenerateOptions>();
  generate->add_option("family", making->spec.family, "The family of worlds; see below")
      ->required()
      ->type_name("FAMILY");
  generate->add_option("--size", making->spec.size, "Cells a side of a grid, else nodes")->required()->type_name("N");
  generate->add_option("--count", making->count, "How many")->check(CLI::Range(1, 100'000))->capture_default_str();
  generate
      ->add_option("--blocked", making->spec.blocked,
                   "Share of blocked cells, 0 to 0.9, instead of a drawn one; obstacles only. The largest connected "
                   "part of the others stays free")
      ->type_name("SHARE");
  generate->add_flag("--weighted", making->spec.weighted, "Edges of different costs; graphs only");
  generate->add_flag("--directed", making->spec.directed, "Three edges in ten lead one way only; graphs only");
  CLI::Option* const seed = add_seed_option(*generate, making->seed, "The same seed gives the same worlds");
  generate
      ->add_option("--split", making->split, "Instead: the first worlds of a frozen split, train, validation or test")
      ->check(CLI::IsMember(kSplits))
      ->excludes(seed);
  generate->add_option("--out", making->out, "The folder, new or empty (default: named after the family)")
      ->check(not_empty());
  generate->footer(describe_families());
  generate->callback([making] { generate_maps(*making); });
}

}  // namespace graphdrl
