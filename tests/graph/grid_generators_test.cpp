#include "graphdrl/graph/grid_generators.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "graphdrl/graph/components.h"

namespace graphdrl {
namespace {

int free_cells(const GridMap& map) {
  return static_cast<int>(std::count(map.blocked.begin(), map.blocked.end(), false));
}

std::int64_t free_edges(const GridMap& map) {
  return Graph::grid(map.rows, map.cols).without(map.blocked).edge_count();
}

int parts(const GridMap& map) {
  return find_components(Graph::grid(map.rows, map.cols), map.blocked).count();
}

int dead_ends(const GridMap& map) {
  const Graph open = Graph::grid(map.rows, map.cols).without(map.blocked);
  int count = 0;
  for (NodeId node = 0; node < open.node_count(); ++node) count += open.degree(node) == 1;
  return count;
}

TEST(GridGenerators, MazesWithoutLoopsAreTreesOfAllRooms) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    Rng rng(seed);
    const GridMap map = maze_map(11, 7, 0, rng);
    EXPECT_EQ(free_cells(map), 6 * 4 + 6 * 4 - 1);
    EXPECT_EQ(free_edges(map), free_cells(map) - 1);
    EXPECT_EQ(parts(map), 1);
  }
}

TEST(GridGenerators, LoopsAndBraidsOpenWalls) {
  Rng rng(1);
  const GridMap all = maze_map(11, 11, 1, rng);
  EXPECT_EQ(free_cells(all), 36 + 60) << "every wall between two rooms";
  EXPECT_EQ(parts(all), 1);
  int perfect_ends = 0;
  int half_ends = 0;
  int braided_ends = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    Rng one(seed);
    Rng same(seed);
    Rng third(seed);
    perfect_ends += dead_ends(maze_map(11, 11, 0, one));
    half_ends += dead_ends(braided_maze_map(11, 11, 0.5, third));
    const GridMap braided = braided_maze_map(11, 11, 1, same);
    braided_ends += dead_ends(braided);
    EXPECT_EQ(parts(braided), 1);
  }
  EXPECT_EQ(braided_ends, 0);
  EXPECT_GT(perfect_ends, 40);
  EXPECT_GT(half_ends, perfect_ends / 5);  // some pairs of dead ends open into each other
  EXPECT_LT(half_ends, perfect_ends * 3 / 5);
}

TEST(GridGenerators, ObstaclesLeaveOnePart) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    Rng rng(seed);
    const GridMap map = random_obstacles_map(5, 8, 0.4, rng);
    EXPECT_EQ(parts(map), free_cells(map) > 0 ? 1 : 0);
  }
  Rng rng(1);
  EXPECT_EQ(free_cells(random_obstacles_map(5, 8, 0, rng)), 40);
  EXPECT_EQ(free_cells(random_obstacles_map(5, 8, 1, rng)), 0);
  const GridMap map{.rows = 1, .cols = 5, .blocked = {false, true, false, false, true}};
  EXPECT_EQ(largest_component(map).blocked, (std::vector<bool>{true, true, false, false, true}));
}

TEST(GridGenerators, RoomsAreConnectedAndRepeatable) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    Rng rng(seed);
    Rng same(seed);
    const GridMap map = rooms_map(12, 15, 4, rng);
    EXPECT_EQ(parts(map), 1);
    EXPECT_LT(free_cells(map), 12 * 15);
    EXPECT_EQ(map.blocked, rooms_map(12, 15, 4, same).blocked);
  }
}

TEST(GridGenerators, RealLookingMapsAreConnectedAndRepeatable) {
  const auto check = [](int least_free, const auto& draw) {
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
      Rng one(seed);
      Rng same(seed);
      const GridMap map = draw(one);
      EXPECT_EQ(parts(map), 1);
      EXPECT_GE(free_cells(map), least_free);
      EXPECT_LT(free_cells(map), map.rows * map.cols);
      EXPECT_EQ(map.blocked, draw(same).blocked);
    }
  };
  check(50, [](Rng& rng) { return caves_map(20, 31, 0.45, rng); });
  check(50, [](Rng& rng) { return house_map(20, 31, 5, 0.2, rng); });
  check(50, [](Rng& rng) { return streets_map(20, 31, 2, 5, 0.2, rng); });
  Rng rng(1);
  EXPECT_EQ(free_cells(caves_map(6, 7, 0, rng)), 42);
  EXPECT_EQ(free_cells(caves_map(6, 7, 1, rng)), 0);
  EXPECT_EQ(free_cells(house_map(4, 4, 8, 0, rng)), 16) << "a single room";
  EXPECT_EQ(free_cells(streets_map(9, 9, 2, 3, 1, rng)), 81) << "squares alone";
}

TEST(GridGenerators, LargeMapsHaveRoomsAndWallsToo) {
  Rng rng(2);
  const GridMap map = rooms_map(601, 601, 4, rng);
  EXPECT_EQ(parts(map), 1);
  const double free_share = free_cells(map) / (601.0 * 601.0);
  EXPECT_GT(free_share, 0.3);
  EXPECT_LT(free_share, 0.6);
}

TEST(GridGenerators, MazesReachAThousandCellsASide) {
  Rng rng(3);
  const GridMap map = braided_maze_map(1001, 1001, 1, rng);
  EXPECT_EQ(parts(map), 1);
  EXPECT_EQ(dead_ends(map), 0);
}

TEST(GridGenerators, RoomGridsHaveADoorInEachWall) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    Rng rng(seed);
    const GridMap rooms = room_grid_map(9, 14, 4, 1, rng);  // 2 rows of 3 rooms
    EXPECT_EQ(free_cells(rooms), 6 * 16 + 7);
    EXPECT_EQ(free_edges(rooms), 6 * 24 + 7 * 2) << "a door is on the way between two rooms";
    EXPECT_EQ(parts(rooms), 1);
  }
}

TEST(GridGenerators, RoomGridsKeepTheirLargestPart) {
  Rng rng(1);
  EXPECT_EQ(free_cells(room_grid_map(9, 14, 4, 0, rng)), 16);
  EXPECT_EQ(free_cells(room_grid_map(7, 7, 4, 1, rng)), 36 + 4) << "rooms of 4 by 4, 4 by 2, 2 by 4 and 2 by 2 cells";
  EXPECT_EQ(free_cells(room_grid_map(5, 5, 4, 1, rng)), 16) << "no door where nothing is behind the wall";
  int least = 1000;
  int most = 0;
  for (int i = 0; i < 20; ++i) {
    const GridMap rooms = room_grid_map(24, 24, 4, 0.6, rng);
    EXPECT_EQ(parts(rooms), 1);
    least = std::min(least, free_cells(rooms));
    most = std::max(most, free_cells(rooms));
  }
  EXPECT_LT(least, most);
}

}  // namespace
}  // namespace graphdrl
