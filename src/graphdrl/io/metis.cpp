#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "graphdrl/base/error.h"
#include "graphdrl/io/readers.h"
#include "graphdrl/io/text.h"

namespace graphdrl {
namespace {

constexpr double kMostInMetis = 1e9;

// The whole numbers of a line, from 0 up; nothing where it has something else.
std::optional<std::vector<double>> numbers_of(std::string_view line) {
  std::vector<double> numbers;
  for (line = trimmed(line); !line.empty();) {
    const auto number = parse_whole(take_word(line), 0, std::numeric_limits<double>::max());
    if (!number) return std::nullopt;
    numbers.push_back(*number);
  }
  return numbers;
}

struct MetisGraph {
  NodeId nodes = 0;
  std::vector<Edge> arcs = {};  // [2M]: every edge from each of its ends
  bool weights_skipped = false;
};

// Nothing where the text is no such file from end to end.
std::optional<MetisGraph> read_metis(std::string_view text) {
  Lines lines(text);
  const auto next_line = [&] {
    while (lines.next()) {
      if (!trimmed(lines.line()).starts_with('%')) return true;
    }
    return false;
  };
  const auto header = next_line() ? numbers_of(lines.line()) : std::nullopt;
  if (!header || header->size() < 2 || header->size() > 4) return std::nullopt;
  const auto said = [&](std::size_t i, double fallback) { return i < header->size() ? (*header)[i] : fallback; };
  const double format = said(2, 0);  // three digits, 0 or 1: sizes, weights, costs
  const auto digit = [&](double place) { return std::fmod(std::floor(format / place), 10); };
  if (format > 111 || digit(100) > 1 || digit(10) > 1 || digit(1) > 1) return std::nullopt;
  if (said(0, 0) < 1 || said(0, 0) > kMostInMetis) return std::nullopt;
  const double skipped = (digit(10) == 1 ? std::max(1.0, said(3, 1)) : 0.0) + digit(100);  // at the begin of a line
  MetisGraph graph{.nodes = static_cast<NodeId>(said(0, 0)), .weights_skipped = skipped > 0};
  const std::size_t step = digit(1) == 1 ? 2 : 1;
  for (NodeId node = 0; node < graph.nodes; ++node) {
    const auto numbers = next_line() ? numbers_of(lines.line()) : std::nullopt;
    if (!numbers || static_cast<double>(numbers->size()) < skipped) return std::nullopt;
    const auto begin = static_cast<std::size_t>(skipped);
    if ((numbers->size() - begin) % step != 0) return std::nullopt;
    for (std::size_t at = begin; at < numbers->size(); at += step) {
      const double other = (*numbers)[at];
      if (other < 1 || other > graph.nodes) return std::nullopt;
      graph.arcs.push_back({node, static_cast<NodeId>(other) - 1, step == 2 ? (*numbers)[at + 1] : 1.0});
    }
  }
  while (next_line()) {
    if (!trimmed(lines.line()).empty()) return std::nullopt;
  }
  if (static_cast<double>(graph.arcs.size()) != 2 * said(1, 0)) return std::nullopt;
  return graph;
}

}  // namespace

bool is_metis(std::string_view text) {
  return read_metis(text).has_value();
}

GraphMap parse_metis(std::string_view text, const std::string& source, const MapOptions& options) {
  auto read = read_metis(text);
  if (!read) {
    throw Error({.what = "not a graph of METIS", .expected = "as many lines and neighbours as said", .where = source});
  }
  const auto ends = [](const Edge& edge) { return std::pair(edge.a, edge.b); };
  const auto by_ends = [&](const Edge& one, const Edge& other) { return ends(one) < ends(other); };
  std::sort(read->arcs.begin(), read->arcs.end(), by_ends);
  for (const Edge& arc : read->arcs) {
    const Edge back{arc.b, arc.a, arc.cost};
    const auto found = std::lower_bound(read->arcs.begin(), read->arcs.end(), back, by_ends);
    if (found != read->arcs.end() && ends(*found) == ends(back) && found->cost == arc.cost) continue;
    throw Error(
        {.what = fmt::format("this looks like a graph of METIS, but edge {} {} is not listed at both of its ends",
                             arc.a + 1, arc.b + 1),
         .expected = "each edge in the lines of both nodes, at one cost",
         .where = source});
  }
  if (options.note) {
    options.note(fmt::format("{}: taken for a graph of METIS: {} nodes and the neighbours of each{}", source,
                             read->nodes, read->weights_skipped ? "; weights and sizes of nodes are skipped" : ""));
  }
  return {.graph = Graph::from_edges(read->nodes, read->arcs),
          .blocked = std::vector<bool>(read->nodes),
          .labels = labels_from_one(read->nodes)};
}

}  // namespace graphdrl
