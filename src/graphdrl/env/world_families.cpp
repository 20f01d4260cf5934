#include "graphdrl/env/world_families.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "graphdrl/base/error.h"
#include "graphdrl/graph/graph_generators.h"
#include "graphdrl/graph/grid_generators.h"

namespace graphdrl {
namespace {

constexpr int kMinSide = 3;
constexpr int kMaxSide = 1001;
constexpr int kMinNodes = 2;
constexpr int kMaxNodes = 1'000'000;
constexpr double kMaxBlocked = 0.9;
constexpr int kMostCost = 5;
constexpr double kOneWayShare = 0.3;

constexpr std::array<WorldFamily, 14> kFamilies = {{
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
    {"tree", false, "drawn uniformly from all trees"},
    {"erdos-renyi", false, "mean degree from 2.5 to 4, the largest part"},
    {"barabasi-albert", false, "each node joins by 1 or 2 edges"},
    {"watts-strogatz", false, "a ring of degree 4, 0.1 to 0.3 of the edges led elsewhere, the largest part"},
    {"geometric", false, "mean degree from 4 to 7, the largest part; costs are lengths where there are any"},
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
  if (spec.family == "watts-strogatz") {
    return largest_part(watts_strogatz_graph(nodes, 2, draw(0.1, 0.3, rng), rng));
  }
  return largest_part(geometric_graph(nodes, draw(4, 7, rng), spec.weighted, rng));
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
  Graph graph = graph_of(spec, rng);
  if (spec.weighted && spec.family != "geometric") graph = with_random_costs(graph, kMostCost, rng);
  if (spec.directed) graph = with_one_way_edges(graph, kOneWayShare, rng);
  std::vector<bool> blocked(graph.node_count());
  return World(spec.name(), std::move(graph), std::move(blocked));
}

World split_world(const WorldSpec& spec, Split split, int index) {
  Rng rng(derive_seed(text_hash(spec.name()), static_cast<std::uint64_t>(split), static_cast<std::uint64_t>(index)));
  return random_world(spec, rng);
}

}  // namespace graphdrl
