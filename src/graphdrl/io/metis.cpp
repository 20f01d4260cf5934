#include "graphdrl/io/metis.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "graphdrl/base/error.h"
#include "graphdrl/io/text.h"

namespace graphdrl {
namespace {

constexpr double kMostInMetis = 1e9;

// The whole numbers of a line, from 0 up; nothing where it has something else.
std::optional<std::vector<double>> numbers_of(std::string_view line) {
  std::vector<double> numbers;
  for (line = trimmed(line); !line.empty(); line = trimmed(line)) {
    const std::string_view word = line.substr(0, line.find_first_of(" \t"));
    const auto number = parse_number(word);
    if (!number || *number < 0 || *number != std::floor(*number)) return std::nullopt;
    numbers.push_back(*number);
    line.remove_prefix(word.size());
  }
  return numbers;
}

struct MetisGraph {
  NodeId nodes = 0;
  std::vector<Edge> arcs;  // [2M]: every edge from each of its ends
  bool weights_skipped = false;
};

class MetisReader {
 public:
  explicit MetisReader(std::string_view text) : lines_(text) {}

  // Nothing where the text is no such file.
  std::optional<MetisGraph> read() {
    if (!next_line() || !read_header()) return std::nullopt;
    for (NodeId node = 0; node < graph_.nodes; ++node) {
      if (!next_line() || !read_node(node)) return std::nullopt;
    }
    while (next_line()) {
      if (!trimmed(lines_.line()).empty()) return std::nullopt;
    }
    if (static_cast<double>(graph_.arcs.size()) != 2 * edges_) return std::nullopt;
    return std::move(graph_);
  }

 private:
  bool next_line() {
    while (lines_.next()) {
      if (!trimmed(lines_.line()).starts_with('%')) return true;
    }
    return false;
  }

  bool read_header() {
    const auto header = numbers_of(lines_.line());
    if (!header || header->size() < 2 || header->size() > 4) return false;
    const std::vector<double>& numbers = *header;
    if (numbers[0] < 1 || numbers[0] > kMostInMetis) return false;
    graph_.nodes = static_cast<NodeId>(numbers[0]);
    edges_ = numbers[1];
    const double format = numbers.size() > 2 ? numbers[2] : 0;  // three digits, 0 or 1: sizes, weights, costs
    const auto digit = [&](double place) { return std::fmod(std::floor(format / place), 10); };
    if (format > 111 || digit(100) > 1 || digit(10) > 1 || digit(1) > 1) return false;
    costs_ = digit(1) == 1;
    skipped_ = (digit(10) == 1 ? std::max(1.0, numbers.size() > 3 ? numbers[3] : 1.0) : 0.0) + digit(100);
    graph_.weights_skipped = skipped_ > 0;
    return true;
  }

  bool read_node(NodeId node) {
    const auto numbers = numbers_of(lines_.line());
    if (!numbers || static_cast<double>(numbers->size()) < skipped_) return false;
    const std::size_t step = costs_ ? 2 : 1;
    std::size_t at = static_cast<std::size_t>(skipped_);
    for (; at + step <= numbers->size(); at += step) {
      const double other = (*numbers)[at];
      if (other < 1 || other > graph_.nodes) return false;
      graph_.arcs.push_back({node, static_cast<NodeId>(other) - 1, costs_ ? (*numbers)[at + 1] : 1.0});
    }
    return at == numbers->size();
  }

  Lines lines_;
  MetisGraph graph_;
  double edges_ = 0;
  bool costs_ = false;
  double skipped_ = 0;  // numbers at the begin of a line
};

}  // namespace

bool is_metis(std::string_view text) {
  return MetisReader(text).read().has_value();
}

GraphMap parse_metis(std::string_view text, const std::string& source, const MapOptions& options) {
  auto read = MetisReader(text).read();
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
  if (read->weights_skipped && options.note) options.note(source + ": weights and sizes of METIS's nodes are skipped");
  GraphMap map{
      .graph = Graph::from_edges(read->nodes, read->arcs), .blocked = std::vector<bool>(read->nodes), .labels = {}};
  for (NodeId node = 1; node <= read->nodes; ++node) map.labels.push_back(std::to_string(node));
  return map;
}

}  // namespace graphdrl
