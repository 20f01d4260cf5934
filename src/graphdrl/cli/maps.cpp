#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <numeric>
#include <optional>

#include "graphdrl/base/error.h"
#include "graphdrl/cli/commands.h"
#include "graphdrl/cli/program.h"
#include "graphdrl/env/load_worlds.h"
#include "graphdrl/env/walk.h"
#include "graphdrl/env/world_families.h"
#include "graphdrl/graph/components.h"
#include "graphdrl/io/ascii_map.h"
#include "graphdrl/io/file.h"
#include "graphdrl/io/map_source.h"
#include "graphdrl/io/node_link.h"
#include "graphdrl/planners/bound.h"
#include "graphdrl/report/map_drawing.h"
#include "graphdrl/report/picture.h"
#include "graphdrl/report/terminal_picture.h"

namespace graphdrl {
namespace {

constexpr double kMostSpent = 1e300;  // no limit for walks that are shown
constexpr double kBudgetStep = 1e-6;  // of a budget that visits all, where costs are no whole numbers

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

// The least budget with which some walk may visit every node: no walk does with less. Empty where none does at all.
// The bound [planners/bound.h] turned round.
std::optional<double> least_budget(const World& world) {
  const NodeId given = world.given().start;
  const NodeId start = given == kNoNode ? world.valid_nodes().front() : given;
  const auto may_visit_all = [&](double budget) {
    return max_prize(Task(world, start, budget)) >= world.total_prize() * (1 - kPrizeRounding);
  };
  const Graph& open = world.open();
  double high = 2.0 * world.valid_count() * open.max_cost();  // a tour along a spanning tree
  if (open.directed()) high *= world.valid_count();
  if (high == 0) return 0;
  if (!may_visit_all(high)) return std::nullopt;
  // In steps: of 1 where costs are whole numbers.
  const double step = open.integer_costs() ? 1 : kBudgetStep * high;
  std::int64_t too_few = -1;
  auto enough = static_cast<std::int64_t>(std::ceil(high / step));
  while (enough - too_few > 1) {
    const std::int64_t middle = std::midpoint(too_few, enough);
    (may_visit_all(static_cast<double>(middle) * step) ? enough : too_few) = middle;
  }
  return static_cast<double>(enough) * step;
}

Json describe(const World& world) {
  const Graph& open = world.open();
  const Components components = find_components(open, world.blocked());
  int least_degree = std::numeric_limits<int>::max();
  int most_degree = 0;
  for (const NodeId node : world.valid_nodes()) {
    least_degree = std::min(least_degree, open.degree(node));
    most_degree = std::max(most_degree, open.degree(node));
  }
  const double arcs = static_cast<double>(open.edge_count()) * (open.directed() ? 1 : 2);
  Json json = {{"map", world.name()},
               {"nodes", world.graph().node_count()},
               {"edges", world.graph().edge_count()},
               {"directed", world.graph().directed()},
               {"weighted", world.graph().weighted()},
               {"valid_nodes", world.valid_count()},
               {"components", components.count()},
               {"connected", components.count() == 1},
               {"largest_component", components.sizes[components.largest()]},
               {"degrees", {{"min", least_degree}, {"mean", arcs / world.valid_count()}, {"max", most_degree}}},
               {"costs", {{"min", open.min_cost()}, {"mean", open.mean_cost()}, {"max", open.max_cost()}}},
               {"least_budget", or_null(components.count() == 1 ? least_budget(world) : std::nullopt)},
               {"bounding_box", nullptr},
               {"unit", world.has_places() ? Json(world.unit()) : Json()}};
  if (world.has_cells()) json["cells"] = {world.map()->rows, world.map()->cols};
  if (world.has_places()) {
    double left = kNoLimit, bottom = kNoLimit, right = -kNoLimit, top = -kNoLimit;
    for (NodeId node = 0; node < world.node_count(); ++node) {
      const Point at = world.place(node);
      left = std::min(left, at.x);
      right = std::max(right, at.x);
      bottom = std::min(bottom, at.y);
      top = std::max(top, at.y);
    }
    json["bounding_box"] = {left, bottom, right, top};
  }
  return json;
}

std::string describe_in_words(const Json& map) {
  const auto number = [](const Json& json) { return fmt::format("{:.6g}", json.get<double>()); };
  const int components = map["components"].get<int>();
  std::string text = fmt::format(
      "{}: {} nodes, {}{}{} edges, {} valid nodes in {} connected component{}\n",
      escaped(map["map"].get<std::string>()), map["nodes"].get<int>(), map["directed"].get<bool>() ? "directed " : "",
      map["weighted"].get<bool>() ? "weighted " : "", map["edges"].get<std::int64_t>(), map["valid_nodes"].get<int>(),
      components, components == 1 ? "" : fmt::format("s, the largest of {}", map["largest_component"].get<int>()));
  if (map.contains("cells"))
    text += fmt::format("  cells    {} rows, {} columns\n", map["cells"][0].get<int>(), map["cells"][1].get<int>());
  const Json& degrees = map["degrees"];
  text += fmt::format("  degrees  {} to {}, {:.3g} in the mean\n", degrees["min"].get<int>(), degrees["max"].get<int>(),
                      degrees["mean"].get<double>());
  if (map["weighted"].get<bool>()) {
    const Json& costs = map["costs"];
    text += fmt::format("  costs    {} to {}, {} in the mean\n", number(costs["min"]), number(costs["max"]),
                        number(costs["mean"]));
  }
  if (!map["least_budget"].is_null()) {
    text += fmt::format("  budget   no walk visits every node for less than {}\n", number(map["least_budget"]));
  }
  if (!map["bounding_box"].is_null()) {
    const Json& box = map["bounding_box"];
    const std::string unit = map["unit"].get<std::string>();
    text += fmt::format("  lies     x from {} to {}, y from {} to {}{}{}\n", number(box[0]), number(box[2]),
                        number(box[1]), number(box[3]), unit.empty() ? "" : " ", escaped(unit));
  }
  return text;
}

void show_info(const MapsOptions& options) {
  Json maps = Json::array();
  for (const World& world : load_worlds({options.map}, options.reading)) maps.push_back(describe(world));
  if (options.json) {
    print_json(maps.size() == 1 ? maps[0] : maps);
    return;
  }
  std::string text;
  for (const Json& map : maps) text += describe_in_words(map);
  print_text(text);
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
  print_text(fmt::format("Wrote {}{}\n", options.out, given ? ", without the budget and the ends of the file" : ""));
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
  return format_node_link(world.graph(), world.blocked());
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
