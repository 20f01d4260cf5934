// Random grid maps. The same random numbers give the same map. REQUIRES everywhere: rows, cols >= 1, rows * cols fits a
// NodeId, shares from 0 to 1.
#pragma once

#include "graphdrl/base/random.h"
#include "graphdrl/graph/grid_map.h"

namespace graphdrl {

// Each cell an obstacle with probability `obstacles`; only the largest connected part stays free.
GridMap random_obstacles_map(int rows, int cols, double obstacles, Rng& rng);

// A perfect maze, corridors one cell wide: rooms on the cells of even row and column, exactly one way between any two;
// then each inner wall cell between two rooms that is left opens with probability `loops`. REQUIRES: rows and cols are
// odd.
GridMap maze_map(int rows, int cols, double loops, Rng& rng);

// As maze_map without loops, then each room that is a dead end is opened to another neighbouring room with probability
// `braid`.
GridMap braided_maze_map(int rows, int cols, double braid, Rng& rng);

// Rectangular rooms of 2 to max_room cells a side, joined by corridors one cell wide into one connected map: each room
// to the one drawn before it, and to a near one in maps of more than 250,000 cells.
// REQUIRES: max_room, rows, cols >= 2.
GridMap rooms_map(int rows, int cols, int max_room, Rng& rng);

// Caves: each cell rock with probability `rock`, then four times over what most cells around and on it are [Johnson,
// Yannakakis and Togelius 2010]; only the largest connected part stays free, which may be none.
GridMap caves_map(int rows, int cols, double rock, Rng& rng);

// A house: walls split it into rooms of at most max_room cells a side, each wall with a door or two; then furniture of
// up to 2 by 3 cells is put into the rooms until a share `furniture` of the floor is taken, or no place is found for
// more. Only the largest connected part stays free. REQUIRES: max_room >= 2.
GridMap house_map(int rows, int cols, int max_room, double furniture, Rng& rng);

// Streets of 1 to max_street cells between blocks of houses of at most max_block cells a side; a share `squares` of the
// blocks is open. Connected. REQUIRES: max_street, max_block >= 1.
GridMap streets_map(int rows, int cols, int max_street, int max_block, double squares, Rng& rng);

// The same map with everything but its largest connected part blocked; of equally large ones that of the lowest cell.
GridMap largest_component(const GridMap& map);

}  // namespace graphdrl
