// Worlds as users hand them over, in files or arrays, and their nodes as users name them.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "graphdrl/env/task.h"
#include "graphdrl/io/any_map.h"

namespace graphdrl {

// Every map of every source, as load_maps takes them. Throws Error.
std::vector<World> load_worlds(const std::vector<std::string>& sources, const MapOptions& options = {});

// The one map of a source. Throws Error where it holds more.
World load_one_world(const std::string& source, const MapOptions& options = {});

// The edges of a graph of N nodes and E edges.
struct EdgeArrays {
  std::int64_t node_count = 0;
  std::span<const std::int64_t> edges = {};  // [2E], pairs of nodes
  std::span<const double> costs = {};        // [E]; empty where each is 1
  bool directed = false;
  std::vector<std::string> labels = {};  // [E]; empty where no edge has one
  std::span<const double> prizes = {};   // [E]; empty where each is 1
  std::vector<bool> both_ways = {};      // [E], of a directed graph: those that lead back, too; empty for none
};

// The world of these edges; `map` has all but the graph, and what is empty in it is not there. Throws Error on lengths
// that do not fit, nodes that there are not, and numbers that cannot be.
World world_of(std::string name, const EdgeArrays& arrays, GraphMap map);

// A node as users name it: its label, "#5" for the node id 5, and in a world without labels also "5", or "row,col" on a
// grid. A number is no node id in a world with labels, where it could be either. Throws Error, with the node's role
// ("start"), where it is no valid node of the world.
NodeId parse_node(const World& world, std::string_view text, std::string_view role);

// A node as parse_node() takes it: its label, "row,col" on a grid, else its id.
std::string node_name(const World& world, NodeId node);

// A node by its id. Throws Error, with the node's role, where it is no valid node of the world.
NodeId checked_node(const World& world, std::int64_t id, std::string_view role);

// Where walks must end, as users say it: "anywhere", "start", or a node as for parse_node(). Throws Error.
End parse_end(const World& world, std::string_view text);

// A task as users write it: empty for what they do not say.
struct AskedText {
  std::string budget = {};
  std::string start = {};
  std::string end = {};
};
Asked asked_of(const World& world, const AskedText& text);  // throws Error

}  // namespace graphdrl
