#include "graphdrl/io/dimacs.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "graphdrl/base/error.h"
#include "graphdrl/io/graph_builder.h"
#include "graphdrl/io/text.h"

namespace graphdrl {
namespace {

constexpr int kMostWords = 4;

// The words of a line, and how many there are: at most one more than a line may have.
struct Words {
  explicit Words(std::string_view line) {
    for (line = trimmed(line); !line.empty() && count <= kMostWords; line = trimmed(line)) {
      const std::size_t end = std::min(line.find_first_of(" \t"), line.size());
      words[count++] = line.substr(0, end);
      line.remove_prefix(end);
    }
  }
  std::string_view operator[](int i) const { return words[i]; }

  std::array<std::string_view, kMostWords + 1> words;
  int count = 0;
};

bool is_dimacs_comment(const Words& words) {
  return words.count == 0 || words[0] == "c";
}

class DimacsReader {
 public:
  DimacsReader(std::string_view text, const std::string& source)
      : lines_(text), most_nodes_(static_cast<double>(most_nodes_of(text))), source_(source) {}

  GraphMap read() {
    while (lines_.next()) {
      const Words words(lines_.line());
      if (is_dimacs_comment(words)) continue;
      if (words[0] == "p") {
        read_problem(words);
      } else {
        read_edge(words);
      }
    }
    const auto found = static_cast<double>(edges_.size());
    const bool twice = !arcs_ && (2 * found == said_ || found == 2 * said_);
    if (found != said_ && !twice) {
      throw Error({.what = "another number of edges than the file says",
                   .expected = fmt::format("{}", said_),
                   .got = std::to_string(edges_.size()),
                   .where = source_});
    }
    GraphMap map{.graph = Graph::from_edges(nodes_, edges_, arcs_ ? EdgeKind::kDirected : EdgeKind::kUndirected),
                 .blocked = std::vector<bool>(nodes_),
                 .labels = {}};
    for (NodeId node = 1; node <= nodes_; ++node) map.labels.push_back(std::to_string(node));
    return map;
  }

 private:
  [[noreturn]] void fail(const std::string& what, const std::string& expected) const {
    throw Error({.what = what,
                 .expected = expected,
                 .got = in_quotes(lines_.line()),
                 .where = fmt::format("{}:{}", source_, lines_.number())});
  }

  // A whole number from `least` to `most`.
  double whole(std::string_view word, double least, double most, const std::string& expected) const {
    const auto number = parse_number(word);
    if (!number || *number < least || *number > most || *number != std::floor(*number)) fail("bad number", expected);
    return *number;
  }

  void read_problem(const Words& words) {
    if (nodes_ != 0) fail("a second problem", "one line `p …`");
    const bool known = words[1] == "edge" || words[1] == "col" || words[1] == "sp";
    if (words.count != 4 || !known) fail("bad problem", "p edge, p col or p sp, and the numbers of nodes and edges");
    arcs_ = words[1] == "sp";
    nodes_ = static_cast<NodeId>(whole(
        words[2], 1, most_nodes_, fmt::format("a number of nodes from 1 to {}, for a file of this size", most_nodes_)));
    said_ = whole(words[3], 0, 1e18, "a number of edges");
  }

  void read_edge(const Words& words) {
    if (nodes_ == 0) fail("no problem before the first edge", "a line `p …`");
    if (words[0] != (arcs_ ? "a" : "e") || words.count != (arcs_ ? 4 : 3)) {
      fail("strange line", arcs_ ? "an arc `a U V COST`" : "an edge `e U V`");
    }
    const std::string nodes = fmt::format("nodes from 1 to {}", nodes_);
    const auto from = static_cast<NodeId>(whole(words[1], 1, nodes_, nodes)) - 1;
    const auto to = static_cast<NodeId>(whole(words[2], 1, nodes_, nodes)) - 1;
    double cost = 1;
    if (arcs_) {
      const auto number = parse_number(words[3]);
      if (!number || *number < 0) fail("bad cost", "a number from 0 up");
      cost = *number;
    }
    edges_.push_back({from, to, cost});
  }

  Lines lines_;
  double most_nodes_;
  const std::string& source_;
  bool arcs_ = false;
  NodeId nodes_ = 0;
  double said_ = 0;
  std::vector<Edge> edges_;
};

}  // namespace

bool is_dimacs(std::string_view text) {
  Lines lines(text);
  while (lines.next()) {
    const Words words(lines.line());
    if (is_dimacs_comment(words)) continue;
    return words[0] == "p" && words.count == 4;
  }
  return false;
}

GraphMap parse_dimacs(std::string_view text, const std::string& source) {
  return DimacsReader(text, source).read();
}

}  // namespace graphdrl
