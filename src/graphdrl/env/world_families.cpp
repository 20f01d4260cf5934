#include "graphdrl/env/world_families.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "graphdrl/base/error.h"
#include "graphdrl/graph/graph_generators.h"
#include "graphdrl/graph/grid_generators.h"
#include "graphdrl/graph/placed_graph_generators.h"

namespace graphdrl {
namespace {

constexpr int kMinSide = 3;
constexpr int kMaxSide = 1001;
constexpr int kMinNodes = 2;
constexpr int kMaxNodes = 1'000'000;
constexpr double kMaxBlocked = 0.9;
constexpr int kMostCost = 5;
constexpr double kOneWayShare = 0.3;

constexpr std::array<WorldFamily, 24> kFamilies = {{
    {"obstacles", true, "each cell an obstacle with a probability from 0.1 to 0.4, half the cells free at least"},
    {"maze", true, "perfect mazes, corridors one cell wide; odd sides"},
    {"loop-maze", true, "mazes, each inner wall between two rooms opened with a probability from 0.05 to 0.2"},
    {"braided-maze", true, "mazes, each dead end opened with a probability from 0.3 to 1"},
    {"rooms", true, "rooms of 2 to 4 cells a side, joined by corridors"},
    {"open", true, "empty: this side by one from 2 to it"},
    {"caves", true, "rock with a probability from 0.4 to 0.5, smoothed; a fifth of the cells free at least"},
    {"houses", true,
     "rooms of at most 3 to 8 cells a side, furniture on up to a quarter; 0.4 of the cells free at least"},
    {"streets", true, "1 to 3 cells wide, between blocks of at most 2 to 7 a side, up to 0.4 of them squares"},
    {"room-grid", true,
     "rooms of 4 to 6 cells a side in rows, 0.8 of the walls with a door; 0.45 of the cells free at least"},
    {"tree", false, "drawn uniformly from all trees"},
    {"erdos-renyi", false, "mean degree from 2.5 to 4, the largest part"},
    {"barabasi-albert", false, "each node joins by 1 or 2 edges"},
    {"barabasi-albert-dense", false, "the same by 3 to 5 edges"},
    {"watts-strogatz", false, "a ring of degree 4, 0.1 to 0.3 of the edges led elsewhere, the largest part"},
    {"geometric", false, "mean degree from 4 to 7, the largest part; costs are lengths where there are any"},
    {"power-law-cluster", false, "each node joins by 2 to 4 edges, 0.4 to 0.9 of the further ones close triangles"},
    {"balanced-tree", false, "each node with 2 to 5 children, level by level"},
    {"ladder", false, "two rows, each node joined to that opposite"},
    {"hexagons", false, "a square of a honeycomb"},
    {"triangles", false, "a square of a triangular lattice"},
    {"torus", false, "a square lattice without a border"},
    {"caveman", false, "a ring of cliques of about 4 to 40 nodes, one edge of each led to the one before"},
    {"road", false,
     "a square of crossings 100 m apart, moved; 0.65 to 0.8 of the streets and some diagonals, the largest part; costs "
     "are lengths, whole metres, where there are any"},
}};

double draw(double low, double high, Rng& rng) {
  return low + (high - low) * rng.uniform();
}

int draw_int(int low, int high, Rng& rng) {
  return low + rng.index(high - low + 1);
}

// Draws maps until so many cells are free.
template <typename Draw>
GridMap with_free_cells(double least, const Draw& draw_map) {
  for (;;) {
    GridMap drawn = draw_map();
    if (static_cast<double>(drawn.free_count()) >= least) return drawn;
  }
}

GridMap grid_of(const WorldSpec& spec, Rng& rng) {
  const int side = spec.size;
  if (spec.family == "obstacles") {
    return with_free_cells(spec.blocked ? 1 : side * side / 2, [&] {
      return random_obstacles_map(side, side, spec.blocked ? *spec.blocked : draw(0.1, 0.4, rng), rng);
    });
  }
  if (spec.family == "maze") return maze_map(side, side, 0, rng);
  if (spec.family == "loop-maze") return maze_map(side, side, draw(0.05, 0.2, rng), rng);
  if (spec.family == "braided-maze") return braided_maze_map(side, side, draw(0.3, 1, rng), rng);
  if (spec.family == "rooms") return rooms_map(side, side, 4, rng);
  if (spec.family == "caves") {
    return with_free_cells(0.2 * side * side, [&] { return caves_map(side, side, draw(0.4, 0.5, rng), rng); });
  }
  if (spec.family == "houses") {
    return with_free_cells(0.4 * side * side, [&] {
      const double furniture = draw(0, 0.25, rng);
      return house_map(side, side, draw_int(3, 8, rng), furniture, rng);
    });
  }
  if (spec.family == "streets") {
    return with_free_cells(0.2 * side * side, [&] {
      const int block = draw_int(2, 7, rng);
      const double squares = draw(0, 0.4, rng);
      return streets_map(side, side, draw_int(1, 3, rng), block, squares, rng);
    });
  }
  if (spec.family == "room-grid") {
    return with_free_cells(0.45 * side * side,
                           [&] { return room_grid_map(side, side, draw_int(4, 6, rng), 0.8, rng); });
  }
  int rows = side;  // "open"
  int cols = draw_int(2, side, rng);
  if (rng.below(2) == 0) std::swap(rows, cols);
  return {.rows = rows, .cols = cols, .blocked = std::vector<bool>(static_cast<std::size_t>(rows) * cols)};
}

Graph graph_of(const WorldSpec& spec, Rng& rng) {
  const int nodes = spec.size;
  if (spec.family == "tree") return random_tree(nodes, rng);
  if (spec.family == "erdos-renyi") return largest_part(erdos_renyi_graph(nodes, draw(2.5, 4, rng), rng));
  if (spec.family == "barabasi-albert") return barabasi_albert_graph(nodes, 1 + rng.index(2), rng);
  if (spec.family == "barabasi-albert-dense") return barabasi_albert_graph(nodes, draw_int(3, 5, rng), rng);
  if (spec.family == "watts-strogatz") {
    return largest_part(watts_strogatz_graph(nodes, 2, draw(0.1, 0.3, rng), rng));
  }
  if (spec.family == "geometric") return largest_part(geometric_graph(nodes, draw(4, 7, rng), spec.weighted, rng));
  const int links = draw_int(2, 4, rng);  // "power-law-cluster"
  return power_law_cluster_graph(nodes, links, draw(0.4, 0.9, rng), rng);
}

// A graph with places, of this many nodes or a few less, those of full rows; of another family none.
std::optional<GraphMap> placed_graph_of(const WorldSpec& spec, Rng& rng) {
  const int nodes = spec.size;
  const int rows = static_cast<int>(std::sqrt(nodes));
  const int cols = nodes / rows;
  if (spec.family == "balanced-tree") return balanced_tree_map(nodes, draw_int(2, 5, rng));
  if (spec.family == "ladder") return ladder_map(nodes / 2);
  if (spec.family == "hexagons") return hexagons_map(rows, cols);
  if (spec.family == "triangles") return triangles_map(rows, cols);
  if (spec.family == "torus") return torus_map(rows, cols);
  if (spec.family == "caveman") {
    const int caves = nodes / draw_int(4, 40, rng);
    return caveman_map(nodes, nodes < 6 ? 1 : std::clamp(caves, 2, nodes / 3));
  }
  if (spec.family == "road") return road_map(rows, cols, draw(0.65, 0.8, rng), spec.weighted, rng);
  return std::nullopt;
}

GraphMap graph_map_of(const WorldSpec& spec, Rng& rng) {
  if (const std::optional<GraphMap> placed = placed_graph_of(spec, rng)) return shuffled(*placed, rng);
  Graph graph = graph_of(spec, rng);
  std::vector<bool> blocked(graph.node_count());
  return {.graph = std::move(graph), .blocked = std::move(blocked)};
}

// The same number everywhere for the same text.
std::uint64_t text_hash(std::string_view text) {
  std::uint64_t hash = 0xcbf29ce484222325ULL;  // FNV-1a
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
  return hash;
}

}  // namespace

std::span<const WorldFamily> world_families() {
  return kFamilies;
}

std::int64_t WorldSpec::most_nodes() const {
  return family_of(*this).grid ? std::int64_t{size} * size : size;
}

std::string WorldSpec::name() const {
  return fmt::format("{}-{}{}{}", family, size, weighted ? "-weighted" : "", directed ? "-directed" : "");
}

const WorldFamily& family_of(const WorldSpec& spec) {
  const auto* const family = std::ranges::find(kFamilies, spec.family, &WorldFamily::name);
  if (family == kFamilies.end()) {
    std::string names;
    for (const WorldFamily& known : kFamilies) names += fmt::format("{}{}", names.empty() ? "" : ", ", known.name);
    throw Error({.what = "no such family of worlds", .expected = names, .got = in_quotes(spec.family, 200)});
  }
  const int least = family->grid ? kMinSide : kMinNodes;
  const int most = family->grid ? kMaxSide : kMaxNodes;
  const bool odd_only = family->name.ends_with("maze");
  if (spec.size < least || spec.size > most || (odd_only && spec.size % 2 == 0)) {
    throw Error({.what = fmt::format("bad size of {}", in_quotes(spec.family)),
                 .expected = fmt::format("{} number of {} from {} to {}", odd_only ? "an odd" : "a",
                                         family->grid ? "cells a side" : "nodes", least, most),
                 .got = fmt::format("{}", spec.size)});
  }
  if (family->grid && (spec.weighted || spec.directed)) {
    throw Error({.what = "grids have neither costs nor directions", .got = in_quotes(spec.family)});
  }
  if (spec.blocked && family->name != "obstacles") {
    throw Error({.what = "a share of blocked cells is for the family obstacles", .got = in_quotes(spec.family)});
  }
  if (spec.blocked && !(*spec.blocked >= 0 && *spec.blocked <= kMaxBlocked)) {
    throw Error({.what = "bad share of blocked cells",
                 .expected = fmt::format("0 to {}", kMaxBlocked),
                 .got = fmt::format("{}", *spec.blocked)});
  }
  return *family;
}

World random_world(const WorldSpec& spec, Rng& rng) {
  if (family_of(spec).grid) return World(spec.name(), grid_of(spec, rng));
  GraphMap map = graph_map_of(spec, rng);
  const bool lengths_cost = spec.family == "geometric" || spec.family == "road";
  if (spec.weighted && !lengths_cost) map.graph = with_random_costs(map.graph, kMostCost, rng);
  if (spec.directed) map.graph = with_one_way_edges(map.graph, kOneWayShare, rng);
  return World(spec.name(), std::move(map));
}

World split_world(const WorldSpec& spec, Split split, int index) {
  Rng rng(derive_seed(text_hash(spec.name()), static_cast<std::uint64_t>(split), static_cast<std::uint64_t>(index)));
  return random_world(spec, rng);
}

}  // namespace graphdrl
