// An exploration that is driven from outside: a client says where it is and what it can do there, and is told what to
// do next.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "graphdrl/answer/answer.h"
#include "graphdrl/base/error.h"
#include "graphdrl/env/policy.h"
#include "graphdrl/live/novelty_policy.h"
#include "graphdrl/live/state_graph.h"

namespace graphdrl {

// What a client said that cannot be, and the field that says it; empty where it is the whole message.
class FieldError : public Error {
 public:
  FieldError(std::string field, ErrorParts parts);
  const std::string& field() const { return field_; }

 private:
  std::string field_;
};

struct LiveOptions {
  Cover cover = Cover::kNodes;            // what is worth a first time: a state, or a move of a state
  double budget = kNoLimit;               // of the costs that the client reports
  bool end_at_start = false;              // come home: to the first state
  std::optional<double> reset_cost = {};  // of going back to the first state; empty: never
  std::string policy = {};                // as parse_policy() takes it, or `novelty`, the default
  double think_s = kNoLimit;              // for a choice, of policies that plan
  std::uint64_t seed = 1;                 // of `search` and of random policies
};

// Where the client is now, and what became of the last step that it was told.
struct LiveObservation {
  std::string state;
  std::optional<double> cost = {};                     // of that step; empty: what was expected
  double prize = 1;                                    // of the state, with cover nodes
  std::optional<std::vector<OfferedMove>> moves = {};  // empty: as before
  bool failed = false;                                 // the step could not be done
};

// What to do next.
struct LiveStep {
  enum class Kind { kMove, kReset, kDone };
  enum class Done {
    kCovered,      // nothing is left
    kBudget,       // what is left costs more than may be spent
    kUnreachable,  // what is left cannot be reached, or has failed three times
    kClosed,       // the client went away
  };
  Kind kind = Kind::kDone;
  std::string move = {};                    // of kMove
  std::optional<std::string> expects = {};  // the state that it leads to, where that is known
  Done done = Done::kCovered;               // of kDone
};
const char* name_of(LiveStep::Done done);

// What came out otherwise than the last time, or than it was said.
struct Surprise {
  std::int64_t step;  // the step that did, from 1
  std::string state;
  std::string move;  // empty of a reset
  std::string expected;
  std::string got;
};

struct LiveReport {
  std::int64_t steps = 0;  // moves and resets, done or failed
  double cost = 0;
  int states = 0;  // visited
  std::int64_t transitions = 0;
  std::int64_t resets = 0;
  struct Failed {
    std::string state;  // empty of a reset
    std::string move;   // likewise
    int failures;
  };
  std::string state = {};                // where it is
  std::vector<Failed> failed = {};       // moves that have failed since they were done last
  std::vector<Surprise> surprises = {};  // the first kMostSurprisesKept
  std::int64_t surprise_count = 0;
  std::vector<std::string> unreachable = {};  // states heard of and not visited
};

// One exploration. Observations and steps take turns; the same ones give the same steps, but where a policy's time to
// think is limited. Not thread safe; any number may be under way.
//
// What must end at the start is planned so that the way back is paid for, at the costs known. Where steps cost more
// than was said it goes home all the same, by the cheapest way.
class LiveExploration {
 public:
  static constexpr std::size_t kMostSurprisesKept = 1000;

  // Throws Error on a policy that there is not, or that does not explore; FieldError on a bad budget or reset cost.
  explicit LiveExploration(LiveOptions options);
  ~LiveExploration();

  const LiveOptions& options() const { return options_; }

  // Throws FieldError, and changes nothing, on an empty name, a cost or prize that is negative or not finite, a move
  // that stands there twice, a failure of a step that nobody was told.
  void observe(const LiveObservation& observation);
  // REQUIRES: something was observed. Asked again before the next observation it gives the same step.
  const LiveStep& next();
  // Takes a step that was told before for the next one, without choosing: of a transcript. Throws Error where the state
  // has no such move.
  void next_was(const LiveStep& step);

  bool observed() const { return position_ >= 0; }
  LiveReport report() const;

  // What is known as a map: states are nodes, by name; moves that were done, or are said to lead somewhere, are edges,
  // by name. REQUIRES: something was observed.
  GraphMap map() const;
  // The same with the walk, for pictures. Resets that were made are edges, too, and so are steps of the walk that no
  // move makes any more. REQUIRES: something was observed.
  Answer answer(const std::string& name) const;

 private:
  struct Pending {
    std::int32_t state;
    std::int32_t move;  // StateGraph::kReset
    std::int32_t expects = -1;
    double cost = 1;
  };

  void check(const LiveObservation& observation) const;
  void settle(const Pending& step, const LiveObservation& seen);
  void settle_reset(const LiveObservation& seen, double cost);
  void stand_at(std::int32_t state);
  std::optional<LiveStep> choose();
  bool must_go_home(const Observation& now) const;
  bool nothing_left(const Observation& now);
  std::optional<LiveStep> step_home();
  LiveStep tell(std::int32_t move);
  LiveStep done_now() const;
  Observation observation() const;

  LiveOptions options_;
  StateGraph graph_;
  NoveltyPolicy* novelty_ = nullptr;  // that of policy_, where it is one
  bool stops_ = true;                 // whether the policy stops where nothing is left
  std::unique_ptr<Policy> policy_;
  std::optional<Task> task_;  // once there is a start; of policies: without a budget it may end anywhere
  // [N], from each node to the first state, where it must end there; else null.
  std::shared_ptr<const std::vector<double>> way_home_;
  int reset_failures_ = 0;  // since a reset was done
  std::int32_t position_ = -1;
  std::optional<Pending> pending_;
  std::optional<LiveStep> step_;       // told, and not answered yet
  std::vector<std::uint32_t> visits_;  // [N]
  std::vector<NodeId> walk_;
  std::uint64_t walk_hash_ = kEmptyWalkHash;
  double spent_ = 0;
  LiveReport so_far_;            // without what is looked up when it is asked for
  std::vector<NodeId> seen_;     // state nodes, in the order in which they were seen
  std::vector<int> seen_after_;  // [walk], how many by then
  NearestFirst look_;
};

}  // namespace graphdrl
