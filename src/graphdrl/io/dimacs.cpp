#include <fmt/format.h>

#include "graphdrl/base/error.h"
#include "graphdrl/io/graph_builder.h"
#include "graphdrl/io/readers.h"
#include "graphdrl/io/text.h"

namespace graphdrl {
namespace {

// Goes to the next line that is no comment, `c …`, and gives its words. False after the last.
bool next_words(Lines& lines, std::vector<std::string_view>& words) {
  do {
    if (!lines.next()) return false;
    words.clear();
    for (std::string_view rest = trimmed(lines.line()); !rest.empty();) words.push_back(take_word(rest));
  } while (words.empty() || words[0] == "c");
  return true;
}

class DimacsReader {
 public:
  DimacsReader(std::string_view text, const std::string& source)
      : lines_(text, source), most_nodes_(static_cast<double>(most_nodes_of(text))), source_(source) {}

  GraphMap read() {
    while (next_words(lines_, words_)) words_[0] == "p" ? read_problem() : read_edge();
    const auto found = static_cast<double>(edges_.size());
    const bool twice = !arcs_ && (2 * found == said_ || found == 2 * said_);
    if (found != said_ && !twice) {
      throw Error({.what = "another number of edges than the file says",
                   .expected = fmt::format("{}", said_),
                   .got = std::to_string(edges_.size()),
                   .where = source_});
    }
    return {.graph = Graph::from_edges(nodes_, edges_, arcs_ ? EdgeKind::kDirected : EdgeKind::kUndirected),
            .blocked = std::vector<bool>(nodes_),
            .labels = labels_from_one(nodes_)};
  }

 private:
  NodeId node(std::size_t word) const {
    const auto number = parse_whole(words_[word], 1, nodes_);
    if (!number) lines_.fail("bad number", fmt::format("nodes from 1 to {}", nodes_));
    return static_cast<NodeId>(*number) - 1;
  }

  void read_problem() {
    if (nodes_ != 0) lines_.fail("a second problem", "one line `p …`");
    const std::string_view kind = words_.size() == 4 ? words_[1] : "";
    if (kind != "edge" && kind != "col" && kind != "sp") {
      lines_.fail("bad problem", "p edge, p col or p sp, and the numbers of nodes and edges");
    }
    arcs_ = kind == "sp";
    const auto nodes = parse_whole(words_[2], 1, most_nodes_);
    const auto edges = parse_whole(words_[3], 0, 1e18);
    if (!nodes) {
      lines_.fail("bad number", fmt::format("a number of nodes from 1 to {}, for a file of this size", most_nodes_));
    }
    if (!edges) lines_.fail("bad number", "a number of edges");
    nodes_ = static_cast<NodeId>(*nodes);
    said_ = *edges;
  }

  void read_edge() {
    if (nodes_ == 0) lines_.fail("no problem before the first edge", "a line `p …`");
    if (words_[0] != (arcs_ ? "a" : "e") || words_.size() != (arcs_ ? 4 : 3)) {
      lines_.fail("strange line", arcs_ ? "an arc `a U V COST`" : "an edge `e U V`");
    }
    const NodeId from = node(1);
    const NodeId to = node(2);
    const auto cost = arcs_ ? parse_number(words_[3]) : 1.0;
    if (!cost || *cost < 0) lines_.fail("bad cost", "a number from 0 up");
    edges_.push_back({from, to, *cost});
  }

  Lines lines_;
  double most_nodes_;
  const std::string& source_;
  std::vector<std::string_view> words_;  // of the line
  bool arcs_ = false;
  NodeId nodes_ = 0;
  double said_ = 0;
  std::vector<Edge> edges_;
};

}  // namespace

bool is_dimacs(std::string_view text) {
  Lines lines(text);
  std::vector<std::string_view> words;
  return next_words(lines, words) && words[0] == "p" && words.size() == 4;
}

GraphMap parse_dimacs(std::string_view text, const std::string& source) {
  return DimacsReader(text, source).read();
}

}  // namespace graphdrl
