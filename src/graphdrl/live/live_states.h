// States and their moves, explored live.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "graphdrl/live/live_map.h"
#include "graphdrl/live/novelty_policy.h"

namespace graphdrl {

inline constexpr const char* kNovelty = "novelty";  // the default, which only states have

// Steps are moves and resets, one at a time; states count, or moves.
class LiveStates final : public LiveMap {
 public:
  explicit LiveStates(const LiveOptions& options);

  Discovery& discovery() override { return graph_.discovery(); }
  const Discovery& discovery() const override { return graph_.discovery(); }
  const NodeSet& ground() const override { return graph_.ground(); }
  int visited_count() const override { return graph_.visited_count(); }
  int seen_count() const override { return graph_.state_count(); }
  std::string default_policy() const override { return kNovelty; }
  std::unique_ptr<Policy> own_policy(const std::string& name) override;
  void check(const LiveObservation& seen) const override;
  Moved take(const LiveObservation& seen) override;
  bool goes_far() const override { return false; }
  LiveStep tell(std::span<const NodeId> way) override;
  void told(const LiveStep& step) override;
  bool retry() override { return graph_.retry(); }
  bool given_up(NodeId /*goal*/) const override { return false; }  // the graph does not lead over what was
  bool is_left() const override;
  void add_to(LiveReport& report) const override;
  AnyMap map() const override;
  Picture picture(const std::string& name, std::span<const NodeId> walk,
                  std::span<const int> seen_after) const override;

 private:
  struct Pending {
    std::int32_t state;
    std::int32_t move;  // StateGraph::kReset
    std::int32_t expects = -1;
    double cost = 1;
  };

  double settle(const Pending& step, const LiveObservation& seen);
  void settle_reset(const LiveObservation& seen, double cost);
  LiveStep tell_move(std::int32_t move);
  bool is_way_back(std::int32_t state, const StateMove& move) const;
  EdgeKind kind() const { return graph_.directed() ? EdgeKind::kDirected : EdgeKind::kUndirected; }
  GraphMap graph_map() const;

  std::optional<double> reset_cost_;  // as it was asked for
  StateGraph graph_;
  NoveltyPolicy* novelty_ = nullptr;  // where the policy is one
  int reset_failures_ = 0;            // since a reset was done
  std::int32_t position_ = -1;
  std::optional<Pending> pending_;
  LiveReport so_far_;  // without what is looked up when it is asked for
};

}  // namespace graphdrl
