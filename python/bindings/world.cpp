#include <cmath>

#include "bindings.h"
#include "graphdrl/answer/edge_cover.h"
#include "graphdrl/base/error.h"
#include "graphdrl/env/load_worlds.h"
#include "graphdrl/env/world_families.h"
#include "graphdrl/io/attributes.h"
#include "graphdrl/report/picture.h"

namespace graphdrl::python {
namespace {

// Parts of what a world is made of, as Python keeps them in pickles.
using GridFrameState = std::tuple<double, double, double, double, std::string>;  // cell size, origin x, y, yaw, unit
using GivenState = std::tuple<std::optional<double>, NodeId, NodeId>;

World grid(std::string name, const InArray<bool, nb::ndim<2>>& blocked, bool diagonals, bool cut_corners,
           const std::optional<GridFrameState>& frame) {
  if (blocked.size() == 0 || blocked.size() > 1'000'000'000) {
    throw Error({.what = "bad size of a grid", .expected = "1 to 1000000000 cells", .where = name});
  }
  GridMap map{.rows = static_cast<int>(blocked.shape(0)),
              .cols = static_cast<int>(blocked.shape(1)),
              .blocked = std::vector<bool>(blocked.data(), blocked.data() + blocked.size()),
              .diagonals = diagonals,
              .cut_corners = cut_corners};
  if (frame) {
    const auto& [size, x, y, yaw, unit] = *frame;
    if (!(size > 0) || !std::isfinite(size) || !std::isfinite(x) || !std::isfinite(y) || !std::isfinite(yaw)) {
      throw Error({.what = "bad frame of a grid", .expected = "finite numbers, a cell size above 0", .where = name});
    }
    map.frame = GridFrame{.cell_size = size, .origin = {x, y}, .yaw = yaw, .unit = unit};
  }
  return World(std::move(name), std::move(map));
}

World graph(std::string name, std::int64_t node_count, const InArray<std::int64_t, nb::shape<-1, 2>>& edges,
            const InArray<double, nb::ndim<1>>& costs, bool directed, const InArray<bool, nb::ndim<1>>& blocked,
            std::vector<std::string> labels, const InArray<double, nb::ndim<1>>& prizes,
            const InArray<double, nb::shape<-1, 2>>& places, const std::string& unit, const GivenState& given,
            std::vector<std::string> edge_labels, const InArray<double, nb::ndim<1>>& edge_prizes,
            std::vector<bool> both_ways) {
  const auto& [budget, start, end] = given;
  const EdgeArrays arrays{.node_count = node_count,
                          .edges = {edges.data(), edges.size()},
                          .costs = {costs.data(), costs.size()},
                          .directed = directed,
                          .labels = std::move(edge_labels),
                          .prizes = {edge_prizes.data(), edge_prizes.size()},
                          .both_ways = std::move(both_ways)};
  GraphMap map{.graph = {},
               .blocked = std::vector<bool>(blocked.data(), blocked.data() + blocked.size()),
               .labels = std::move(labels),
               .prizes = {prizes.data(), prizes.data() + prizes.size()},
               .places = {.points = {}, .unit = unit},
               .task = {.budget = budget, .start = start, .end = end}};
  for (std::size_t i = 0; i < places.size() / 2; ++i) {
    map.places.points.push_back({places.data()[2 * i], places.data()[2 * i + 1]});
  }
  return world_of(std::move(name), arrays, std::move(map));
}

World from_file(const std::string& path, const std::string& cost_attribute, const std::string& prize_attribute,
                int cell_pixels, bool unknown_is_free, double robot_radius, std::optional<double> cell_size,
                int connectivity, bool cut_corners, const nb::object& note) {
  if (connectivity != 4 && connectivity != 8) {
    throw Error({.what = "bad connectivity", .expected = "4 or 8", .got = std::to_string(connectivity)});
  }
  if (!(robot_radius >= 0) || (cell_size && !(*cell_size > 0)) || cell_pixels < 1) {
    throw Error({.what = "bad option of a map", .expected = "cell sizes above 0, a radius from 0 up", .where = path});
  }
  MapOptions options{.cost_attribute = cost_attribute,
                     .prize_attribute = prize_attribute,
                     .cell_pixels = cell_pixels,
                     .unknown_is_free = unknown_is_free,
                     .robot_radius = robot_radius,
                     .cell_size = cell_size,
                     .diagonals = connectivity == 8,
                     .cut_corners = cut_corners};
  std::vector<std::string> notes;
  options.note = [&](const std::string& text) { notes.push_back(text); };
  std::optional<World> world;
  {
    const nb::gil_scoped_release unlocked;
    world = load_one_world(path, options);
  }
  for (const std::string& text : notes) note(text);
  return *world;
}

World random(const std::string& family, int size, std::uint64_t seed, bool weighted, bool directed,
             std::optional<double> blocked) {
  Rng rng(seed);
  return random_world({.family = family, .size = size, .weighted = weighted, .directed = directed, .blocked = blocked},
                      rng);
}

std::vector<std::uint8_t> bytes_of(const std::vector<bool>& flags) {
  return {flags.begin(), flags.end()};
}

// Edges as arrays: [2E], [E].
std::tuple<OutArray<std::int64_t>, OutArray<double>> arrays_of(const std::vector<Edge>& edges) {
  std::vector<std::int64_t> ends;
  std::vector<double> costs;
  for (const Edge& edge : edges) {
    ends.push_back(edge.a);
    ends.push_back(edge.b);
    costs.push_back(edge.cost);
  }
  return {to_numpy(std::move(ends)), to_numpy(std::move(costs))};
}

OutArray<double> places_of(const World& world) {
  std::vector<double> values;
  for (NodeId node = 0; world.has_places() && node < world.node_count(); ++node) {
    values.push_back(world.place(node).x);
    values.push_back(world.place(node).y);
  }
  return to_numpy(std::move(values));
}

std::optional<std::tuple<int, int, bool, bool, std::optional<GridFrameState>>> grid_of(const World& world) {
  if (!world.has_cells()) return std::nullopt;
  const GridMap& map = *world.map();
  std::optional<GridFrameState> frame;
  if (map.frame) {
    frame = {map.frame->cell_size, map.frame->origin.x, map.frame->origin.y, map.frame->yaw, map.frame->unit};
  }
  return std::tuple{map.rows, map.cols, map.diagonals, map.cut_corners, frame};
}

}  // namespace

void bind_worlds(nb::module_& module) {
  nb::class_<World>(module, "World", "A graph with its blocked nodes and prizes. Immutable; nodes are numbers.")
      .def_static("grid", &grid, nb::arg("name"), nb::arg("blocked"), nb::arg("diagonals"), nb::arg("cut_corners"),
                  nb::arg("frame").none())
      .def_static("graph", &graph, nb::arg("name"), nb::arg("node_count"), nb::arg("edges"), nb::arg("costs"),
                  nb::arg("directed"), nb::arg("blocked"), nb::arg("labels"), nb::arg("prizes"), nb::arg("places"),
                  nb::arg("unit"), nb::arg("given"), nb::arg("edge_labels"), nb::arg("edge_prizes"),
                  nb::arg("both_ways"))
      .def_static("from_file", &from_file, nb::arg("path"), nb::arg("cost_attribute"), nb::arg("prize_attribute"),
                  nb::arg("cell_pixels"), nb::arg("unknown_is_free"), nb::arg("robot_radius"),
                  nb::arg("cell_size").none(), nb::arg("connectivity"), nb::arg("cut_corners"), nb::arg("note"))
      .def_static("random", &random, nb::arg("family"), nb::arg("size"), nb::arg("seed"), nb::arg("weighted"),
                  nb::arg("directed"), nb::arg("blocked").none())
      .def_prop_ro("name", &World::name)
      .def_prop_ro("node_count", &World::node_count)
      .def_prop_ro("edge_count", [](const World& world) { return world.graph().edge_count(); })
      .def_prop_ro("valid_count", &World::valid_count)
      .def_prop_ro(
          "valid_nodes",
          [](const World& world) {
            return to_numpy(std::vector(world.valid_nodes().begin(), world.valid_nodes().end()));
          },
          nb::rv_policy::automatic)
      .def_prop_ro(
          "blocked", [](const World& world) { return to_numpy(bytes_of(world.blocked())); }, nb::rv_policy::automatic)
      .def_prop_ro("labels", &World::labels)
      .def_prop_ro(
          "prizes", [](const World& world) { return to_numpy(world.prizes()); }, nb::rv_policy::automatic)
      .def_prop_ro("total_prize", &World::total_prize)
      .def_prop_ro("places", &places_of, nb::rv_policy::automatic)
      .def_prop_ro("unit", [](const World& world) { return world.has_places() ? world.unit() : std::string(); })
      .def_prop_ro("directed", [](const World& world) { return world.open().directed(); })
      .def_prop_ro("weighted", [](const World& world) { return world.open().weighted(); })
      .def_prop_ro("complete", [](const World& world) { return world.open().is_complete(); })
      .def_prop_ro("grid_state", &grid_of)
      .def_prop_ro("given",
                   [](const World& world) {
                     const GivenTask& given = world.given();
                     return GivenState{given.budget, given.start, given.end};
                   })
      .def_prop_ro(
          "edges", [](const World& world) { return arrays_of(world.graph().edges()); }, nb::rv_policy::automatic)
      .def_prop_ro(
          "all_edges", [](const World& world) { return arrays_of(all_edges(world).edges); }, nb::rv_policy::automatic)
      .def_prop_ro("both_ways", [](const World& world) { return all_edges(world).both_ways; })
      .def_prop_ro("edge_labels", [](const World& world) { return all_edges(world).labels; })
      .def_prop_ro(
          "edge_prizes", [](const World& world) { return to_numpy(all_edges(world).prizes); }, nb::rv_policy::automatic)
      .def("svg", [](const World& world) { return Picture(world, {}, world.name(), {}).svg(); });
  std::vector<std::string> names;
  for (const WorldFamily& family : world_families()) names.emplace_back(family.name);
  module.attr("FAMILIES") = nb::cast(names);
  // What attributes of files mean.
  const auto texts = [](std::span<const std::string_view> all) {
    return nb::cast(std::vector(all.begin(), all.end()));
  };
  module.attr("COST_NAMES") = texts(kCostNames);
  module.attr("PRIZE_NAMES") = texts(kPrizeNames);
  module.attr("EDGE_PRIZE_NAMES") = texts(kEdgePrizeNames);
  nb::list places;
  for (const PlaceNames& one : kPlaceNames) places.append(nb::make_tuple(one.x, one.y, one.unit));
  module.attr("PLACE_NAMES") = places;
}

}  // namespace graphdrl::python
