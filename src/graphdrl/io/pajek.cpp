#include <fmt/format.h>

#include <array>

#include "graphdrl/io/graph_builder.h"
#include "graphdrl/io/readers.h"
#include "graphdrl/io/text.h"

namespace graphdrl {
namespace {

enum class Section { kNone, kVertices, kEdges, kArcs, kEdgesList, kArcsList, kMatrix };

// In the order of Section, without kNone.
constexpr std::array<std::string_view, 6> kSectionNames = {"*vertices",  "*edges",    "*arcs",
                                                           "*edgeslist", "*arcslist", "*matrix"};

bool is_pajek_comment(std::string_view line) {
  line = trimmed(line);
  return line.empty() || line.front() == '%';
}

class PajekReader {
 public:
  PajekReader(std::string_view text, const std::string& source, const MapOptions& options)
      : lines_(text, source),
        most_nodes_(static_cast<double>(most_nodes_of(text))),
        builder_(options, [this] { return lines_.place(); }) {}

  GraphMap read() {
    while (lines_.next()) {
      if (is_pajek_comment(lines_.line())) continue;
      split();
      if (words_.front().starts_with('*')) {
        enter_section();
      } else {
        read_line();
      }
    }
    if (nodes_ == 0) lines_.fail("no *Vertices", "*Vertices N");
    if (section_ == Section::kMatrix && row_ != nodes_)
      lines_.fail("the file ends within *Matrix", fmt::format("{} rows", nodes_));
    fill_nodes(nodes_);
    return builder_.build();
  }

 private:
  // The words of the line; "quotes" hold one together.
  void split() {
    words_.clear();
    for (std::string_view rest = trimmed(lines_.line()); !rest.empty(); rest = trimmed(rest)) {
      const bool quoted = rest.front() == '"';
      const std::size_t end = quoted ? rest.find('"', 1) : rest.find_first_of(" \t");
      if (quoted && end == std::string_view::npos) lines_.fail("a text that does not end", "'\"'");
      words_.push_back(rest.substr(quoted ? 1 : 0, quoted ? end - 1 : end));
      rest.remove_prefix(std::min(rest.size(), quoted ? end + 1 : end));
    }
  }

  void enter_section() {
    if (section_ == Section::kVertices) fill_nodes(nodes_);
    if (same_name(words_.front(), "*network")) return;
    const std::string_view word = words_.front();
    const std::size_t rank = rank_of(word.substr(0, word.find(':')), kSectionNames);  // *Arcs :1 "name of a relation"
    if (rank == kSectionNames.size()) {
      lines_.fail("a section that is none of a graph", "*Vertices, *Edges, *Arcs, *Edgeslist, *Arcslist or *Matrix");
    }
    section_ = static_cast<Section>(rank + 1);
    row_ = 0;
    if (section_ == Section::kVertices) {
      read_node_count();
    } else if (nodes_ == 0) {
      lines_.fail("no *Vertices before the first edge", "*Vertices N");
    }
  }

  void read_node_count() {
    if (nodes_ != 0) lines_.fail("a second graph", "one *Vertices");
    const auto number = words_.size() > 1 ? parse_whole(words_[1], 1, most_nodes_) : std::nullopt;
    if (!number) lines_.fail("bad number of nodes", fmt::format("1 to {}, for a file of this size", most_nodes_));
    nodes_ = static_cast<NodeId>(*number);
  }

  // Nodes that no line names.
  void fill_nodes(NodeId count) {
    while (builder_.node_count() < count) builder_.add_node(std::to_string(builder_.node_count() + 1));
  }

  NodeId node(std::string_view word) const {
    const auto number = parse_whole(word, 1, nodes_);
    if (!number) lines_.fail("no such node", fmt::format("nodes from 1 to {}", nodes_));
    return static_cast<NodeId>(*number) - 1;
  }

  void read_line() {
    switch (section_) {
      case Section::kNone:
        lines_.fail("no *Vertices before the first line", "*Vertices N");
      case Section::kVertices:
        read_node();
        return;
      case Section::kEdges:
      case Section::kArcs:
        if (words_.size() < 2) lines_.fail("not an edge", "two nodes, and a cost where there is one");
        builder_.add_edge(node(words_[0]), node(words_[1]), section_ == Section::kArcs);
        if (words_.size() > 2 && parse_number(words_[2])) builder_.set_edge("weight", words_[2]);
        return;
      case Section::kEdgesList:
      case Section::kArcsList:
        for (std::size_t i = 1; i < words_.size(); ++i) {
          builder_.add_edge(node(words_[0]), node(words_[i]), section_ == Section::kArcsList);
        }
        return;
      case Section::kMatrix:
        read_row();
        return;
    }
  }

  void read_node() {
    // Lines stand in order; a file may leave some out.
    const NodeId number = node(words_.front());
    if (number < builder_.node_count()) lines_.fail("a node used twice, or out of order", "nodes in order");
    fill_nodes(number + 1);
    if (words_.size() > 1) builder_.set_node(number, "label", words_[1]);
    if (words_.size() > 3 && parse_number(words_[2]) && parse_number(words_[3])) {
      builder_.set_node(number, "x", words_[2]);
      builder_.set_node(number, "y", words_[3]);
    }
  }

  void read_row() {
    if (row_ == nodes_ || std::ssize(words_) != nodes_) {
      lines_.fail("bad row of *Matrix", fmt::format("{} rows of {} costs", nodes_, nodes_));
    }
    for (NodeId col = 0; col < nodes_; ++col) {
      if (parse_number(words_[col]) == 0.0) continue;
      builder_.add_edge(row_, col, /*one_way=*/true);
      builder_.set_edge("weight", words_[col]);
    }
    ++row_;
  }

  Lines lines_;
  double most_nodes_;
  std::vector<std::string_view> words_;
  Section section_ = Section::kNone;
  NodeId nodes_ = 0;
  NodeId row_ = 0;
  GraphBuilder builder_;
};

}  // namespace

bool is_pajek(std::string_view text) {
  Lines lines(text);
  while (lines.next()) {
    if (is_pajek_comment(lines.line())) continue;
    std::string_view line = lines.line();
    const std::string_view word = take_word(line);
    return same_name(word, "*vertices") || same_name(word, "*network");
  }
  return false;
}

GraphMap parse_pajek(std::string_view text, const std::string& source, const MapOptions& options) {
  return PajekReader(text, source, options).read();
}

}  // namespace graphdrl
