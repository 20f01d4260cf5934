// An exploration that is driven from outside: a client says where it is and what there is, and is told what to do next.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "graphdrl/env/exploration.h"
#include "graphdrl/live/live_map.h"

namespace graphdrl {

// One exploration. Observations and steps take turns; the same ones give the same steps, but where a policy's time to
// think is limited. The first observation says whether it is one of states or of cells. Not thread safe; any number may
// be under way.
//
// What must end at the start is planned so that the way back is paid for, at the costs known. Where steps cost more
// than was said it goes home all the same, by the cheapest way.
class LiveExploration {
 public:
  // Throws Error on a policy that there is not, or that does not explore; FieldError on other bad options.
  explicit LiveExploration(LiveOptions options);

  const LiveOptions& options() const { return options_; }

  // Throws FieldError, and changes nothing, on what cannot be: an empty name, a cost or prize that is negative or not
  // finite, a move that stands there twice, cells of another size than before, a failure of a step that nobody was
  // told.
  void observe(const LiveObservation& observation);
  // REQUIRES: something was observed. Asked again before the next observation it gives the same step.
  const LiveStep& next();
  // From now on it only goes home, where it must end there.
  void end() { ends_ = true; }
  // Takes a step that was told before for the next one, without choosing: of a transcript. Throws Error where there is
  // no such step.
  void next_was(const LiveStep& step);

  bool observed() const { return map_ != nullptr; }
  LiveReport report() const;

  // What is known as a map: states as nodes and moves as edges, by name, or cells. REQUIRES: something was observed.
  AnyMap map() const { return map_->map(); }
  // The same with the walk, for pictures: it has all steps of the walk, whether they still can be done or not.
  // REQUIRES: something was observed.
  Answer answer(const std::string& name) const;

 private:
  void begin(const LiveObservation& first);
  void enter(NodeId node);
  Observation observation(const NodeSet& ground, int visited_count) const;
  std::optional<LiveStep> go(const std::function<NodeId(const Observation&)>& choose);
  std::optional<LiveStep> explore();
  std::optional<LiveStep> go_home();
  NodeId next_home(const Observation& now) const;
  bool must_go_home(const Observation& now) const;
  bool nothing_left(const Observation& now);
  LiveStep done_now() const;

  LiveOptions options_;
  std::unique_ptr<LiveMap> map_;  // null until something was observed
  bool ends_ = false;             // end() was called
  bool stops_ = true;             // whether the policy stops where nothing is left
  std::unique_ptr<Policy> policy_;
  std::optional<Task> task_;  // once there is a start; of policies: without a budget it may end anywhere
  // [N], from each node to the start, where it must end there; else null.
  std::shared_ptr<const std::vector<double>> way_home_;
  std::optional<LiveStep> step_;  // told, and not answered yet
  NodeId position_ = kNoNode;
  std::vector<std::uint32_t> visits_;  // [N]
  std::vector<NodeId> walk_;
  std::uint64_t walk_hash_ = kEmptyWalkHash;
  double spent_ = 0;
  std::vector<int> seen_after_;  // [walk], how many the map had seen by then
  NearestFirst look_;
};

}  // namespace graphdrl
