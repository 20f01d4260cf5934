// Families of random worlds, and their frozen splits for training, validation and test.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "graphdrl/base/random.h"
#include "graphdrl/env/world.h"

namespace graphdrl {

struct WorldFamily {
  std::string_view name;
  bool grid;                     // sizes are sides of a square, not nodes
  std::string_view description;  // with the parameters' ranges
};

// obstacles, maze, loop-maze, braided-maze, rooms, open, caves, houses, streets, room-grid, tree, erdos-renyi,
// barabasi-albert, watts-strogatz, geometric, power-law-cluster; with places, nodes numbered in random order:
// balanced-tree, ladder, hexagons, triangles, torus, caveman, road
std::span<const WorldFamily> world_families();

struct WorldSpec {
  std::string family;
  int size;  // side of a grid, else nodes
  bool weighted = false;
  bool directed = false;
  // Of obstacles: each cell blocked with this probability instead of a drawn one, and only the largest connected part
  // left free, however small.
  std::optional<double> blocked = {};

  std::int64_t most_nodes() const;  // cells of a grid. Throws Error on an unknown family
  std::string name() const;         // "maze-11", "tree-50-weighted-directed"; without the share
};

// Throws Error as random_world().
const WorldFamily& family_of(const WorldSpec& spec);

// The family's parameters are drawn from their ranges, then the world. Every world is connected, whichever way its
// edges lead. Throws Error on an unknown family, on a size, costs, directions or a share of blocked cells that it
// does not have.
World random_world(const WorldSpec& spec, Rng& rng);

enum class Split { kTrain, kValidation, kTest };

// World `index` of a split: always the same one, and never one of another split but by chance.
World split_world(const WorldSpec& spec, Split split, int index);

}  // namespace graphdrl
