#include "graphdrl/io/map_formats.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <type_traits>

#include "graphdrl/base/error.h"
#include "graphdrl/io/readers.h"

namespace graphdrl {
namespace {

using enum MapFormat::Option;

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

constexpr MapFormat kFormats[] = {
    {"ros", ".yaml", "occupancy grids of robots: map_server's YAML and picture", is_ros_map, read<parse_ros_map>,
     kUnknown},
    {"graph-walker", ".json", "GraphWalker's models, from which tests are made", is_graph_walker,
     read<parse_graph_walker>, kCostAttribute},
    {"node-link", ".json", "any graph as JSON, as networkx and D3 write it", is_node_link, read<parse_node_link>,
     kBothAttributes, nullptr, format_node_link},
    {"graphml", ".graphml", "any graph as XML, as networkx, igraph, Gephi and yEd write it", is_graphml,
     read<parse_graphml>, kBothAttributes, nullptr, [](const GraphMap& map) { return format_graphml(map); }},
    {"gexf", ".gexf", "any graph as Gephi writes it", is_gexf, read<parse_gexf>, kBothAttributes},
    {"png", ".png", "a grid as a picture: a pixel is a cell, blocked where dark", is_png, read<parse_png_map>,
     kCellPixels, format_png_map},
    {"netpbm", ".pgm", "the same as PGM, PBM or PPM", is_netpbm, read<parse_netpbm_map>, kCellPixels, format_pgm_map},
    {"numpy", ".npy", "adjacency and obstacles as NumPy arrays, as the paper's author writes them", is_numpy,
     read<parse_numpy_map>},
    {"moving-ai", ".map", "grid maps of games, cities and mazes (movingai.com)", is_moving_ai, read<parse_moving_ai>,
     kNoOption, format_moving_ai},
    {"dot", ".dot", "any graph in Graphviz's language", is_dot, read<parse_dot>, kBothAttributes, nullptr,
     [](const GraphMap& map) { return format_dot(map); }},
    {"gml", ".gml", "any graph, as networkx, igraph, Gephi and yEd write it", is_gml, read<parse_gml>, kBothAttributes,
     nullptr, format_gml},
    {"pajek", ".net", "graphs of Pajek, as networkx and igraph write them", is_pajek, read<parse_pajek>},
    {"tsplib", ".oplib", "orienteering problems of OPLib, complete graphs of TSPLIB", is_tsplib, read<parse_tsplib>},
    {"dimacs", ".gr", "graphs of DIMACS' challenges: p edge, p col, p sp", is_dimacs, read<parse_dimacs>},
    {"chao", ".txt", "orienteering problems of Chao, Golden and Wasil, for a team of one", is_chao, read<parse_chao>},
    {"tgf", ".tgf", "nodes, a line '#', and edges: the Trivial Graph Format", is_tgf, read<parse_tgf>, kDirected},
    {"cell-table", ".csv", "a grid as rows of 0 (free) and 1 (blocked)", is_cell_table, read<parse_cell_table>},
    {"metis", ".graph", "graphs of METIS and KaHIP: a line of neighbours for each node", is_metis, read<parse_metis>},
    {"edge-list", ".csv", "two nodes and a cost a line: CSV, networkx, igraph, SNAP", is_own_edge_list,
     read<parse_edge_list>, kCostAttribute | kDirected},
    {"ascii", ".txt", "a grid drawn with '.' (free) and '#' (blocked)", [](std::string_view) { return true; },
     read<parse_drawing>, kNoOption, format_ascii_map},
};

bool can_write(const MapFormat& format) {
  return format.write_grid != nullptr || format.write_graph != nullptr;
}

}  // namespace

std::span<const MapFormat> map_formats() {
  return kFormats;
}

const MapFormat& format_of(std::string_view text) {
  return *std::ranges::find_if(kFormats, [&](const MapFormat& format) { return format.recognise(text); });
}

GraphMap as_graph(const AnyMap& map) {
  const auto* const grid = std::get_if<GridMap>(&map);
  if (grid == nullptr) return std::get<GraphMap>(map);
  GridMap open = *grid;
  open.blocked.assign(open.blocked.size(), false);
  GraphMap graph{.graph = Graph::grid(grid->diagonals ? *grid : open), .blocked = grid->blocked};
  if (!grid->frame) return graph;
  graph.places.unit = grid->frame->unit;
  for (NodeId node = 0; node < graph.graph.node_count(); ++node) graph.places.points.push_back(grid->place(node));
  return graph;
}

std::string format_map(const AnyMap& map, const std::string& file) {
  const std::string ending = std::filesystem::path(file).extension().string();
  const auto* const format =
      std::ranges::find_if(kFormats, [&](const MapFormat& one) { return one.ending == ending && can_write(one); });
  if (format == std::end(kFormats)) {
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
