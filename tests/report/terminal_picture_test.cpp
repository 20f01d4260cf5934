#include "graphdrl/report/terminal_picture.h"

#include <gmock/gmock.h>

#include <cstdlib>
#include <vector>

#include "explored.h"
#include "support.h"

namespace graphdrl {
namespace {

using ::testing::HasSubstr;

std::string without_legend(const std::string& picture, int lines) {
  std::size_t end = 0;
  for (int i = 0; i < lines; ++i) end = picture.find('\n', end) + 1;
  return picture.substr(0, end);
}

// A walk by rows, each in the other direction than the one before.
std::vector<NodeId> back_and_forth(int rows, int cols) {
  std::vector<NodeId> walk;
  for (int row = 0; row < rows; ++row) {
    for (int i = 0; i < cols; ++i) walk.push_back(row * cols + (row % 2 == 0 ? i : cols - 1 - i));
  }
  return walk;
}

TEST(DrawWalk, ShowsHowTheWalkLeavesEachCell) {
  const World world = grid_world("....\n.#..\n");
  EXPECT_EQ(draw_walk(world, std::vector<NodeId>{1, 0, 0, 4, 0, 1, 2, 3}, {.columns = 40}),
            "↓ S → E\n"
            "↑ # . .\n"
            "S start, E end\n"
            "arrows: the first way out of a cell\n"
            ". not visited, # blocked\n");
  EXPECT_THAT(draw_walk(world, std::vector<NodeId>{0, 1, 0}, {}), HasSubstr("S start and end; arrows"));
}

TEST(DrawWalk, ShowsDiagonalSteps) {
  const World world("test", GridMap{.rows = 2, .cols = 3, .blocked = std::vector<bool>(6), .diagonals = true});
  EXPECT_EQ(without_legend(draw_walk(world, std::vector<NodeId>{0, 4, 2, 1, 3}, {}), 2),
            "S ↙ ←\n"
            "E ↗ .\n");
}

TEST(DrawWalk, TakesOneColumnACellWhereTwoDoNotFit) {
  const World world = grid_world("....\n.#..\n");
  EXPECT_EQ(without_legend(draw_walk(world, std::vector<NodeId>{0, 1, 2}, {.columns = 7}), 2), "S→E.\n.#..\n");
}

TEST(DrawWalk, ShadesTheShareVisitedOfLargeMaps) {
  // Nine columns on a screen of five: 2 × 4 cells a character. The walk covers six rows of eight.
  const World world = grid_world(
      "........#\n........#\n........#\n........#\n"
      "........#\n........#\n........#\n........#\n");
  std::vector<NodeId> walk = back_and_forth(6, 9);
  std::erase_if(walk, [&](NodeId node) { return world.is_blocked(node); });
  EXPECT_EQ(without_legend(draw_walk(world, walk, {.columns = 5}), 2), "S███#\nE▒▒▒#\n");
  EXPECT_THAT(draw_walk(world, walk, {.columns = 5}), HasSubstr("a character: 2 × 4 cells\n"));
  EXPECT_EQ(without_legend(draw_walk(world, std::vector<NodeId>{0, 1, 2, 3}, {.columns = 5}), 2), "SE..#\n....#\n");
}

TEST(DrawWalk, FitsTheHeightToo) {
  const World world("tall", GridMap{.rows = 1000, .cols = 3, .blocked = std::vector<bool>(3000)});
  const std::string picture = draw_walk(world, std::vector<NodeId>{0, 1}, {.columns = 80, .lines = 20});
  EXPECT_LE(std::count(picture.begin(), picture.end(), '\n'), 20);
  // Not below what shows something.
  EXPECT_EQ(without_legend(draw_walk(grid_world("..\n..\n"), std::vector<NodeId>{0, 1}, {.lines = -5}), 2),
            "S E\n. .\n");
}

TEST(DrawWalk, ChangesColoursOnlyWhereTheyDiffer) {
  const std::string missed = "\033[38;5;16;48;5;216m";
  const std::string blocked = "\033[38;5;16;48;5;16m";
  const std::string first = "\033[38;5;231;48;5;54m";
  const World world = grid_world(".#\n..\n");
  const std::string picture = draw_walk(world, std::vector<NodeId>{0}, {.colour = true});
  EXPECT_EQ(without_legend(picture, 2), first + "S " + blocked + "  \033[0m\n" + missed + ". . \033[0m\n");
  EXPECT_THAT(picture, HasSubstr("orange: not visited; black: blocked"));
  // Two pixels a character, of two cells each.
  const World wide = grid_world("....\n....\n##..\n##..\n");
  EXPECT_THAT(draw_walk(wide, std::vector<NodeId>{3}, {.columns = 2, .colour = true}),
              HasSubstr("\033[38;5;216;48;5;16m▀\033[38;5;16;48;5;231mS\033[0m\n"));
}

TEST(DrawWalk, LeavesBlankWhatAWalkThatExploresHasNotSeen) {
  const World world = grid_world("....\n.##.\n....\n");
  const std::vector<NodeId> walk = {1, 0};
  const Fog fog(explored(world, "edges", walk));
  EXPECT_EQ(draw_walk(world, walk, {.columns = 60}, fog),
            "E S .\n"
            ". # #\n"
            "\n"
            "S start, E end; arrows: the first way out of a cell\n"
            ". not visited, # blocked, blank: not seen\n");
  const std::string coloured = draw_walk(world, walk, {.colour = true}, fog);
  EXPECT_THAT(coloured, HasSubstr("\n\033[38;5;16;48;5;145m        \033[0m\n"));
  EXPECT_THAT(coloured, HasSubstr("grey: not seen"));
}

TEST(DrawWalk, ShadesTheShareVisitedOfWhatWasSeen) {
  // Two by four cells a character. The third has two cells visited of four seen, the last has none seen.
  const World world = grid_world("..........\n..........\n..........\n..........\n");
  const std::vector<NodeId> walk = {0, 1, 2, 3, 4, 5, 6};
  const std::string known = draw_walk(world, walk, {.columns = 5});
  const std::string fogged = draw_walk(world, walk, {.columns = 5}, Fog(explored(world, "edges", walk)));
  EXPECT_EQ(without_legend(known, 1), "S░░E.\n");
  EXPECT_EQ(without_legend(fogged, 1), "S▒▒E\n");
}

TEST(ScreenOf, AFileHasTheColumnsOfTheEnvironmentAndNoColours) {
  const TemporaryFolder folder;
  std::FILE* const file = std::fopen((folder / "out").c_str(), "w");
  ASSERT_NE(file, nullptr);
  setenv("COLUMNS", "33", 1);
  EXPECT_EQ(screen_of(file).columns, 33);
  EXPECT_FALSE(screen_of(file).colour);
  setenv("COLUMNS", "many", 1);
  EXPECT_EQ(screen_of(file).columns, 80);
  unsetenv("COLUMNS");
  EXPECT_EQ(screen_of(file).columns, 80);
  std::fclose(file);
}

}  // namespace
}  // namespace graphdrl
