// A graph with its blocked nodes and prizes: the truth that episodes are walked in.
#pragma once

#include <array>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "graphdrl/graph/given_task.h"
#include "graphdrl/graph/graph.h"
#include "graphdrl/graph/grid_map.h"

namespace graphdrl {

// A handle to an immutable world: copies share it, and it lives as long as any of them. Any number of threads may use
// one. It is its own index: what searches need to know of the whole graph (edges turned round, costs) is made once.
class World {
 public:
  // A grid: has cells, and directions where it has no diagonals. Throws Error where every cell is blocked.
  World(std::string name, GridMap map);

  // Any graph. Prizes are what a first visit of a node is worth; 1 each where there are none. Throws Error where every
  // node is blocked. REQUIRES: blocked has a value per node, and so have labels, prizes and places where there are any;
  // prizes are finite and not negative.
  World(std::string name, Graph graph, std::vector<bool> blocked, std::vector<std::string> labels = {},
        std::vector<double> prizes = {}, GivenTask given = {}, Places places = {});

  const std::string& name() const { return data_->name; }
  NodeId node_count() const { return data_->open.node_count(); }
  const std::optional<GridMap>& map() const { return data_->map; }
  const std::vector<bool>& blocked() const { return data_->blocked; }
  bool is_blocked(NodeId node) const { return data_->blocked[node]; }
  // A grid whose steps lead in the paper's four directions.
  bool is_grid() const { return data_->map && !data_->map->diagonals; }
  bool has_cells() const { return data_->map.has_value(); }                 // whose steps may lead to eight
  const std::vector<std::string>& labels() const { return data_->labels; }  // what users call the nodes; mostly empty

  std::span<const NodeId> valid_nodes() const { return data_->valid_nodes; }  // ascending
  int valid_count() const { return static_cast<int>(data_->valid_nodes.size()); }

  bool has_prizes() const { return !data_->prizes.empty(); }
  double prize(NodeId node) const { return data_->prizes.empty() ? 1.0 : data_->prizes[node]; }
  const std::vector<double>& prizes() const { return data_->prizes; }
  double total_prize() const { return data_->total_prize; }  // of the valid nodes
  double percent_of_all(double prize) const { return total_prize() > 0 ? 100.0 * prize / total_prize() : 100.0; }

  // Where nodes lie, if that is known: cells do [GridMap::place], other nodes where the file says so.
  bool has_places() const { return has_cells() || !data_->places.points.empty(); }
  Point place(NodeId node) const;   // REQUIRES: has_places()
  const std::string& unit() const;  // of places: "m", "degrees", "cells"; empty where it is not known

  // What the file says of the walk asked for.
  const GivenTask& given() const { return data_->given; }

  // The graph with its blocked nodes. That of a grid is made when it is first asked for.
  const Graph& graph() const;

  // The graph without the edges of blocked nodes: what can be walked.
  const Graph& open() const { return data_->open; }
  std::span<const NodeId> open_neighbours(NodeId node) const { return data_->open.neighbours(node); }
  // The same turned round, and with every edge leading both ways; open() itself where edges lead both ways anyway.
  const Graph& into() const { return data_->into ? *data_->into : data_->open; }
  const Graph& both_ways() const { return data_->both_ways ? *data_->both_ways : data_->open; }

  // Where a direction leads; the node itself where the move is blocked. REQUIRES: is_grid().
  NodeId direction_target(NodeId node, int direction) const { return data_->direction_targets[node][direction]; }

  // What may be spent of a budget in all. Where costs are whole numbers that is the budget; else sums of costs may be
  // off by rounding, so a billionth of it comes on top.
  double spending_limit(double budget) const { return data_->exact_sums ? budget : budget * (1 + 1e-9); }

  // Whether both are handles to one world.
  friend bool operator==(const World& one, const World& other) { return one.data_ == other.data_; }

 private:
  struct Data {
    std::string name;
    Graph open;
    std::optional<Graph> into;       // of directed graphs
    std::optional<Graph> both_ways;  // likewise
    std::vector<bool> blocked;
    std::optional<GridMap> map;
    std::vector<std::string> labels;
    std::vector<double> prizes;  // [N]; empty where each is 1
    double total_prize = 0;
    GivenTask given;
    Places places;
    bool exact_sums = true;
    std::vector<NodeId> valid_nodes;
    std::vector<std::array<NodeId, 4>> direction_targets;  // [N], of grids
    mutable std::once_flag graph_made;
    mutable std::optional<Graph> graph;  // with its blocked nodes, where there are any
  };
  static void index_nodes(Data& data);

  std::shared_ptr<const Data> data_;
};

}  // namespace graphdrl
