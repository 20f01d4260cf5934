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
#include "graphdrl/io/file_check.h"
#include "graphdrl/io/map_source.h"
#include "graphdrl/io/readers.h"
#include "graphdrl/report/layout.h"
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
  std::string out;
  bool json = false;
};

struct GenerateOptions {
  WorldSpec spec{.family = {}, .size = 0};
  int count = 10;
  std::string split;
  std::uint64_t seed = 1;
  std::string out;
};

// What there is to say of a map: degrees of valid nodes, costs of the edges that can be walked, the least budget of
// walks from the file's start, else from the first valid node.
Json describe(const World& world, const std::function<void(double share)>& progress) {
  const Graph& open = world.open();
  const auto [fewest, most] =
      std::minmax_element(world.valid_nodes().begin(), world.valid_nodes().end(),
                          [&](NodeId one, NodeId other) { return open.degree(one) < open.degree(other); });
  const double arcs = static_cast<double>(open.edge_count()) * (open.directed() ? 1 : 2);
  const Components components = find_components(open, world.blocked());
  const NodeId start = world.given().start == kNoNode ? world.valid_nodes().front() : world.given().start;
  const auto least = components.count() == 1 ? least_budget(world, start, progress) : std::nullopt;
  Json json = {
      {"map", world.name()},
      {"nodes", world.node_count()},
      {"edges", world.graph().edge_count()},
      {"directed", world.graph().directed()},
      {"weighted", world.graph().weighted()},
      {"valid_nodes", world.valid_count()},
      {"components", components.count()},
      {"connected", components.count() == 1},
      {"largest_component", components.sizes[components.largest()]},
      {"degrees", {{"min", open.degree(*fewest)}, {"mean", arcs / world.valid_count()}, {"max", open.degree(*most)}}},
      {"costs",
       {{"min", open.min_cost()}, {"mean", open.max_cost() > 0 ? open.mean_cost() : 0}, {"max", open.max_cost()}}},
      {"least_budget", or_null(least)},
      {"least_budget_start", least ? Json(start) : Json()},
      {"bounding_box", nullptr},
      {"unit", world.has_places() ? Json(world.unit()) : Json()}};
  if (const Multigraph* const all = world.multigraph()) {
    json["loops"] = all->loops();
    json["parallel_edges"] = all->parallel_edges(world.graph());
  }
  if (world.has_cells()) json["cells"] = {world.map()->rows, world.map()->cols};
  if (world.has_places()) {
    const Box box = box_of(places_of(world));
    json["bounding_box"] = {box.left, box.bottom, box.right, box.top};
  }
  return json;
}

// The same as text.
std::string info_text(const World& world, const Json& info) {
  const Graph& graph = world.graph();
  const auto number = [](const Json& value) { return value.get<double>(); };
  const int components = info["components"];
  std::string text =
      fmt::format("{}: {} nodes, {}{}{} edges, {} valid nodes in {} connected component{}\n", escaped(world.name()),
                  world.node_count(), graph.directed() ? "directed " : "", graph.weighted() ? "weighted " : "",
                  graph.edge_count(), world.valid_count(), components,
                  components == 1 ? "" : fmt::format("s, the largest of {}", info["largest_component"].get<int>()));
  if (info.value("loops", std::int64_t{0}) + info.value("parallel_edges", std::int64_t{0}) > 0) {
    text += fmt::format("  besides  {} loops and {} parallel edges, which no walk over nodes needs\n",
                        info["loops"].get<std::int64_t>(), info["parallel_edges"].get<std::int64_t>());
  }
  if (world.has_cells()) text += fmt::format("  cells    {} rows, {} columns\n", world.map()->rows, world.map()->cols);
  text += fmt::format("  degrees  {} to {}, {:.3g} in the mean\n", number(info["degrees"]["min"]),
                      number(info["degrees"]["max"]), number(info["degrees"]["mean"]));
  if (graph.weighted()) {
    text += fmt::format("  costs    {} to {}, {:.6g} in the mean\n", number(info["costs"]["min"]),
                        number(info["costs"]["max"]), number(info["costs"]["mean"]));
  }
  if (!info["least_budget"].is_null()) {
    text += fmt::format("  budget   no walk from {} visits every node for less than {}\n",
                        escaped(node_name(world, info["least_budget_start"])), number(info["least_budget"]));
  }
  if (const Json& box = info["bounding_box"]; !box.is_null()) {
    text +=
        fmt::format("  lies     x from {:.6g} to {:.6g}, y from {:.6g} to {:.6g}{}{}\n", number(box[0]), number(box[2]),
                    number(box[1]), number(box[3]), world.unit().empty() ? "" : " ", escaped(world.unit()));
  }
  return text;
}

void show_info(const MapsOptions& options) {
  const std::vector<World> worlds = load_worlds({options.map}, options.reading);
  Json maps = Json::array();
  std::string text;
  for (const World& world : worlds) {
    maps.push_back(describe(world, options.reading.progress));
    text += info_text(world, maps.back());
  }
  if (!options.json) return print_text(text);
  print_json(maps.size() == 1 ? maps[0] : maps);
}

