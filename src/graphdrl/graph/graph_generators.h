// Random graphs, undirected, every edge of cost 1 unless stated. The same random numbers give the same graph, which
// frozen test sets need; lengths may differ in their last digit between C libraries. Time and memory grow with nodes
// and edges unless stated. REQUIRES everywhere: nodes >= 1.
#pragma once

#include "graphdrl/base/random.h"
#include "graphdrl/graph/graph.h"

namespace graphdrl {

// A tree drawn uniformly from all on these nodes [Aldous 1990; Broder 1989].
Graph random_tree(int nodes, Rng& rng);

// Each pair of nodes an edge with the probability that gives this mean degree [Erdős and Rényi 1959]. Up to 20,000
// nodes each pair draws a number; above, time grows with nodes and edges only. REQUIRES: 0 <= mean_degree < nodes - 1.
Graph erdos_renyi_graph(int nodes, double mean_degree, Rng& rng);

// Nodes join one after the other, each by `links` edges to nodes drawn in proportion to their degree [Barabási and
// Albert 1999]. REQUIRES: links >= 1.
Graph barabasi_albert_graph(int nodes, int links, Rng& rng);

// The same, but after an edge to a node drawn so, each further edge closes a triangle with probability `triads`: it
// leads to a neighbour of that node. Other edges are drawn as before [Holme and Kim 2002; networkx:
// powerlaw_cluster_graph]. REQUIRES: links >= 1, 0 <= triads <= 1.
Graph power_law_cluster_graph(int nodes, int links, double triads, Rng& rng);

// A ring whose nodes are joined to the next `reach` ones on both sides; each edge is led elsewhere with probability
// `rewired` [Watts and Strogatz 1998]. REQUIRES: reach >= 1, 0 <= rewired <= 1.
Graph watts_strogatz_graph(int nodes, int reach, double rewired, Rng& rng);

// Points drawn in a unit square, joined if they are nearer than the radius that gives about this mean degree. With
// `lengths_cost` an edge costs its length, in mean lengths.
Graph geometric_graph(int nodes, double mean_degree, bool lengths_cost, Rng& rng);

// The largest connected part of an undirected graph, its nodes renumbered in ascending order; of equally large ones
// that of the lowest node.
Graph largest_part(const Graph& graph);

// The same edges, at costs drawn uniformly from the integers 1 to `most`.
Graph with_random_costs(const Graph& graph, int most, Rng& rng);

// The same edges. With probability `share` an edge leads one way only, in a random direction.
Graph with_one_way_edges(const Graph& graph, double share, Rng& rng);

}  // namespace graphdrl
