// Graphs with a natural layout, each with the places of its nodes. Undirected, every edge of cost 1 unless stated, no
// node blocked. Time and memory grow with nodes and edges. Places on circles are
// rounded to six digits, so that C libraries agree on nearly all of them.
#pragma once

#include "graphdrl/base/random.h"
#include "graphdrl/graph/graph_map.h"

namespace graphdrl {

// Two paths of this length, each node joined to that opposite [networkx: ladder_graph]. REQUIRES: rungs >= 1.
GraphMap ladder_map(int rungs);

// Regular hexagons side by side, as bricks in a wall: a node has three neighbours, fewer at the border. Two corners may
// be dead ends. REQUIRES: rows, cols >= 1.
GraphMap hexagons_map(int rows, int cols);

// Equilateral triangles side by side: a node has six neighbours, fewer at the border. REQUIRES: rows, cols >= 1.
GraphMap triangles_map(int rows, int cols);

// A lattice without a border: the last row is joined to the first, and so are the columns [networkx: grid_2d_graph with
// periodic=True]. Places are those of a ring seen at a slant. REQUIRES: rows, cols >= 1.
GraphMap torus_map(int rows, int cols);

// A tree filled level by level: each node has `branching` children until there are this many nodes; the last level may
// stay incomplete [networkx: full_rary_tree]. REQUIRES: nodes, branching >= 1.
GraphMap balanced_tree_map(int nodes, int branching);

// Cliques, as equally large as possible, in a ring: in each one the edge between its first two nodes gives way to one
// from the first node to the clique before [Watts 1999; networkx: connected_caveman_graph]. A single clique keeps all
// its edges. REQUIRES: caves >= 1; nodes >= 3 * caves where caves > 1.
GraphMap caveman_map(int nodes, int caves);

// A network of roads: a lattice of crossings 100 m apart, each moved by up to 80 m east and north. A share `kept` of
// the streets is there, with a twentieth of the diagonals in one direction; only the largest connected part is kept.
// With `lengths_cost` an edge costs its length in metres, rounded up; every seventh street winds and is up to twice as
// long. The same random numbers give the same streets with and without lengths. REQUIRES: rows, cols >= 1, 0 <= kept
// <= 1.
GraphMap road_map(int rows, int cols, double kept, bool lengths_cost, Rng& rng);

// The same graph and places, the nodes numbered in random order. REQUIRES: map is one of the above.
GraphMap shuffled(const GraphMap& map, Rng& rng);

}  // namespace graphdrl
