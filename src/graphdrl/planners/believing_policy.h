// Exploring by an old map, which may have changed since.
#pragma once

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "graphdrl/env/discovery.h"
#include "graphdrl/env/policy.h"
#include "graphdrl/graph/search.h"
#include "graphdrl/planners/plan.h"

namespace graphdrl {

// Plans on the old map, corrected by what visits have shown, and follows the plan. Plans anew, from what is left of the
// plan, once that cannot be walked any more, ends, or leaves out nodes or prizes that are new. Where too much turned
// out to be wrong, or a step would leave no known way to where the walk must end, it goes on by a policy that knows no
// old map.
class BelievingPolicy final : public Policy {
 public:
  BelievingPolicy(std::shared_ptr<const BelievedMap> old, std::unique_ptr<Planner> planner,
                  std::unique_ptr<Policy> without)
      : old_(std::move(old)), planner_(std::move(planner)), without_(std::move(without)) {}

  // Throws Error where a walk must end at a node and has a budget. Ways back must be known then, and a plan on an old
  // map comes back by edges that may be gone: on random grids such walks visit less than those without an old map.
  // REQUIRES: the views say what the old map calls their nodes [View::believed_as()].
  void act(std::span<const Observation> observations, std::span<int> actions, const Clock& clock = {}) override;

 private:
  // What is believed on one walk. Nodes have the old map's numbers; those that it does not have come after them.
  struct Belief {
    View view;  // of the walk
    bool trusted = true;
    std::vector<NodeId> believed_as = {};  // [seen]
    std::vector<NodeId> seen_as = {};      // [believed nodes], kNoNode: not seen
    std::vector<NodeId> open = {};         // seen, of whose edges some may be unknown
    // [believed nodes], where edges lead, and their costs.
    std::vector<std::vector<std::pair<NodeId, double>>> ways = {};
    int right = 0;  // edges found as they were believed
    int wrong = 0;
    std::shared_ptr<const Known> map = {};  // null: to be made anew
    std::uint64_t version = 0;              // of the view, that is in the belief
    bool news = false;                      // something is worth a visit that the plan knows nothing of
    NodeId end = kNoNode;                   // of the plan's task
    std::vector<NodeId> plan = {};
    std::size_t step = 0;    // of the plan, where the walk stands
    std::uint64_t hash = 0;  // of the walk that has followed it
  };

  int act_on(const Observation& now, const Clock& clock);
  Belief& belief_of(const View& view);
  void learn(Belief& belief);
  void take_in_edges(Belief& belief, NodeId node);
  void correct(Belief& belief, NodeId node);
  void plan_anew(Belief& belief, const Observation& now, const Clock& clock);

  std::shared_ptr<const BelievedMap> old_;
  std::unique_ptr<Planner> planner_;
  std::unique_ptr<Policy> without_;
  std::vector<Belief> beliefs_;  // the last ones, kMostBeliefs at most
  std::size_t oldest_ = 0;
  NearestFirst search_;
};

}  // namespace graphdrl