void show_map(const MapsOptions& options) {
  if (!options.svg.empty()) check_writable(options.svg);
  if (!options.png.empty()) check_writable(options.png);
  const std::vector<World> worlds = load_worlds({options.map}, options.reading);
  if (worlds.size() > 1 && (!options.walk.empty() || !options.svg.empty() || !options.png.empty())) {
    throw Error({.what = "a walk or a picture needs one map",
                 .expected = "one map",
                 .got = fmt::format("{} maps", worlds.size()),
                 .where = options.map});
  }
  std::string text;
  for (const World& world : worlds) {
    std::string title = fmt::format("{}: {} valid nodes", escaped(world.name()), world.valid_count());
    if (!options.walk.empty()) {
      Episode episode(world, {.budget = kMostSpent, .action_space = action_space_of(world)});
      follow_walk(episode, options.walk);
      title += fmt::format(", {} visited in {} steps", episode.visited_count(), options.walk.size() - 1);
    }
    text += fmt::format("{}{}\n", text.empty() ? "" : "\n", title);
    if (world.has_cells()) {
      text += options.walk.empty() ? format_ascii_map(*world.map()) : draw_walk(world, options.walk, screen_of(stdout));
    }
    if (options.svg.empty() && options.png.empty()) continue;
    const Picture picture(world, options.walk, title, {});
    attempt_all({[&] {
                   if (!options.svg.empty()) write_file(options.svg, picture.svg());
                 },
                 [&] {
                   if (!options.png.empty()) write_file(options.png, picture.png());
                 },
                 [&] { print_text(text); }});
    return;
  }
  print_text(text);
}

void convert_map(const MapsOptions& options) {
  check_writable(options.out);
  const NamedMap named = load_map(options.map, options.reading);
  write_file(options.out, format_map(named.map, options.out));
  const auto* const graph = std::get_if<GraphMap>(&named.map);
  const bool given = graph != nullptr && (graph->task.budget || graph->task.start != kNoNode);
  std::string text = fmt::format("Wrote {}", escaped(options.out));
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
  return format_node_link(world.to_map());
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
  print_text(
      fmt::format("Wrote {} world{} to {}\n", options.count, options.count == 1 ? "" : "s", escaped(folder.string())));
}

std::string describe_families() {
  std::string text = "Families; sizes are cells a side or nodes, of some graphs a few less:\n";
  for (const WorldFamily& family : world_families()) {
    text += fmt::format("  {:17} {:6} {}\n", family.name, family.grid ? "cells" : "nodes", family.description);
  }
  return text;
}

}  // namespace

void add_maps_command(CLI::App& app) {
  CLI::App& maps = *app.add_subcommand("maps", "Look at maps, convert them, and make random ones");
  maps.require_subcommand(1);
  const auto options = std::make_shared<MapsOptions>();
  const auto add = [&](const std::string& name, const std::string& description, const std::string& which) {
    CLI::App* const command = maps.add_subcommand(name, description);
    command->add_option("map", options->map, which)->required()->type_name("MAP");
    return command;
  };
  const std::string any_number = "paper, paper:a to paper:j, a file, or a folder";

  CLI::App& info = *add("info", "Count nodes, edges and connected components", any_number);
  add_map_options(info, options->reading);
  info.add_flag("--json", options->json, "Print one JSON document");
  info.callback([options] { show_info(*options); });

  CLI::App& show = *add("show", "Draw a map, and a walk on it", any_number);
  add_map_options(show, options->reading);
  add_text_option(show, "--walk", options->walk, "IDS", "Node ids, as 0,1,1,2; a repeated id is a blocked move")
      ->delimiter(',');
  add_text_option(show, "--svg", options->svg, "FILE", "Also write the picture to this file");
  add_text_option(show, "--png", options->png, "FILE", "Likewise, as PNG");
  show.callback([options] { show_map(*options); });

  CLI::App& convert = *add("convert", "Write a map in another format", "paper:a to paper:j, or a file");
  add_text_option(convert, "--out", options->out, "FILE", "The file; its ending names the format")->required();
  add_map_options(convert, options->reading);
  convert.footer(describe_formats());
  convert.callback([options] { convert_map(*options); });

  CLI::App& generate = *maps.add_subcommand("generate", "Make random worlds, each family with its own ranges");
  const auto making = std::make_shared<GenerateOptions>();
  generate.add_option("family", making->spec.family, "The family of worlds; see below")
      ->required()
      ->type_name("FAMILY");
  generate.add_option("--size", making->spec.size, "Cells a side of a grid, else nodes")->required()->type_name("N");
  generate.add_option("--count", making->count, "How many")->check(CLI::Range(1, 100'000))->capture_default_str();
  generate
      .add_option(
          "--blocked", making->spec.blocked,
          "Share of blocked cells, 0 to 0.9, instead of a drawn one; obstacles only. The largest connected part "
          "of the others stays free")
      ->type_name("SHARE");
  generate.add_flag("--weighted", making->spec.weighted, "Edges of different costs; graphs only");
  generate.add_flag("--directed", making->spec.directed, "Three edges in ten lead one way only; graphs only");
  CLI::Option* const seed = add_seed_option(generate, making->seed, "The same seed gives the same worlds");
  generate
      .add_option("--split", making->split, "Instead: the first worlds of a frozen split, train, validation or test")
      ->check(CLI::IsMember(kSplits))
      ->excludes(seed);
  generate.add_option("--out", making->out, "The folder, new or empty (default: named after the family)")
      ->check(not_empty());
  generate.footer(describe_families());
  generate.callback([making] { generate_maps(*making); });
}

}  // namespace graphdrl
