// What the readers of graph files share: nodes, edges and their attributes, by the names that programs give them.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "graphdrl/io/map_options.h"
#include "graphdrl/io/node_ids.h"
#include "graphdrl/io/node_link.h"

namespace graphdrl {

// Names of attributes, the first one best. Case does not count.
std::span<const std::string_view> cost_names();   // weight, cost, length, distance
std::span<const std::string_view> prize_names();  // prize, score
std::span<const std::string_view> label_names();  // label, name
std::span<const std::string_view> x_names();      // x, lon, longitude
std::span<const std::string_view> y_names();      // y, lat, latitude

// The most nodes that a file may claim, for one that claims more memory than it fills: as many as its bytes, and some
// without edges.
std::int64_t most_nodes_of(std::string_view text);

// Labels that are all different and not empty, where there is one for each of `count` nodes; else none.
std::vector<std::string> labels_if_unique(std::vector<std::string> labels, NodeId count);

// Whether two names differ in case at most.
bool same_name(std::string_view one, std::string_view other);
bool is_name_of(std::string_view name, std::span<const std::string_view> names);

// Makes a graph of what a file says, in any order but nodes before their edges.
class GraphBuilder {
 public:
  // place: where in the file the reader is, for errors.
  GraphBuilder(const MapOptions& options, std::function<std::string()> place)
      : cost_attribute_(options.cost_attribute), note_(options.note), place_(std::move(place)) {}

  // Throws Error where a node has this id already.
  NodeId add_node(std::string_view id);
  NodeId node_count() const { return ids_.count(); }
  // Throws Error where no node has this id.
  NodeId node(std::string_view id) const;
  // The same; a new node where there is none.
  NodeId node_or_new(std::string_view id);

  // One edge that leads one way makes the graph directed; the others lead both ways then.
  void add_edge(NodeId from, NodeId to, bool one_way);

  // What an attribute of a node, or of the edge added last, says. Of several names for one thing the first one counts;
  // other names are skipped. Throws Error on a cost, a prize or a coordinate that is no number, or is negative where it
  // must not be.
  void set_node(NodeId node, std::string_view name, std::string_view value);
  void set_edge(std::string_view name, std::string_view value);

  // The graph. Labels are the attribute `label` or `name`, where every node has one and no two are the same; else ids.
  // Throws Error where there is no free node, and where no edge has the attribute asked for.
  GraphMap build();

 private:
  struct Link {
    Edge edge;
    bool one_way;
    int cost_rank;  // of the name that its cost has, among cost_names()
  };
  struct Attributes {
    std::string label;
    std::optional<double> x;
    std::optional<double> y;
    double prize = 1;
    bool blocked = false;
    bool degrees = false;  // x and y are longitude and latitude
  };

  double number(std::string_view name, std::string_view value, bool may_be_negative) const;
  std::vector<std::string> take_labels();
  void take_places(GraphMap& map) const;
  void check_cost_attribute() const;

  std::string cost_attribute_;
  bool cost_attribute_met_ = false;
  std::vector<std::string> edge_attributes_;  // some that were met, for an error's message
  bool directed_ = false;
  std::function<void(const std::string&)> note_;
  std::function<std::string()> place_;
  NodeIds ids_;
  std::vector<Attributes> nodes_;  // as many as the last one that has an attribute
  std::vector<Link> links_;
};

}  // namespace graphdrl
