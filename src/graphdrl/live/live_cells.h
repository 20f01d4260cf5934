// Cells that a sensor sees, explored live.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "graphdrl/live/cell_graph.h"
#include "graphdrl/live/live_map.h"

namespace graphdrl {

// A step is a way to a cell that shows more, or where visits count, through cells that were not visited. The client
// walks it as far as it likes. Where it comes off the way, it is taken to have gone the cheapest way that is known,
// else straight on.
class LiveCells final : public LiveMap {
 public:
  explicit LiveCells(const LiveOptions& options);

  Discovery& discovery() override { return graph_.discovery(); }
  const Discovery& discovery() const override { return graph_.discovery(); }
  const NodeSet& ground() const override { return graph_.ground(); }
  int visited_count() const override { return graph_.visited_count(); }
  int seen_count() const override { return graph_.view().node_count(); }
  std::string default_policy() const override;
  std::unique_ptr<Policy> own_policy(const std::string& name) override;
  void check(const LiveObservation& seen) const override;
  Moved take(const LiveObservation& seen) override;
  bool goes_far() const override { return true; }
  LiveStep tell(std::span<const NodeId> way) override;
  void told(const LiveStep& step) override;
  bool retry() override { return graph_.retry(); }
  bool given_up(NodeId goal) const override { return graph_.given_up(goal); }
  bool is_left() const override { return graph_.left_count() > 0; }
  void add_to(LiveReport& report) const override;
  AnyMap map() const override { return graph_.map(); }
  Picture picture(const std::string& name, std::span<const NodeId> walk,
                  std::span<const int> seen_after) const override;

 private:
  double cost_between(NodeId from, NodeId to) const;
  std::vector<NodeId> way_to(NodeId node, const std::vector<NodeId>& told);

  Score score_;
  CellGraph graph_;
  NodeId here_ = kNoNode;
  Point at_ = {};
  std::vector<NodeId> way_;  // under way; empty where none is
  std::int64_t steps_ = 0;
  NearestFirst search_;
};

}  // namespace graphdrl
