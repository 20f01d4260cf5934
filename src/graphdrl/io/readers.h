// The readers and writers of map formats, each in the source of its name. docs/formats.md describes the formats.
//
// is_NAME knows a text by its content. parse_NAME throws Error, naming `source` and mostly the line, on anything that
// is not of the format, on values out of range and on a map without a free node. What it guesses or leaves out it tells
// options.note. Attributes of nodes and edges count by their usual names [attributes.h], defaults too; other ones are
// skipped. format_NAME ends with a line break; of a graph it keeps all but the task. Loops, parallel edges and names of
// edges are kept by node-link JSON, GraphML and DOT.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "graphdrl/io/any_map.h"

namespace graphdrl {

// The bytes of a file as its reader takes them: unpacked where they are gzipped. Pictures and arrays stay as they are.
// Texts are UTF-8 without a byte order mark, from UTF-16 too, and their lines end with "\n"; what is neither is read as
// Latin-1, with a note where the text does not say so itself. Throws Error, naming `source`, on an archive of another
// kind, and on one that is damaged or unpacks to more than a gibibyte.
std::string map_text(std::string bytes, const std::string& source, const std::function<void(const std::string&)>& note);

// Grids

// '.' a free cell, '#' a blocked one; rows of one length, empty lines at the end are skipped.
GridMap parse_ascii_map(std::string_view text, const std::string& source);
std::string format_ascii_map(const GridMap& map);

// Rows of 0 (free) and 1 (blocked), with commas, semicolons, tabs, spaces or nothing between the cells; at least two
// columns, and no list of edges between two nodes 0 and 1.
bool is_cell_table(std::string_view text);
GridMap parse_cell_table(std::string_view text, const std::string& source, const MapOptions& options = {});

// MovingAI's grids: `type octile`, `height H`, `width W` and `map`, then H rows of W characters [Sturtevant 2012,
// movingai.com]. '.' and 'G' are ground, 'S', swamp, can be walked from it, and 'E' and 'S' are a warehouse's stations
// [League of Robot Runners]: free. '@' and 'O', out of bounds, 'T', trees, and 'W', water, which is not to be reached
// from ground: blocked.
bool is_moving_ai(std::string_view text);
GridMap parse_moving_ai(std::string_view text, const std::string& source);
std::string format_moving_ai(const GridMap& map);

// PNG, and P1 to P6 of Netpbm: a cell for every options.cell_pixels × options.cell_pixels pixels, blocked where one of
// them is darker than half. Colours count by their brightness; what is transparent is white. Pixels beyond the last
// whole cell are left out. Written a pixel a cell, black where blocked, white where free.
bool is_png(std::string_view bytes);
bool is_netpbm(std::string_view bytes);
GridMap parse_png_map(std::string_view bytes, const std::string& source, const MapOptions& options = {});
GridMap parse_netpbm_map(std::string_view bytes, const std::string& source, const MapOptions& options = {});
std::string format_png_map(const GridMap& map);
std::string format_pgm_map(const GridMap& map);

// The Robot Operating System's YAML file with its picture [wiki.ros.org/map_server; nav2's map_io; docs/formats.md].
// Unless given, occupied_thresh is 0.65, free_thresh 0.196 and mode trinary. Unknown cells are blocked unless
// options.unknown_is_free; a raw value above 100 is unknown. The frame is that of the file, in metres. Reads no file
// outside of the folder: of an absolute path elsewhere, the file of that name beside the YAML file.
bool is_ros_map(std::string_view text);
GridMap parse_ros_map(std::string_view text, const std::string& source, const MapOptions& options = {});

// The environments of the paper's author [numpy.org, the NPY format]: [2, N, N] in float64, float32 or whole numbers,
// the adjacency matrix, 0 for no edge, and a matrix with ones on the diagonal at obstacles; or [N, N], the adjacency
// matrix alone. Other values of it than 1 are costs. A matrix that is not symmetric gives a directed graph. Where N is
// a square and the edges are those of a grid, with those of obstacles or without, the map is a grid.
bool is_numpy(std::string_view bytes);
AnyMap parse_numpy_map(std::string_view bytes, const std::string& source);

// Graphs with attributes

// An attribute of nodes that is not the map's own, to be written with it.
struct NodeColumn {
  std::string name = {};
  std::vector<std::string> values = {};  // [N]; empty texts are left out
};

// Node-link form, as networkx's node_link_data and D3 write it: {"directed": false, "nodes": [{"id": "a", "blocked":
// true, "prize": 3}, …], "links": [{"source": "a", "target": "b", "weight": 2}, …]}. Nodes are numbered as they stand.
// Ids are whole numbers, texts or lists of them, which become texts like "(0, 1)". {"graph": {"unit": "m"}} is the
// coordinates' unit; `links` may be called `edges`; keys may stand in any order. Cost: linear, without a copy of the
// document; the text is read twice where links stand before nodes.
bool is_node_link(std::string_view text);
GraphMap parse_node_link(std::string_view text, const std::string& source, const MapOptions& options = {});
std::string format_node_link(const GraphMap& map);

// One model of GraphWalker [graphwalker.github.io/json-files]: a directed graph. Vertices go by their names where these
// are all different, else by their ids; `properties` may hold x and y. The model's startElementId, or else its only
// edge from nowhere, names the start. A `weight` is a probability: edges cost 1, unless the options name an attribute.
bool is_graph_walker(std::string_view text);
GraphMap parse_graph_walker(std::string_view text, const std::string& source, const MapOptions& options = {});

// One graph in GraphML [Brandes et al. 2002, graphml.graphdrawing.org], directed where it or one of its edges says so;
// an edge that does not lead one way leads both ways then. yEd's texts and coordinates of nodes count. Graphs within
// nodes, yEd's groups, are part of the graph; a node with a graph that no edge leads to is left out.
bool is_graphml(std::string_view text);
GraphMap parse_graphml(std::string_view text, const std::string& source, const MapOptions& options = {});
std::string format_graphml(const GraphMap& map, const NodeColumn& column = {});

// One graph in GEXF, Gephi's own format [gexf.net], directed as in GraphML. `weight` of edges, `label` and
// `viz:position` of nodes count too. Nodes within nodes are nodes of the graph.
bool is_gexf(std::string_view text);
GraphMap parse_gexf(std::string_view text, const std::string& source, const MapOptions& options = {});

// One graph in the Graph Modelling Language [Himsolt 1997]: graph [ directed 0 node [ id 1 label "a" graphics [ x 0 y 2
// ] ] edge [ source 1 target 2 weight 3 ] ]. Coordinates may stand in `graphics`. What is not ASCII in labels is
// written as &#N;, as the format asks.
bool is_gml(std::string_view text);
GraphMap parse_gml(std::string_view text, const std::string& source, const MapOptions& options = {});
std::string format_gml(const GraphMap& map);

// One graph in Graphviz's language [graphviz.org/doc/info/lang.html], graphs within it, defaults of nodes and edges,
// and ports. Nodes are numbered as they come. `pos`, "x,y", is where a node lies. A node `__start…` without a label
// that no edge leads to points at the start, and is left out. (Boost.Graph's reader, 1.74, knows no graphs without a
// name.)
bool is_dot(std::string_view text);
GraphMap parse_dot(std::string_view text, const std::string& source, const MapOptions& options = {});
std::string format_dot(const GraphMap& map, const NodeColumn& column = {});

// Graphs without attributes

// Pajek, as networkx and igraph write it: *Vertices N, then lines `1 "label" x y`; *Edges and *Arcs with lines
// `1 2 cost`, *Edgeslist and *Arcslist with lines `1 2 3`, a node and its neighbours, *Matrix with a row of costs a
// node, 0 for no edge [Batagelj and Mrvar 1998]. Nodes are numbered from 1; those without a line are called by their
// numbers. One arc makes the graph directed. Lines that begin with '%' are comments.
bool is_pajek(std::string_view text);
GraphMap parse_pajek(std::string_view text, const std::string& source, const MapOptions& options = {});

// The Trivial Graph Format, as yEd writes it: a node a line, `ID LABEL`, a line `#`, and an edge a line, `FROM TO
// LABEL`; labels may be missing. An edge's label that is a number is its cost; else it costs 1. Edges lead both ways,
// unless options.directed.
bool is_tgf(std::string_view text);
GraphMap parse_tgf(std::string_view text, const std::string& source, const MapOptions& options = {});

// METIS and KaHIP: `N M [FORMAT [WEIGHTS]]`, then a line for each node with its neighbours, numbered from 1, each
// followed by the cost of the edge where FORMAT ends in 1; sizes and weights of nodes are skipped [Karypis, METIS 5
// manual]. Lines that begin with '%' are comments. Undirected; labels are the file's numbers. An edge is listed at both
// of its ends, at one cost. is_metis reads all of the text.
bool is_metis(std::string_view text);
GraphMap parse_metis(std::string_view text, const std::string& source, const MapOptions& options = {});

// `p edge N M` or `p col N M` and lines `e U V`: undirected, every edge costs 1 [DIMACS 1993, cliques and colouring].
// `p sp N M` and lines `a U V COST`: directed [DIMACS 2006, shortest paths]. Nodes are numbered from 1, and labelled
// so. The file holds as many edges as it says; of undirected ones it may hold or say each twice.
bool is_dimacs(std::string_view text);
GraphMap parse_dimacs(std::string_view text, const std::string& source);

// OPLib's orienteering problems and TSPLIB's complete graphs with whole costs [Reinelt 1991, TSPLIB;
// github.com/bcamath-ds/OPLib]. TYPE is OP or TSP, whatever comment follows. EDGE_WEIGHT_TYPE is EUC_2D, CEIL_2D, GEO
// or ATT, whose costs are computed from NODE_COORD_SECTION when they are asked for, or EXPLICIT: FULL_MATRIX,
// symmetric, or {UPPER,LOWER}[_DIAG]_ROW. COST_LIMIT is the budget, NODE_SCORE_SECTION holds the prizes, 1 each where
// there is none, and the node of DEPOT_SECTION is start and end. Labels are the file's numbers, from 1. Numbers in
// sections are at most 1e15. Keywords and sections stand in any order; only COMMENT may come twice. Cost: O(N²).
bool is_tsplib(std::string_view text);
GraphMap parse_tsplib(std::string_view text, const std::string& source, const MapOptions& options = {});

// Team orienteering problems, for a team of one: `n PLACES`, `m TEAM` and `tmax LIMIT`, then a line `X Y SCORE` for
// each place: a complete graph whose costs are the distances, not rounded [Chao, Golden and Wasil 1996]. The walk
// begins at the first place and ends at the last one; LIMIT is its budget, scores are prizes. Cost: O(N²).
bool is_chao(std::string_view text);
GraphMap parse_chao(std::string_view text, const std::string& source, const MapOptions& options = {});

// Two nodes a line, and a cost, 1 unless given, as networkx, igraph, SNAP and spreadsheets write them: fields between
// tabs, semicolons, commas or spaces, a header where there is one, and what a comment or a column says of directions
// [docs/formats.md]. Node ids are any texts; nodes are numbered as they come. Edges lead both ways unless the file or
// options.directed says so. Refuses a table of coordinates or nodes. is_edge_list looks at the first line that is no
// comment.
bool is_edge_list(std::string_view text);
GraphMap parse_edge_list(std::string_view text, const std::string& source, const MapOptions& options = {});

// Files that are known by their content, and cannot be read: says what the text looks like, and what to do; also of one
// that nothing is known about.
bool is_foreign(std::string_view text);
[[noreturn]] void refuse_foreign(std::string_view text, const std::string& source);

}  // namespace graphdrl
