// What a client explores, as far as it has told: states with moves, or cells; and what is said about that.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "graphdrl/answer/answer.h"
#include "graphdrl/base/error.h"
#include "graphdrl/env/policy.h"
#include "graphdrl/graph/point.h"
#include "graphdrl/io/any_map.h"
#include "graphdrl/live/cell_graph.h"
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
  Cover cover = Cover::kNodes;            // of states: what is worth a first time, a state, or a move of a state
  bool directed = true;                   // of states: moves lead one way; else back, too, by the same name
  std::optional<Score> score = {};        // of cells: what is worth something, cells seen (the default) or visited
  int connectivity = 8;                   // of cells: steps lead to four or to eight others
  double budget = kNoLimit;               // of the costs that the client reports
  bool end_at_start = false;              // come home: to the first state or cell
  std::optional<double> reset_cost = {};  // of going back to the first state; empty: never
  std::string policy = {};                // as parse_policy() takes it, or `novelty`; empty for the default
  double think_s = kNoLimit;              // for a choice, of policies that plan
  std::uint64_t seed = 1;                 // of `search` and of random policies
};

// Where the client is now, and what became of the last step that it was told.
struct LiveObservation {
  std::string state = {};                              // of states
  std::optional<double> cost = {};                     // of that step; empty: what was expected
  double prize = 1;                                    // of the state, with cover nodes
  std::optional<std::vector<OfferedMove>> moves = {};  // empty: as before
  bool failed = false;                                 // the step could not be done
  std::optional<Point> at = {};                        // instead of a state: of cells
  std::optional<CellPatch> cells = {};                 // what was seen of them since
};

// What to do next.
struct LiveStep {
  enum class Kind { kMove, kReset, kGoto, kDone };
  enum class Done {
    kCovered,      // nothing is left
    kBudget,       // what is left costs more than may be spent
    kUnreachable,  // what is left cannot be reached, or has failed three times
    kClosed,       // the client went away
  };
  Kind kind = Kind::kDone;
  std::string move = {};                    // of kMove
  std::optional<std::string> expects = {};  // the state that it leads to, where that is known
  std::vector<Point> way = {};              // of kGoto: the centres of the cells to go through, the goal last
  Done done = Done::kCovered;               // of kDone

  friend bool operator==(const LiveStep&, const LiveStep&) = default;
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

inline constexpr std::size_t kMostSurprisesKept = 1000;

// What came of cells.
struct LiveCellReport {
  Point at = {};
  int seen = 0;              // free ones
  int visited = 0;           // entered
  int left = 0;              // to be entered still, in reach or not
  std::int64_t changed = 0;  // how often one was free and is not any more, or the other way round
  struct Failed {
    Point goal;
    int failures;
  };
  std::vector<Failed> failed = {};  // goals, that have failed and were not reached since
};

struct LiveReport {
  std::int64_t steps = 0;  // done or failed
  double cost = 0;

  // Of states:
  std::string state = {};  // where it is
  int states = 0;          // visited
  std::int64_t transitions = 0;
  std::int64_t resets = 0;
  struct Failed {
    std::string state;  // empty of a reset
    std::string move;   // likewise
    int failures;
  };
  std::vector<Failed> failed = {};       // moves that have failed since they were done last
  std::vector<Surprise> surprises = {};  // the first kMostSurprisesKept
  std::int64_t surprise_count = 0;
  std::vector<std::string> unreachable = {};  // states heard of and not visited

  std::optional<LiveCellReport> cells = {};  // instead of states
};

// Throws FieldError unless an amount is from 0 to 1e15: sums of so large ones are still exact to a tenth.
void check_amount(double amount, const char* field);

// What is explored, for LiveExploration, which walks on it.
class LiveMap {
 public:
  virtual ~LiveMap() = default;

  virtual Discovery& discovery() = 0;
  virtual const Discovery& discovery() const = 0;
  const View& view() const { return discovery().view(); }
  // Nodes that first visits walk through.
  virtual const NodeSet& ground() const = 0;
  virtual int visited_count() const = 0;
  virtual int seen_count() const = 0;  // of what pictures show

  virtual std::string default_policy() const = 0;
  // The policy of a name that only such maps have; null where it is none. Throws FieldError on those of others.
  virtual std::unique_ptr<Policy> own_policy(const std::string& name) = 0;

  // Throws FieldError on what cannot be, and changes nothing.
  virtual void check(const LiveObservation& seen) const = 0;
  // What came of the step told before, if any: what it cost, and the nodes entered. The last one is where the client
  // is; none where it is where it was. REQUIRES: it was checked.
  struct Moved {
    double cost = 0;
    std::vector<NodeId> way = {};
  };
  virtual Moved take(const LiveObservation& seen) = 0;

  // Whether a step may lead on over many nodes.
  virtual bool goes_far() const = 0;
  // The step, or the way, from where the client is to the last of some nodes. It is then under way.
  virtual LiveStep tell(std::span<const NodeId> way) = 0;
  // Takes a step for told. Throws Error where there is no such step.
  virtual void told(const LiveStep& step) = 0;
  // What has failed and waits can be tried again. False where there is nothing.
  virtual bool retry() = 0;
  // Whether a goal has failed too often.
  virtual bool given_up(NodeId goal) const = 0;
  // Whether anything is not done yet, in reach or not.
  virtual bool is_left() const = 0;

  virtual void add_to(LiveReport& report) const = 0;
  virtual AnyMap map() const = 0;
  // What pictures show of a walk: a world that has all its steps.
  struct Picture {
    World world;
    Plan plan;                 // without its cost
    std::vector<NodeId> seen;  // in the order in which they were seen
    std::vector<int> after;    // [walk of the plan], how many by then
    Reveal reveal;
    Score score;
    double unit;  // of the world's costs, in the client's
  };
  // seen_after: [walk], of seen_count() by then.
  virtual Picture picture(const std::string& name, std::span<const NodeId> walk,
                          std::span<const int> seen_after) const = 0;
};

// Of what an exploration begins with: states or cells. Throws FieldError on options that do not go with them.
std::unique_ptr<LiveMap> make_live_map(const LiveOptions& options, const LiveObservation& first);

}  // namespace graphdrl
