#include "graphdrl/live/live_exploration.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <variant>
#include <vector>

#include "graphdrl/base/random.h"
#include "support.h"

namespace graphdrl {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

// A program of states and moves as a client of ours knows it.
struct Machine {
  struct Arc {
    std::string to;
    double cost = 1;
    int failures = 0;  // fails so often before it works; -1: always
    bool told = false;
  };
  std::string start = "0";
  std::map<std::string, std::map<std::string, Arc>> states = {};

  std::vector<OfferedMove> moves(const std::string& state) const {
    std::vector<OfferedMove> moves;
    for (const auto& [name, arc] : states.at(state)) {
      moves.push_back({.name = name});
      if (arc.told) moves.back().to = arc.to;
      if (arc.cost != 1) moves.back().cost = arc.cost;
    }
    return moves;
  }
  int transitions() const {
    int count = 0;
    for (const auto& [name, arcs] : states) count += static_cast<int>(arcs.size());
    return count;
  }
};

// A random machine all of whose states can be reached.
Machine random_machine(Rng& rng, int states, int inputs, int most_cost = 1) {
  Machine machine;
  for (int state = 0; state < states; ++state) {
    for (int input = 0; input < inputs; ++input) {
      machine.states[std::to_string(state)]["i" + std::to_string(input)] = {.to = std::to_string(rng.index(states)),
                                                                            .cost = 1.0 + rng.index(most_cost)};
    }
  }
  for (int state = 1; state < states; ++state) {
    machine.states[std::to_string(rng.index(state))]["to" + std::to_string(state)] = {.to = std::to_string(state)};
  }
  return machine;
}

struct Outcome {
  LiveStep end;
  std::set<std::string> states;
  std::set<std::string> transitions;
  std::vector<std::string> steps;
  std::size_t last_new = 0;  // steps before the last state was seen
  std::string position;
  double cost = 0;
};

// Does what it is told until there is nothing to do.
Outcome drive(LiveExploration& exploration, Machine machine, int most_steps = 100'000) {
  Outcome outcome;
  std::string state = machine.start;
  LiveObservation seen;
  for (int step = 0; step < most_steps; ++step) {
    if (outcome.states.insert(state).second) outcome.last_new = outcome.steps.size();
    seen.state = state;
    seen.moves = machine.moves(state);
    exploration.observe(seen);
    const LiveStep& next = exploration.next();
    outcome.position = state;
    outcome.end = next;
    if (next.kind == LiveStep::Kind::kDone) break;
    seen = {};
    if (next.kind == LiveStep::Kind::kReset) {
      outcome.steps.emplace_back("reset");
      state = machine.start;
      outcome.cost += *exploration.options().reset_cost;
      continue;
    }
    outcome.steps.push_back(next.move);
    Machine::Arc& arc = machine.states.at(state).at(next.move);
    outcome.cost += arc.cost;
    seen.cost = arc.cost;
    if (arc.failures != 0) {
      if (arc.failures > 0) --arc.failures;
      seen.failed = true;
      continue;
    }
    EXPECT_EQ(next.expects.value_or(arc.to), arc.to);
    outcome.transitions.insert(state + " " + next.move);
    state = arc.to;
  }
  return outcome;
}

const std::vector<std::string> kPolicies = {"novelty",    "nearest",     "dfs",    "pocket",
                                            "search:200", "random-walk", "beam:5", "explorer"};

TEST(LiveExploration, SeesAllStates) {
  Rng rng(1);
  for (const std::string& policy : kPolicies) {
    for (int round = 0; round < 5; ++round) {
      const Machine machine = random_machine(rng, 12, 3, 1 + round % 2 * 4);
      LiveExploration exploration({.reset_cost = 2, .policy = policy});
      const Outcome outcome = drive(exploration, machine);
      EXPECT_EQ(outcome.states.size(), machine.states.size()) << policy;
      EXPECT_EQ(exploration.report().states, std::ssize(machine.states));
      EXPECT_EQ(outcome.end.done, LiveStep::Done::kCovered) << policy;
      EXPECT_EQ(exploration.report().transitions, machine.transitions());
      EXPECT_DOUBLE_EQ(exploration.report().cost, outcome.cost);
    }
  }
}

TEST(LiveExploration, DoesAllTransitions) {
  Rng rng(2);
  for (const std::string& policy : kPolicies) {
    for (int round = 0; round < 5; ++round) {
      Machine machine = random_machine(rng, 10, 4);
      for (auto& [state, arcs] : machine.states) {
        for (auto& [name, arc] : arcs) arc.told = round % 2 == 1;
      }
      LiveExploration exploration({.cover = Cover::kEdges, .reset_cost = 1, .policy = policy});
      const Outcome outcome = drive(exploration, machine);
      EXPECT_EQ(outcome.end.done, LiveStep::Done::kCovered) << policy;
      EXPECT_EQ(std::ssize(outcome.transitions), machine.transitions()) << policy;
      EXPECT_EQ(exploration.report().transitions, machine.transitions());
      EXPECT_EQ(exploration.report().surprise_count, 0);
    }
  }
}

TEST(LiveExploration, GoesWhereAMoveIsSaidToLead) {
  Machine machine;
  machine.states["0"]["a"] = {.to = "1", .told = true};
  machine.states["0"]["b"] = {.to = "1", .cost = 3, .told = true};
  machine.states["1"]["home"] = {.to = "0", .told = true};
  machine.states["1"]["on"] = {.to = "2", .told = true};
  machine.states["2"]["back"] = {.to = "1", .told = true};
  LiveExploration exploration({});
  const Outcome outcome = drive(exploration, machine);
  EXPECT_THAT(outcome.steps, ElementsAre("a", "on")) << "all states are known then, whatever the other moves do";
  EXPECT_EQ(outcome.end.done, LiveStep::Done::kCovered);
}

TEST(LiveExploration, KeepsToItsBudgetAndComesHome) {
  Rng rng(3);
  for (const std::string policy : {"novelty", "nearest", "search:200", "explorer"}) {
    for (int round = 0; round < 10; ++round) {
      const Machine machine = random_machine(rng, 12, 3, 3);
      const double budget = 5 + 3 * round;
      LiveExploration exploration({.budget = budget, .end_at_start = true, .reset_cost = 2, .policy = policy});
      const Outcome outcome = drive(exploration, machine);
      // Each try may cost more than the 1 that nobody told otherwise; here costs are told.
      EXPECT_LE(outcome.cost, budget) << policy;
      EXPECT_EQ(outcome.position, "0") << policy;
      const bool all = std::ssize(outcome.states) == std::ssize(machine.states);
      EXPECT_TRUE(all || outcome.end.done == LiveStep::Done::kBudget) << policy;
    }
  }
}

TEST(LiveExploration, ComesHomeThoughItCostsMoreThanWasSaid) {
  LiveExploration exploration({.budget = 5, .end_at_start = true, .reset_cost = 1});
  exploration.observe({.state = "home", .moves = {{{.name = "out"}}}});
  EXPECT_EQ(exploration.next().move, "out");
  exploration.observe({.state = "far", .cost = 9, .moves = {{{.name = "on"}}}});
  EXPECT_EQ(exploration.next().kind, LiveStep::Kind::kReset);
  exploration.observe({.state = "home"});
  EXPECT_EQ(exploration.next().done, LiveStep::Done::kBudget);
  EXPECT_EQ(exploration.report().cost, 10);
}

TEST(LiveExploration, TriesNothingWithoutAWayBackWhereOneIsOwed) {
  LiveExploration exploration({.budget = 10, .end_at_start = true});
  exploration.observe({.state = "home", .moves = {{{.name = "out"}}}});
  EXPECT_EQ(exploration.next().kind, LiveStep::Kind::kDone);
  EXPECT_EQ(exploration.next().done, LiveStep::Done::kUnreachable);
}

TEST(LiveExploration, TriesAgainWhatFailedAndGivesUpAfterThreeTimes) {
  Machine machine;
  machine.states["0"]["a"] = {.to = "1", .failures = 2};
  machine.states["0"]["b"] = {.to = "2", .failures = -1};
  machine.states["0"]["c"] = {.to = "0"};
  machine.states["1"]["back"] = {.to = "0"};
  machine.states["2"] = {};
  for (const std::string& policy : kPolicies) {
    LiveExploration exploration({.policy = policy});
    const Outcome outcome = drive(exploration, machine);
    EXPECT_THAT(outcome.states, ElementsAre("0", "1")) << policy;
    EXPECT_EQ(outcome.end.done, LiveStep::Done::kUnreachable) << policy;
    EXPECT_EQ(std::ranges::count(outcome.steps, "a"), 3) << policy;
    EXPECT_EQ(std::ranges::count(outcome.steps, "b"), 3) << policy;
    const LiveReport report = exploration.report();
    ASSERT_EQ(report.failed.size(), 1u);
    EXPECT_EQ(report.failed[0].move, "b");
    EXPECT_EQ(report.failed[0].failures, 3);
  }
}

TEST(LiveExploration, PlansAroundMovesThatLeadElsewhere) {
  LiveExploration exploration({.cover = Cover::kEdges, .policy = "nearest"});
  exploration.observe({.state = "a", .moves = {{{.name = "x", .to = "b"}}}});
  const LiveStep step = exploration.next();
  EXPECT_EQ(step.move, "x");
  EXPECT_EQ(step.expects, "b");
  exploration.observe({.state = "c", .moves = {{{.name = "y", .to = "a"}}}});
  const LiveReport report = exploration.report();
  ASSERT_EQ(report.surprises.size(), 1u);
  EXPECT_EQ(report.surprises[0].expected, "b");
  EXPECT_EQ(report.surprises[0].got, "c");
  EXPECT_THAT(report.unreachable, ElementsAre("b"));
  EXPECT_EQ(exploration.next().move, "y");
  exploration.observe({.state = "a"});
  // x led to c. Nothing else is left: it may lead to b again, as the client says.
  ASSERT_EQ(exploration.next().expects, "b");
  exploration.observe({.state = "c"});
  ASSERT_EQ(exploration.next().move, "y");
  exploration.observe({.state = "a"});
  ASSERT_EQ(exploration.next().expects, "b");
  exploration.observe({.state = "c"});
  EXPECT_EQ(exploration.next().done, LiveStep::Done::kUnreachable) << "the third surprise";
}

TEST(LiveExploration, ForgetsMovesThatDisappear) {
  LiveExploration exploration({.cover = Cover::kEdges, .policy = "nearest"});
  exploration.observe({.state = "a", .moves = {{{.name = "x"}, {.name = "y"}}}});
  exploration.next();
  exploration.observe({.state = "a", .moves = {{{.name = "y"}}}});  // x led back here, and is gone
  EXPECT_EQ(exploration.next().move, "y");
  exploration.observe({.state = "a", .moves = std::vector<OfferedMove>()});
  EXPECT_EQ(exploration.next().done, LiveStep::Done::kCovered);
  exploration.observe({.state = "a", .moves = {{{.name = "z"}}}});
  EXPECT_EQ(exploration.next().move, "z") << "it goes on once there is more";
}

TEST(LiveExploration, TakesResetsThatLeadElsewhere) {
  Rng rng(5);
  LiveExploration exploration({.reset_cost = 1});
  exploration.observe({.state = "a", .moves = {{{.name = "x"}}}});
  exploration.next();
  exploration.observe({.state = "trap", .moves = std::vector<OfferedMove>()});
  EXPECT_EQ(exploration.next().done, LiveStep::Done::kCovered);
  exploration.observe({.state = "a", .moves = {{{.name = "x"}, {.name = "y"}, {.name = "z"}}}});
  exploration.next();
  exploration.observe({.state = "trap"});
  EXPECT_EQ(exploration.next().kind, LiveStep::Kind::kReset);
  exploration.observe({.state = "b", .moves = {{{.name = "on", .to = "a"}}}});
  EXPECT_EQ(exploration.report().surprise_count, 1);
  EXPECT_EQ(exploration.next().move, "on");
}

TEST(LiveExploration, RefusesWhatCannotBeAndChangesNothing) {
  LiveExploration exploration({});
  const auto error = [&](const LiveObservation& seen) { return error_of([&] { exploration.observe(seen); }); };
  EXPECT_THAT(error({.state = ""}), HasSubstr("state"));
  EXPECT_THAT(error({.state = "a", .cost = -1}), HasSubstr("cost"));
  EXPECT_THAT(error({.state = "a", .cost = 1e308}), HasSubstr("cost"));
  EXPECT_THAT(error({.state = "a", .prize = std::nan("")}), HasSubstr("prize"));
  EXPECT_THAT(error({.state = "a", .failed = true}), HasSubstr("failed"));
  EXPECT_THAT(error({.state = "a", .moves = {{{.name = "x"}, {.name = "x"}}}}), HasSubstr("twice"));
  EXPECT_THAT(error({.state = "a", .moves = {{{.name = "x", .cost = -2}}}}), HasSubstr("moves"));
  EXPECT_FALSE(exploration.observed());
  EXPECT_THAT(error_of([] { LiveExploration({.policy = "best"}); }), HasSubstr("no such policy"));
  EXPECT_THAT(error_of([] { LiveExploration({.policy = "exact"}); }), HasSubstr("does not explore"));
  EXPECT_THAT(error_of([] { LiveExploration({.budget = -1}); }), HasSubstr("budget"));
}

TEST(LiveExploration, TakesStatesWithManyMoves) {
  std::vector<OfferedMove> moves(5000);
  for (std::size_t i = 0; i < moves.size(); ++i) moves[i].name = std::to_string(i);
  LiveExploration exploration({.cover = Cover::kEdges});
  exploration.observe({.state = "a", .moves = moves});
  std::set<std::string> done;
  while (exploration.next().kind == LiveStep::Kind::kMove) {
    done.insert(exploration.next().move);
    exploration.observe({.state = "a"});
  }
  EXPECT_EQ(done.size(), moves.size());
}

// A client that lies: moves fail, cost other than said, lead elsewhere, come and go; resets fail and lead elsewhere.
TEST(LiveExploration, BearsAClientThatLies) {
  Rng rng(31);
  const std::vector<std::string> policies = {"novelty", "nearest", "dfs",         "pocket",   "open",     "frontier",
                                             "tour",    "beam:3",  "random-walk", "guided:2", "explorer", "search:50"};
  for (int round = 0; round < 360; ++round) {
    const std::string& policy = policies[round % policies.size()];
    LiveOptions options{.cover = rng.index(2) == 0 ? Cover::kNodes : Cover::kEdges, .policy = policy};
    if (rng.index(2) == 0) options.budget = rng.index(60);
    options.end_at_start = rng.index(2) == 0;
    if (rng.index(3) > 0) options.reset_cost = rng.index(4);
    options.directed = rng.index(4) > 0;
    LiveExploration exploration(options);
    const auto name = [&](char kind, int most) { return std::string(1, kind) + std::to_string(rng.index(most)); };
    std::map<std::string, std::set<std::string>> has;  // moves by state
    std::string state = "s0";
    double cost = 0;
    for (int step = 0; step < 150; ++step) {
      LiveObservation seen{.state = state, .prize = 1.0 + rng.index(3)};
      if (!has.contains(state) || rng.index(3) == 0) {
        std::vector<OfferedMove> moves;
        std::set<std::string> names;
        for (int i = rng.index(5); i >= 0; --i) {
          OfferedMove move{.name = name('m', 6)};
          if (!names.insert(move.name).second) continue;
          if (rng.index(3) == 0) move.to = name('s', 8);
          if (rng.index(3) == 0) move.cost = rng.index(4);
          move.tried = rng.index(8) == 0;
          moves.push_back(std::move(move));
        }
        seen.moves = moves;
        has[state] = names;
      }
      if (step > 0 && rng.index(4) == 0) seen.cost = rng.index(8);
      if (step > 0) seen.failed = rng.index(5) == 0;
      exploration.observe(seen);
      const LiveStep next = exploration.next();
      ASSERT_EQ(exploration.next().move, next.move);
      if (next.kind == LiveStep::Kind::kDone) {
        if (rng.index(2) == 0) break;
        exploration.observe({.state = state, .moves = {{{.name = name('n', 100)}}}});  // there is more
        has[state] = {exploration.next().move};
        if (exploration.next().kind != LiveStep::Kind::kMove) break;
      } else if (next.kind == LiveStep::Kind::kMove) {
        ASSERT_TRUE(!options.directed || has[state].contains(next.move)) << policy << ' ' << round;
      } else {
        ASSERT_TRUE(options.reset_cost);
      }
      state = name('s', 8);
      cost = exploration.report().cost;
    }
    EXPECT_GE(exploration.report().cost, cost);
    exploration.map();
    exploration.answer("lies");
  }
}

TEST(LiveExploration, SaysThatTheBudgetIsSpentWhereStepsCostMore) {
  LiveExploration exploration({.cover = Cover::kEdges, .budget = 2, .policy = "nearest"});
  exploration.observe({.state = "a", .moves = {{{.name = "m"}, {.name = "x"}}}});
  EXPECT_EQ(exploration.next().kind, LiveStep::Kind::kMove);
  exploration.observe({.state = "b", .cost = 5, .moves = {{{.name = "m"}, {.name = "x"}}}});
  EXPECT_EQ(exploration.next().done, LiveStep::Done::kBudget);
}

TEST(LiveExploration, GivesUpResetsThatFail) {
  LiveExploration exploration({.reset_cost = 1});
  exploration.observe({.state = "a", .moves = {{{.name = "m"}, {.name = "n"}}}});
  exploration.next();
  exploration.observe({.state = "b", .moves = std::vector<OfferedMove>()});
  for (int i = 0; i < 3; ++i) {
    ASSERT_EQ(exploration.next().kind, LiveStep::Kind::kReset);
    exploration.observe({.state = "b", .failed = true});
  }
  EXPECT_EQ(exploration.next().done, LiveStep::Done::kUnreachable);
  ASSERT_EQ(exploration.report().failed.size(), 1u);
  EXPECT_EQ(exploration.report().failed[0].failures, 3);
}

TEST(LiveExploration, FollowsResetsToWhereTheyLead) {
  LiveExploration exploration({.cover = Cover::kEdges, .reset_cost = 1});
  exploration.observe({.state = "a", .moves = {{{.name = "m"}, {.name = "n"}}}});
  exploration.next();
  exploration.observe({.state = "b", .moves = std::vector<OfferedMove>()});
  ASSERT_EQ(exploration.next().kind, LiveStep::Kind::kReset);
  exploration.observe({.state = "c", .cost = 3, .moves = {{{.name = "x"}, {.name = "y"}}}});
  exploration.next();
  exploration.observe({.state = "a", .moves = std::vector<OfferedMove>()});
  const LiveStep step = exploration.next();
  EXPECT_EQ(step.kind, LiveStep::Kind::kReset) << "to c, where a move is left";
  EXPECT_EQ(step.expects, "c");
}

TEST(LiveExploration, ComesHomeInTheEndWithoutABudget) {
  for (const std::string& policy : kPolicies) {
    LiveExploration exploration({.end_at_start = true, .policy = policy});
    exploration.observe({.state = "a", .moves = {{{.name = "m"}}}});
    ASSERT_EQ(exploration.next().move, "m") << policy;
    exploration.observe({.state = "b", .moves = {{{.name = "back", .to = "a"}}}});
    EXPECT_EQ(exploration.next().move, "back") << policy;
    exploration.observe({.state = "a"});
    EXPECT_EQ(exploration.next().done, LiveStep::Done::kCovered) << policy;
    EXPECT_EQ(exploration.report().state, "a");
  }
}

TEST(LiveExploration, BelievesWhatItFoundOutUntilTheClientSaysOtherwise) {
  LiveExploration exploration({.cover = Cover::kEdges, .policy = "nearest"});
  const std::vector<OfferedMove> moves = {{.name = "m", .to = "b", .cost = 1}, {.name = "n", .to = "b", .cost = 9}};
  exploration.observe({.state = "a", .moves = moves});
  EXPECT_EQ(exploration.next().move, "m");
  exploration.observe({.state = "b", .cost = 50, .moves = {{{.name = "back"}}}});
  exploration.next();
  std::vector<OfferedMove> more = moves;
  more.push_back({.name = "o", .to = "c"});
  exploration.observe({.state = "a", .moves = more});
  ASSERT_EQ(std::get<GraphMap>(exploration.map()).multigraph->edges[0].cost, 50);
  more[0].cost = 2;
  exploration.observe({.state = "a", .moves = more});
  EXPECT_EQ(std::get<GraphMap>(exploration.map()).multigraph->edges[0].cost, 2);
}

TEST(LiveExploration, CountsMovesThatLeadBothWaysOnce) {
  LiveExploration exploration({.cover = Cover::kEdges, .directed = false, .budget = 4, .end_at_start = true});
  exploration.observe({.state = "a", .moves = {{{.name = "ab", .to = "b"}, {.name = "ac", .to = "c"}}}});
  EXPECT_EQ(exploration.next().move, "ab") << "the way back is known";
  exploration.observe({.state = "b", .moves = {{{.name = "ab", .to = "a"}, {.name = "bc", .to = "c"}}}});
  EXPECT_EQ(exploration.next().move, "bc");
  exploration.observe({.state = "c", .moves = {{{.name = "bc", .to = "b"}, {.name = "ac", .to = "a"}}}});
  EXPECT_EQ(exploration.next().move, "ac");
  exploration.observe({.state = "a"});
  EXPECT_EQ(exploration.next().done, LiveStep::Done::kCovered);
  EXPECT_EQ(exploration.report().transitions, 3);
  const GraphMap map = std::get<GraphMap>(exploration.map());
  EXPECT_FALSE(map.graph.directed());
  EXPECT_EQ(map.graph.edge_count(), 3);
  EXPECT_EQ(map.multigraph->edges.size(), 3u);
  exploration.answer("both ways");
}

TEST(LiveExploration, TriesNothingThatWasTriedBefore) {
  LiveExploration exploration({.cover = Cover::kEdges});
  exploration.observe({.state = "a", .moves = {{{.name = "x", .to = "b", .tried = true}, {.name = "y"}}}});
  EXPECT_EQ(exploration.next().move, "y");
  exploration.observe({.state = "a"});
  EXPECT_EQ(exploration.next().move, "x") << "b was never seen";
  exploration.observe({.state = "b", .moves = std::vector<OfferedMove>()});
  EXPECT_EQ(exploration.next().done, LiveStep::Done::kCovered);
  EXPECT_EQ(exploration.report().transitions, 1);
}

TEST(LiveExploration, TakesNoStepForNothingOnceMoreIsSpentThanThereWas) {
  LiveExploration exploration({.budget = 3, .policy = "search:50"});
  exploration.observe({.state = "a", .moves = {{{.name = "x"}}}});
  exploration.observe({.state = "b", .cost = 4, .moves = {{{.name = "y", .cost = 0}}}});
  EXPECT_EQ(exploration.next().done, LiveStep::Done::kBudget);
}

TEST(LiveExploration, IsAMapWithAWalk) {
  Rng rng(6);
  const Machine machine = random_machine(rng, 8, 3);
  LiveExploration exploration({.cover = Cover::kEdges, .reset_cost = 1});
  drive(exploration, machine);
  const Answer answer = exploration.answer("machine");
  EXPECT_EQ(answer.world.node_count(), 8);
  EXPECT_EQ(std::ssize(std::get<GraphMap>(exploration.map()).multigraph->edges), machine.transitions());
  EXPECT_EQ(answer.plan.visited, 8);
  EXPECT_EQ(answer.discovered.after_step.size(), answer.plan.walk.size());
  for (std::size_t i = 1; i < answer.plan.walk.size(); ++i) {
    EXPECT_GE(answer.world.open().index_of(answer.plan.walk[i - 1], answer.plan.walk[i]), 0);
  }
}

TEST(NoveltyPolicy, LearnsWhichMovesFindStates) {
  // A corridor: of the ten moves of each state one leads on, all others back to the first state.
  Machine machine;
  for (int state = 0; state < 20; ++state) {
    for (char name = 'a'; name < 'k'; ++name) {
      machine.states[std::to_string(state)][std::string(1, name)] = {
          .to = std::to_string(name == 'f' && state < 19 ? state + 1 : 0)};
    }
  }
  LiveExploration novelty({});
  LiveExploration nearest({.policy = "nearest"});
  EXPECT_LT(drive(novelty, machine).last_new * 3, drive(nearest, machine).last_new);
}

}  // namespace
}  // namespace graphdrl
