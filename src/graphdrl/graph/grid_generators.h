// Random grid maps. The same random numbers give the same map. REQUIRES everywhere: rows, cols >= 1, rows * cols fits a
// NodeId, shares from 0 to 1.
#pragma once

#include "graphdrl/base/random.h"
#include "graphdrl/graph/grid_map.h"

namespace graphdrl {

// Each cell an obstacle with probability `obstacles`; only the largest connected part stays free.
GridMap random_obstacles_map(int rows, int cols, double obstacles, Rng& rng);

// A perfect maze, corridors one cell wide: rooms are the cells of even row and column, with exactly one way between any
// two. Then each wall cell left between two rooms opens with probability `loops`. REQUIRES: rows and cols are odd.
GridMap maze_map(int rows, int cols, double loops, Rng& rng);

// As maze_map without loops, then each room that is a dead end is opened to another neighbouring room with probability
// `braid`.
GridMap braided_maze_map(int rows, int cols, double braid, Rng& rng);

// Rectangular rooms of 2 to max_room cells a side, joined by corridors one cell wide into one connected map: each room
// to the one drawn before it, and to a near one in maps of more than 250,000 cells.
// REQUIRES: max_room, rows, cols >= 2.
GridMap rooms_map(int rows, int cols, int max_room, Rng& rng);

// Caves: each cell is rock with probability `rock`; then, four times, each becomes what most of it and its neighbours
// are [Johnson, Yannakakis and Togelius 2010]. Only the largest connected part stays free; it may be empty.
GridMap caves_map(int rows, int cols, double rock, Rng& rng);

// A house: walls with a door or two split it into rooms of at most max_room cells a side. Then furniture of up to 2 by
// 3 cells is put into the rooms until it takes a share `furniture` of the floor, or no more fits. Only the largest
// connected part stays free. REQUIRES: max_room >= 2.
GridMap house_map(int rows, int cols, int max_room, double furniture, Rng& rng);

// Streets of 1 to max_street cells between blocks of houses of at most max_block cells a side; a share `squares` of the
// blocks is open. Connected. REQUIRES: max_street, max_block >= 1.
GridMap streets_map(int rows, int cols, int max_street, int max_block, double squares, Rng& rng);

// Rooms of `room` cells a side in rows and columns, cut off at the border, with walls one cell thick between them, as
// in the four rooms of [Sutton, Precup and Singh 1999]. The wall between two rooms has a door at a random place with
// probability `doors`. Only the largest connected part stays free. REQUIRES: room >= 1.
GridMap room_grid_map(int rows, int cols, int room, double doors, Rng& rng);

// The same map with everything but its largest connected part blocked; of equally large ones that of the lowest cell.
GridMap largest_component(const GridMap& map);

}  // namespace graphdrl
