// A handle to what is known of a world.
#pragma once

#include <memory>
#include <span>
#include <utility>

#include "graphdrl/env/known.h"

namespace graphdrl {

// Policies, planners, bounds, features and masks stand on this side of the border; episodes, which know the truth
// [World], on the other. Of a known map both are the same data. Copies share it.
class View {
 public:
  View(std::shared_ptr<const Known> known) : known_(std::move(known)) {}  // NOLINT(google-explicit-constructor)

  const std::string& name() const { return known_->name; }
  std::uint64_t version() const { return known_->version; }
  std::uint64_t world() const { return known_->world; }  // a number that all versions of a world share
  NodeId node_count() const { return known_->open.node_count(); }
  std::span<const NodeId> valid_nodes() const { return known_->valid_nodes; }  // ascending
  int valid_count() const { return static_cast<int>(known_->valid_nodes.size()); }
  bool is_blocked(NodeId node) const { return known_->blocked[node]; }
  // Seen, but not visited yet: edges that lead on from there may be unknown. Never in a known map.
  bool is_frontier(NodeId node) const { return !known_->frontier.empty() && known_->frontier[node]; }

  bool has_prizes() const { return !known_->prizes.empty(); }
  double prize(NodeId node) const { return known_->prizes.empty() ? 1.0 : known_->prizes[node]; }
  double total_prize() const { return known_->total_prize; }  // of the valid nodes

  // What can be walked, the same turned round, and the same with every edge leading both ways.
  const Graph& open() const { return known_->open; }
  const Graph& into() const { return known_->into ? *known_->into : known_->open; }
  const Graph& both_ways() const { return known_->both_ways ? *known_->both_ways : known_->open; }
  std::span<const NodeId> open_neighbours(NodeId node) const { return known_->open.neighbours(node); }

  // What may be spent of a budget in all. Where costs are whole numbers that is the budget; else sums of costs may be
  // off by rounding, so a billionth of it comes on top.
  double spending_limit(double budget) const { return open().integer_costs() ? budget : budget * (1 + 1e-9); }

  // A grid whose steps lead in the paper's four directions.
  bool is_grid() const { return known_->grid && known_->grid->has_directions(); }
  const KnownGrid& grid() const { return *known_->grid; }  // REQUIRES: the world has cells

  // Whether this is the other one's world as it is known later.
  bool is_later_than(const View& other) const { return world() == other.world() && version() > other.version(); }
  // Whether both are of one world as it was known at one time.
  friend bool operator==(const View& one, const View& other) { return one.known_ == other.known_; }

 private:
  std::shared_ptr<const Known> known_;
};

}  // namespace graphdrl
