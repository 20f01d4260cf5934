#include "graphdrl/train/explorer_worlds.h"

namespace graphdrl {
namespace {

// Most are small: there the search's values are nearly exact, and several lessons cost as much as one of a large world.
// Larger ones are worth 0.7 points on graphs of 200 nodes and cost grids up to 2 (docs/explorer.md, "What pays").
constexpr int kSides[] = {4, 5, 6, 7, 8, 9, 10, 11, 13, 15, 16, 20, 26};
constexpr int kNodes[] = {16, 33, 55, 77, 110, 140};
constexpr int kNodesPerSide = 7;

// Drawn more often, by so many entries in the list: the paper's size, and mazes that are hard but not large.
constexpr int kPaperSide = 5;
constexpr int kPaperSideCopies = 5;
constexpr int kLeastHardMaze = 7;
constexpr int kMostHardMaze = 11;
constexpr int kHardMazeCopies = 3;

// The larger a graph with one way edges, the more of it is lost after a few steps.
constexpr int kMostDirected = 77;
constexpr int kMostDirectedWeighted = 33;

void add(std::vector<WorldSpec>& worlds, int copies, const WorldSpec& spec) {
  worlds.insert(worlds.end(), static_cast<std::size_t>(copies), spec);
}

}  // namespace

std::vector<WorldSpec> training_worlds(int largest) {
  std::vector<WorldSpec> worlds;
  for (const int side : kSides) {
    if (side > largest) break;
    add(worlds, side == kPaperSide ? kPaperSideCopies : 1, {"obstacles", side});
    for (const char* const family : {"rooms", "open", "caves", "houses", "streets"}) add(worlds, 1, {family, side});
    if (side % 2 == 0) continue;  // mazes have an odd number of cells a side
    const bool hard = side >= kLeastHardMaze && side <= kMostHardMaze;
    for (const char* const family : {"maze", "loop-maze", "braided-maze"}) {
      add(worlds, hard ? kHardMazeCopies : 1, {family, side});
    }
  }
  for (const std::string family : {"tree", "erdos-renyi", "barabasi-albert", "watts-strogatz", "geometric"}) {
    for (const int nodes : kNodes) {
      if (nodes > kNodesPerSide * largest) break;
      add(worlds, 1, {family, nodes});
      add(worlds, 1, {family, nodes, /*weighted=*/true});
      if (family == "tree" || nodes > kMostDirected) continue;  // one way only, a tree is soon left for good
      add(worlds, 1, {family, nodes, /*weighted=*/false, /*directed=*/true});
      if (nodes <= kMostDirectedWeighted) add(worlds, 1, {family, nodes, /*weighted=*/true, /*directed=*/true});
    }
  }
  return worlds;
}

}  // namespace graphdrl
