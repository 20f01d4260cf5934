#include "graphdrl/io/map_formats.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <type_traits>

#include "graphdrl/base/error.h"
#include "graphdrl/io/ascii_map.h"
#include "graphdrl/io/cell_table.h"
#include "graphdrl/io/chao.h"
#include "graphdrl/io/dimacs.h"
#include "graphdrl/io/dot.h"
#include "graphdrl/io/edge_list.h"
#include "graphdrl/io/foreign.h"
#include "graphdrl/io/gexf.h"
#include "graphdrl/io/gml.h"
#include "graphdrl/io/graph_walker.h"
#include "graphdrl/io/graphml.h"
#include "graphdrl/io/metis.h"
#include "graphdrl/io/moving_ai.h"
#include "graphdrl/io/numpy_map.h"
#include "graphdrl/io/pajek.h"
#include "graphdrl/io/picture.h"
#include "graphdrl/io/ros_map.h"
#include "graphdrl/io/tgf.h"
#include "graphdrl/io/tsplib.h"

namespace graphdrl {
namespace {

bool is_node_link(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(" \t\r\n");
  return begin != std::string_view::npos && text[begin] == '{';
}

bool is_any(std::string_view /*text*/) {
  return true;
}

bool is_own_edge_list(std::string_view text) {
  return is_edge_list(text) && !is_foreign(text);
}

GridMap parse_drawing(std::string_view text, const std::string& source) {
  const std::size_t begin = text.find_first_not_of(" \t\r\n");
  if (begin != std::string_view::npos && text[begin] != '.' && text[begin] != '#') refuse_foreign(text, source);
  return parse_ascii_map(text, source);
}

template <auto kParse>
AnyMap read(std::string_view text, const std::string& source, const MapOptions& options) {
  if constexpr (std::is_invocable_v<decltype(kParse), std::string_view, const std::string&, const MapOptions&>) {
    return kParse(text, source, options);
  } else {
    return kParse(text, source);
  }
}

constexpr std::array kFormats = {
    MapFormat{.name = "ros",
              .ending = ".yaml",
              .purpose = "occupancy grids of robots: map_server's YAML and picture",
              .recognise = is_ros_map,
              .read = read<parse_ros_map>,
              .takes_unknown = true},
    MapFormat{.name = "graph-walker",
              .ending = ".json",
              .purpose = "GraphWalker's models, from which tests are made",
              .recognise = is_graph_walker,
              .read = read<parse_graph_walker>,
              .takes_cost_attribute = true},
    MapFormat{.name = "node-link",
              .ending = ".json",
              .purpose = "any graph as JSON, as networkx and D3 write it",
              .recognise = is_node_link,
              .read = read<parse_node_link>,
              .write_graph = format_node_link,
              .takes_cost_attribute = true,
              .takes_prize_attribute = true},
    MapFormat{.name = "graphml",
              .ending = ".graphml",
              .purpose = "any graph as XML, as networkx, igraph, Gephi and yEd write it",
              .recognise = is_graphml,
              .read = read<parse_graphml>,
              .write_graph = format_graphml,
              .takes_cost_attribute = true,
              .takes_prize_attribute = true},
    MapFormat{.name = "gexf",
              .ending = ".gexf",
              .purpose = "any graph as Gephi writes it",
              .recognise = is_gexf,
              .read = read<parse_gexf>,
              .takes_cost_attribute = true,
              .takes_prize_attribute = true},
    MapFormat{.name = "png",
              .ending = ".png",
              .purpose = "a grid as a picture: a pixel is a cell, blocked where dark",
              .recognise = is_png,
              .read = read<parse_png_map>,
              .write_grid = format_png_map,
              .takes_cell_pixels = true},
    MapFormat{.name = "netpbm",
              .ending = ".pgm",
              .purpose = "the same as PGM, PBM or PPM",
              .recognise = is_netpbm,
              .read = read<parse_netpbm_map>,
              .write_grid = format_pgm_map,
              .takes_cell_pixels = true},
    MapFormat{.name = "numpy",
              .ending = ".npy",
              .purpose = "adjacency and obstacles as NumPy arrays, as the paper's author writes them",
              .recognise = is_numpy,
              .read = read<parse_numpy_map>},
    MapFormat{.name = "moving-ai",
              .ending = ".map",
              .purpose = "grid maps of games, cities and mazes (movingai.com)",
              .recognise = is_moving_ai,
              .read = read<parse_moving_ai>,
              .write_grid = format_moving_ai},
    MapFormat{.name = "dot",
              .ending = ".dot",
              .purpose = "any graph in Graphviz's language",
              .recognise = is_dot,
              .read = read<parse_dot>,
              .write_graph = format_dot,
              .takes_cost_attribute = true,
              .takes_prize_attribute = true},
    MapFormat{.name = "gml",
              .ending = ".gml",
              .purpose = "any graph, as networkx, igraph, Gephi and yEd write it",
              .recognise = is_gml,
              .read = read<parse_gml>,
              .write_graph = format_gml,
              .takes_cost_attribute = true,
              .takes_prize_attribute = true},
    MapFormat{.name = "pajek",
              .ending = ".net",
              .purpose = "graphs of Pajek, as networkx and igraph write them",
              .recognise = is_pajek,
              .read = read<parse_pajek>},
    MapFormat{.name = "tsplib",
              .ending = ".oplib",
              .purpose = "orienteering problems of OPLib, complete graphs of TSPLIB",
              .recognise = is_tsplib,
              .read = read<parse_tsplib>},
    MapFormat{.name = "dimacs",
              .ending = ".gr",
              .purpose = "graphs of DIMACS' challenges: p edge, p col, p sp",
              .recognise = is_dimacs,
              .read = read<parse_dimacs>},
    MapFormat{.name = "chao",
              .ending = ".txt",
              .purpose = "orienteering problems of Chao, Golden and Wasil, for a team of one",
              .recognise = is_chao,
              .read = read<parse_chao>},
    MapFormat{.name = "tgf",
              .ending = ".tgf",
              .purpose = "nodes, a line '#', and edges: the Trivial Graph Format",
              .recognise = is_tgf,
              .read = read<parse_tgf>,
              .takes_directed = true},
    MapFormat{.name = "cell-table",
              .ending = ".csv",
              .purpose = "a grid as rows of 0 (free) and 1 (blocked)",
              .recognise = is_cell_table,
              .read = read<parse_cell_table>},
    MapFormat{.name = "metis",
              .ending = ".graph",
              .purpose = "graphs of METIS and KaHIP: a line of neighbours for each node",
              .recognise = is_metis,
              .read = read<parse_metis>},
    MapFormat{.name = "edge-list",
              .ending = ".csv",
              .purpose = "two nodes and a cost a line: CSV, networkx, igraph, SNAP",
              .recognise = is_own_edge_list,
              .read = read<parse_edge_list>,
              .takes_cost_attribute = true,
              .takes_directed = true},
    MapFormat{.name = "ascii",
              .ending = ".txt",
              .purpose = "a grid drawn with '.' (free) and '#' (blocked)",
              .recognise = is_any,
              .read = read<parse_drawing>,
              .write_grid = format_ascii_map},
};

bool can_write(const MapFormat& format) {
  return format.write_grid != nullptr || format.write_graph != nullptr;
}

}  // namespace

std::span<const MapFormat> map_formats() {
  return kFormats;
}

const MapFormat& format_of(std::string_view text) {
  return *std::find_if(kFormats.begin(), kFormats.end(),
                       [&](const MapFormat& format) { return format.recognise(text); });
}

GraphMap as_graph(const AnyMap& map) {
  const auto* const grid = std::get_if<GridMap>(&map);
  if (grid == nullptr) return std::get<GraphMap>(map);
  GridMap open = *grid;
  open.blocked.assign(open.blocked.size(), false);
  GraphMap graph{.graph = Graph::grid(grid->diagonals ? *grid : open), .blocked = grid->blocked, .labels = {}};
  if (!grid->frame) return graph;
  graph.places.unit = grid->frame->unit;
  for (NodeId node = 0; node < graph.graph.node_count(); ++node) graph.places.points.push_back(grid->place(node));
  return graph;
}

std::string format_map(const AnyMap& map, const std::string& file) {
  const std::string ending = std::filesystem::path(file).extension().string();
  const auto* const format = std::find_if(kFormats.begin(), kFormats.end(),
                                          [&](const MapFormat& one) { return one.ending == ending && can_write(one); });
  if (format == kFormats.end()) {
    std::string endings;
    for (const MapFormat& one : kFormats) {
      if (can_write(one)) endings += fmt::format("{}{}", endings.empty() ? "" : ", ", one.ending);
    }
    throw Error({.what = "no format with this ending can be written", .expected = endings, .where = file});
  }
  const auto* const grid = std::get_if<GridMap>(&map);
  if (grid != nullptr && format->write_grid != nullptr) return format->write_grid(*grid);
  if (format->write_graph == nullptr) {
    throw Error({.what = "this format holds grids only", .expected = "another ending", .where = file});
  }
  return format->write_graph(as_graph(map));
}

}  // namespace graphdrl
