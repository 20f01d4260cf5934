// Makes graphs of what files say of nodes, edges and their attributes.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "graphdrl/io/any_map.h"
#include "graphdrl/io/attributes.h"
#include "graphdrl/io/node_ids.h"

namespace graphdrl {

// The most nodes that a file may claim, for one that claims more memory than it fills: as many as its bytes, and some
// without edges.
std::int64_t most_nodes_of(std::string_view text);

// "1" to "N".
std::vector<std::string> labels_from_one(NodeId count);

// Makes a graph of what a file says, in any order but nodes before their edges.
class GraphBuilder {
 public:
  // place: where in the file the reader is, for errors. text_bytes: of a format in which few bytes may stand for many
  // edges and attributes, by lists of nodes and by defaults: limits these.
  GraphBuilder(const MapOptions& options, std::function<std::string()> place, std::ptrdiff_t text_bytes = -1);

  // Counts edges, or attributes. Throws Error where they are far more than a file of this size holds.
  void spend(std::int64_t items);

  // Throws Error where a node has this id already.
  NodeId add_node(std::string_view id);
  NodeId node_count() const { return ids_.count(); }
  // Throws Error where no node has this id.
  NodeId node(std::string_view id) const;
  // The same; a new node where there is none.
  NodeId node_or_new(std::string_view id);
  std::string id(NodeId node) const { return ids_.text(node); }
  // The graph will do without this node and its edges.
  void leave_out(NodeId node);

  // One edge that leads one way makes the graph directed; the others lead both ways then.
  void add_edge(NodeId from, NodeId to, bool one_way);
  // Makes the graph directed. REQUIRES: no edge was added as one that leads one way; all lead one way now.
  void direct_all() {
    directed_ = true;
    std::swap(one_way_, both_ways_);
  }
  void clear_edges() { both_ways_ = one_way_ = {}; }

  // What the attributes of a node, or of the edge added last, say. Of several names for one thing the best one counts;
  // other names are skipped. Throws Error on a cost, a prize or a coordinate that is no number, or is negative where it
  // must not be.
  void set_node(NodeId node, std::span<const Attribute> attributes);
  void set_node(NodeId node, std::string_view name, std::string_view value);
  void set_edge(std::span<const Attribute> attributes);
  void set_edge(std::string_view name, std::string_view value);
  bool uses_of_node(std::string_view name) const;
  bool uses_of_edge(std::string_view name) const { return costs_.knows(name) || edge_prizes_.knows(name); }

  void set_unit(std::string_view unit) { unit_ = unit; }  // of the coordinates
  void set_start(NodeId node) { start_ = node; }          // where the walk asked for begins

  // Tells options.note, with the place.
  void note(const std::string& text) const;

  // The graph. Coordinates are of one kind [kPlaceNames], the first that every node has. Labels are the attribute
  // `label` or `name`, where every node has one and no two are the same; else ids. Throws Error where there is no free
  // node, and where nothing has the attribute asked for.
  GraphMap build();

 private:
  struct EdgeList {
    std::vector<Edge> edges;
    std::vector<std::string> labels;  // as many as the last edge that has one
    std::vector<double> prizes;       // likewise
    std::size_t leading_back = 0;     // of a directed graph: how many of the last ones lead both ways

    // Adds an edge of another list, with its label and prize.
    void add(const Edge& edge, const EdgeList& other, std::size_t place);
  };

  double number(const Attribute& attribute, bool may_be_negative) const;
  void drop_left_out();
  EdgeList take_edges();
  std::vector<std::string> take_labels();
  Places take_places();

  AmountNames costs_;
  AmountNames prizes_;
  AmountNames edge_prizes_;
  std::function<void(const std::string&)> note_;
  std::function<std::string()> place_;
  std::int64_t items_left_;
  NodeIds ids_;
  NodeId start_ = kNoNode;
  std::string unit_;
  bool directed_ = false;
  EdgeList both_ways_;
  EdgeList one_way_;
  EdgeList* last_ = &both_ways_;  // where the edge added last stands
  // Of nodes, as many as the last one that has such an attribute.
  std::vector<bool> left_out_;
  std::vector<bool> blocked_;
  std::vector<double> prize_;
  std::vector<std::string> label_;
  std::array<std::vector<double>, kPlaceColumns> places_;  // x and y by kPlaceNames; NaN where there is none
};

}  // namespace graphdrl
