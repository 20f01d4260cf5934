#include "graphdrl/io/map_formats.h"

#include <algorithm>
#include <array>

#include "graphdrl/io/ascii_map.h"
#include "graphdrl/io/dimacs.h"
#include "graphdrl/io/edge_list.h"
#include "graphdrl/io/graphml.h"
#include "graphdrl/io/moving_ai.h"
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

template <auto kParse>
AnyMap read(std::string_view text, const std::string& source) {
  return kParse(text, source);
}

constexpr std::array kFormats = {
    MapFormat{.name = "node-link",
              .ending = ".json",
              .purpose = "any graph as JSON, as networkx and D3 write it",
              .recognise = is_node_link,
              .read = read<parse_node_link>,
              .write_graph = format_node_link},
    MapFormat{.name = "graphml",
              .ending = ".graphml",
              .purpose = "any graph as XML, as networkx, igraph, Gephi and yEd write it",
              .recognise = is_graphml,
              .read = read<parse_graphml>,
              .write_graph = format_graphml},
    MapFormat{.name = "moving-ai",
              .ending = ".map",
              .purpose = "grid maps of games, cities and mazes (movingai.com)",
              .recognise = is_moving_ai,
              .read = read<parse_moving_ai>,
              .write_grid = format_moving_ai},
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
    MapFormat{.name = "edge-list",
              .ending = ".csv",
              .purpose = "two nodes and a cost a line: CSV, networkx, igraph, SNAP",
              .recognise = is_edge_list,
              .read = read<parse_edge_list>},
    MapFormat{.name = "ascii",
              .ending = ".txt",
              .purpose = "a grid drawn with '.' (free) and '#' (blocked)",
              .recognise = is_any,
              .read = read<parse_ascii_map>,
              .write_grid = format_ascii_map},
};

}  // namespace

std::span<const MapFormat> map_formats() {
  return kFormats;
}

const MapFormat& format_of(std::string_view text) {
  return *std::find_if(kFormats.begin(), kFormats.end(),
                       [&](const MapFormat& format) { return format.recognise(text); });
}

}  // namespace graphdrl
