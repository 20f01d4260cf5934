// What the readers of graph files share: nodes, edges and their attributes, by the names that programs give them.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "graphdrl/io/node_ids.h"
#include "graphdrl/io/node_link.h"

namespace graphdrl {

// Names of attributes, the first one best. Case does not count.
std::span<const std::string_view> cost_names();   // weight, cost, length, distance
std::span<const std::string_view> prize_names();  // prize, score

// Whether two names differ in case at most.
bool same_name(std::string_view one, std::string_view other);
bool is_name_of(std::string_view name, std::span<const std::string_view> names);

// Makes a graph of what a file says, in any order but nodes before their edges.
class GraphBuilder {
 public:
  // place: where in the file the reader is, for errors.
  explicit GraphBuilder(std::function<std::string()> place) : place_(std::move(place)) {}

  // Throws Error where a node has this id already.
  NodeId add_node(std::string_view id);
  // Throws Error where no node has this id.
  NodeId node(std::string_view id) const;
  // The same; a new node where there is none.
  NodeId node_or_new(std::string_view id);

  // One edge that leads one way makes the graph directed; the others lead both ways then.
  void add_edge(NodeId from, NodeId to, bool one_way);

  // What an attribute of a node, or of the edge added last, says; those of other names are skipped. Throws Error on a
  // cost, a prize or a coordinate that is no number, or is negative where it must not be.
  void set_node(NodeId node, std::string_view name, std::string_view value);
  void set_edge(std::string_view name, std::string_view value);

  // The graph. Labels are the attribute `label` or `name`, where every node has one and no two are the same; else ids.
  // Throws Error where there is no free node.
  GraphMap build();

 private:
  struct Link {
    Edge edge;
    bool one_way;
  };
  struct Attributes {
    std::string label;
    std::optional<double> x;
    std::optional<double> y;
    double prize = 1;
    bool blocked = false;
  };

  double number(std::string_view name, std::string_view value, bool may_be_negative) const;
  std::vector<std::string> take_labels();

  bool directed_ = false;
  std::function<std::string()> place_;
  NodeIds ids_;
  std::vector<Attributes> nodes_;  // as many as the last one that has an attribute
  std::vector<Link> links_;
};

}  // namespace graphdrl
