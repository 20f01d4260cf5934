#include "graphdrl/planners/local_search.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "../support.h"
#include "graphdrl/base/parallel.h"
#include "graphdrl/env/episode.h"
#include "graphdrl/env/world_families.h"
#include "graphdrl/planners/annealing.h"
#include "graphdrl/planners/moves.h"
#include "graphdrl/planners/registry.h"
#include "graphdrl/planners/route.h"

namespace graphdrl {
namespace {

// A world of a family, with costs and one way edges where asked for, and its task at 1.0x.
World family_world(const char* family, int size, bool weighted = false, bool directed = false) {
  return split_world({.family = family, .size = size, .weighted = weighted, .directed = directed}, Split::kTrain, 3);
}

Task task_of(const World& world, const End& end = End::anywhere()) {
  return Task(world, world.valid_nodes().front(), world.valid_count() * world.open().mean_cost(), end);
}

TEST(Targets, CostWhatTheCheapestWaysDo) {
  for (const bool directed : {false, true}) {
    const World world = family_world("erdos-renyi", 40, /*weighted=*/true, directed);
    const Task task = task_of(world, End::at(world.valid_nodes().back()));
    const Targets targets(task, {});
    ASSERT_TRUE(targets.complete());
    EXPECT_EQ(targets.symmetric(), !directed);
    const std::vector<double> to_end = costs_to(world.into(), task.end());
    for (int to = 0; to < targets.end(); ++to) {
      EXPECT_EQ(targets.target_of(targets.node(to)), to);
      EXPECT_EQ(targets.cost(to, targets.end()), to_end[targets.node(to)]);
      const std::vector<double> costs = costs_to(world.into(), targets.node(to));
      for (int from = 0; from < targets.end(); ++from) {
        const double cost = costs[targets.node(from)];
        if (cost <= task.budget()) {
          ASSERT_NEAR(targets.cost(from, to), cost, 1e-9);
        }
      }
      const auto near = targets.near(to);
      EXPECT_TRUE(std::is_sorted(near.begin(), near.end(),
                                 [&](int a, int b) { return targets.cost(to, a) < targets.cost(to, b) - 1e-12; }));
      const auto into = targets.into(to);
      EXPECT_TRUE(std::is_sorted(into.begin(), into.end(),
                                 [&](int a, int b) { return targets.cost(a, to) < targets.cost(b, to) - 1e-12; }));
    }
  }
}

TEST(Targets, AreWhatIsWorthSomethingAndCanBeHad) {
  // 0 - 1 - 2 - 3 - 4, and 5 to which no edge leads.
  const std::vector<Edge> edges = {{0, 1}, {1, 2}, {2, 3}, {3, 4}};
  const World world("path", Graph::from_edges(6, edges), std::vector<bool>(6), {}, {1, 0, 2, 3, 4, 5});
  const Targets open(Task(world, 0, 3), {});
  EXPECT_EQ(open.end(), 3);  // 0, 2 and 3
  EXPECT_EQ(open.total_prize(), 6);
  const Targets there_and_back(Task(world, 0, 4, End::at(0)), {});
  EXPECT_EQ(there_and_back.end(), 2);  // 0 and 2
  const Targets to_four(Task(world, 0, 4, End::at(4)), {});
  EXPECT_EQ(to_four.end(), 3);
  EXPECT_EQ(to_four.prize(to_four.end()), 4);
}

// As if they had been looked for there.
TEST(Targets, AreLeftOverAfterAFirstStep) {
  for (const bool directed : {false, true}) {
    const World world = family_world("erdos-renyi", 40, /*weighted=*/true, directed);
    const Task task(world, world.valid_nodes().front(), 1000, End::at(world.valid_nodes().back()));
    const Targets all(task, {});
    NodeSet visited(world.node_count());
    visited.insert(task.start());
    for (const int first : {1, all.end() / 2, all.end() - 1}) {
      const Task rest = task.rest(all.node(first), 1000, visited);
      // Without what edges of one way leave behind.
      const Targets expected(rest, {});
      const Targets targets = all.after(first);
      EXPECT_EQ(targets.node(0), rest.start());
      EXPECT_EQ(targets.target_of(task.start()), -1);
      EXPECT_EQ(targets.end(), all.end() - 1);
      EXPECT_EQ(targets.prize(0), 0);
      EXPECT_NEAR(targets.total_prize(), all.total_prize() - 2, 1e-9);
      const auto there = [&](int target) {
        return target == expected.end() ? targets.end() : targets.target_of(expected.node(target));
      };
      for (int from = 0; from < expected.end(); ++from) {
        EXPECT_EQ(targets.prize(there(from)), expected.prize(from));
        for (int to = 0; to <= expected.end(); ++to) {
          EXPECT_EQ(targets.cost(there(from), there(to)), expected.cost(from, to));
        }
        const auto near = targets.near(there(from));
        for (const int target : expected.near(from).first(std::min<std::size_t>(3, expected.near(from).size()))) {
          EXPECT_THAT(near, testing::Contains(there(target)));
        }
      }
    }
  }
}

// Beyond kTableTargets a target knows its nearest ones only.
TEST(Targets, KnowTheNearestInLargeWorlds) {
  const World world = family_world("obstacles", 61);
  const Targets targets(task_of(world), {});
  ASSERT_GT(targets.end(), Targets::kTableTargets);
  ASSERT_FALSE(targets.has_table());
  for (int target = 0; target < targets.end(); target += 97) {
    const std::vector<double> costs = costs_to(world.open(), targets.node(target));
    ASSERT_EQ(std::ssize(targets.near(target)), Targets::kNearest);
    for (const int near : targets.near(target)) EXPECT_EQ(targets.cost(target, near), costs[targets.node(near)]);
  }
  EXPECT_EQ(targets.cost(0, targets.end() - 1), kNoLimit);
}

// The targets of a route, without target 0 and the end.
std::vector<int> order_in(const Route& route) {
  std::vector<int> order;
  for (int target = route.next(0); route.next(target) != Route::kNone; target = route.next(target)) {
    order.push_back(target);
  }
  return order;
}

// A route beside a plain list, changed at random.
TEST(Route, IsAListWhoseChangesCanBeUndone) {
  const World world = family_world("geometric", 50, /*weighted=*/true);
  const Targets targets(task_of(world), {});
  const int end = targets.end();
  Route route(targets);
  std::vector<int> list;
  for (int target = 1; target < end; target += 2) list.push_back(target);
  route.assign(list, std::vector<double>(list.size() + 1, kNoLimit));
  const auto expect_equal = [&](const std::vector<int>& order) {
    ASSERT_EQ(order_in(route), order);
    double cost = 0;
    double prize = targets.prize(0);
    int last = 0;
    for (const int target : order) {
      cost += targets.cost(last, target);
      prize += targets.prize(target);
      ASSERT_EQ(route.previous(target), last);
      ASSERT_TRUE(route.before(last, target));
      last = target;
    }
    ASSERT_NEAR(route.cost(), cost, 1e-9);
    ASSERT_NEAR(route.prize(), prize, 1e-9);
  };
  Rng rng(5);
  std::vector<int> kept = list;
  const auto below = [&](std::size_t bound) {
    return static_cast<std::ptrdiff_t>(rng.below(static_cast<std::uint32_t>(bound)));
  };
  for (int i = 0; i < 5'000; ++i) {
    const int target = 1 + static_cast<int>(below(end - 1));
    const auto found = std::find(list.begin(), list.end(), target);
    if (found == list.end()) {
      const auto place = below(list.size() + 1);
      const int after = place == 0 ? 0 : list[place - 1];
      route.insert(target, after, targets.cost(after, target), targets.cost(target, route.next(after)));
      list.insert(list.begin() + place, target);
    } else if (rng.below(2) == 0 || list.size() < 3) {
      route.remove(target);
      list.erase(found);
    } else {
      auto first = below(list.size());
      auto last = below(list.size());
      if (first > last) std::swap(first, last);
      route.reverse(list[first], list[last], targets.cost(route.previous(list[first]), list[last]),
                    targets.cost(list[first], route.next(list[last])));
      std::reverse(list.begin() + first, list.begin() + last + 1);
    }
    expect_equal(list);
    const std::uint32_t what = rng.below(8);
    if (what == 0) {
      route.keep();
      kept = list;
    } else if (what == 1) {
      route.undo();
      list = kept;
      expect_equal(list);
    }
  }
}

// Labels run out where all targets come after one of them; those around make room.
TEST(Route, HasRoomForManyTargetsInOnePlace) {
  const World world = family_world("obstacles", 61);
  const Targets targets(task_of(world), {});
  const int end = targets.end();
  const int half = end / 2;
  Route route(targets);
  std::vector<int> list(half - 1);
  std::iota(list.begin(), list.end(), 1);
  route.assign(list, std::vector<double>(list.size() + 1, 1));
  const int after = half / 2;
  for (int target = half; target < end; ++target) route.insert(target, after, 1, 1);
  int last = 0;
  for (const int target : order_in(route)) {
    ASSERT_TRUE(route.before(last, target)) << last << " and " << target;
    last = target;
  }
  EXPECT_TRUE(route.before(last, end));
  EXPECT_EQ(route.next(after), end - 1);
}

// A line 0 - 1 - 2 … of edges that cost 1, so that target i is node i.
World line_world(NodeId count) {
  std::vector<Edge> edges;
  for (NodeId node = 1; node < count; ++node) edges.push_back({node - 1, node});
  return World("line", Graph::from_edges(count, edges), std::vector<bool>(count));
}

void set_route(Draft& draft, const std::vector<int>& order) {
  draft.route.assign(order, std::vector<double>(order.size() + 1, kNoLimit));
}

// Every `step`th target from `first` on.
std::vector<int> some_targets(const Targets& targets, int first, int step) {
  std::vector<int> order;
  for (int target = first; target < targets.end(); target += step) order.push_back(target);
  return order;
}

TEST(StringRemoval, TakesOutTargetsThatStandTogether) {
  const World world = line_world(10);
  const Targets targets(Task(world, 0, 9), {});
  Draft draft(targets, 9, 1);
  const std::vector<int> all = some_targets(targets, 1, 1);
  set_route(draft, all);
  for (int round = 0; round < 200; ++round) {
    draft.removed.clear();
    const StringRemoval removal = StringRemoval::propose(draft, 5, 3);
    ASSERT_GE(removal.length, 1);
    ASSERT_LE(removal.length, 3);
    ASSERT_LE(removal.first, 5);
    ASSERT_GT(removal.first + removal.length, 5);
    removal.apply(draft);
    std::vector<int> expected(removal.length);
    std::iota(expected.begin(), expected.end(), removal.first);
    ASSERT_EQ(draft.removed, expected);
    ASSERT_EQ(std::ssize(order_in(draft.route)), 9 - removal.length);
    draft.route.undo();
    ASSERT_EQ(order_in(draft.route), all);
  }
  draft.removed.clear();
  StringRemoval{.first = 8, .length = 5}.apply(draft);
  EXPECT_THAT(draft.removed, testing::ElementsAre(8, 9)) << "the route ends there";
}

TEST(Reversal, CostsWhatItProposes) {
  const World world = family_world("geometric", 30, /*weighted=*/true);
  const Targets targets(task_of(world), {});
  Draft draft(targets, 1e9, 1);
  const std::vector<int> order = some_targets(targets, 1, 1);
  set_route(draft, order);
  const double cost = draft.route.cost();
  for (int one = 1; one < targets.end(); ++one) {
    for (int other = one + 1; other < targets.end(); ++other) {
      for (const bool forward : {true, false}) {
        const auto reversal = Reversal::propose(draft, one, other, forward);
        ASSERT_EQ(reversal.has_value(), other > one + 1);
        if (!reversal) continue;
        reversal->apply(draft);
        ASSERT_NEAR(draft.route.cost(), cost + reversal->added, 1e-9);
        ASSERT_EQ(forward ? draft.route.next(one) : draft.route.previous(other), forward ? other : one);
        draft.route.undo();
        ASSERT_EQ(order_in(draft.route), order);
        ASSERT_EQ(draft.route.cost(), cost);
      }
    }
  }
}

// Beside every place tried.
TEST(Insertion, TakesTheCheapestPlaceThatTheLimitAllows) {
  for (const bool directed : {false, true}) {
    const World world = family_world("erdos-renyi", 20, /*weighted=*/true, directed);
    const Targets targets(task_of(world, End::at(world.valid_nodes().back())), {});
    Draft draft(targets, 1e9, 1, {.blink = 0});
    set_route(draft, some_targets(targets, 2, 2));
    const double cost = draft.route.cost();
    for (const int target : some_targets(targets, 1, 2)) {
      double least = kNoLimit;
      for (int at = 0; at != targets.end(); at = draft.route.next(at)) {
        const double added = targets.cost(at, target) + targets.cost(target, draft.route.next(at));
        least = std::min(least, added - draft.route.link(at));
      }
      draft.limit = cost + least + 1e-6;
      const auto insertion = Insertion::propose(draft, target);
      ASSERT_TRUE(insertion.has_value());
      EXPECT_NEAR(insertion->added, least, 1e-9);
      insertion->apply(draft);
      EXPECT_NEAR(draft.route.cost(), cost + least, 1e-9);
      draft.route.undo();
      draft.limit = cost + least - 1e-6;
      EXPECT_FALSE(Insertion::propose(draft, target).has_value());
    }
  }
}

TEST(TwoOpt, UntanglesWhatChanged) {
  const World world = line_world(10);
  const Targets targets(Task(world, 0, 9), {});
  Draft draft(targets, 20, 1);
  const std::vector<int> sorted = some_targets(targets, 1, 1);
  set_route(draft, sorted);
  TwoOpt two_opt(targets);
  two_opt.apply(*Reversal::propose(draft, 3, 7, /*forward=*/true), draft);
  EXPECT_THAT(order_in(draft.route), testing::ElementsAre(1, 2, 3, 7, 6, 5, 4, 8, 9));
  EXPECT_EQ(draft.route.cost(), 15);
  two_opt.improve(draft);
  EXPECT_EQ(order_in(draft.route), sorted);
  EXPECT_EQ(draft.route.cost(), 9);
}

TEST(Moves, KeepToTheLimitAndCanBeUndone) {
  for (const bool directed : {false, true}) {
    const World world = family_world("erdos-renyi", 60, /*weighted=*/true, directed);
    const Targets targets(task_of(world), {});
    Draft draft(targets, task_of(world).limit() / 2, 1);
    draft.selective = true;
    set_route(draft, {});
    Rng rng(3);
    for (int i = 0; i < 600; ++i) {
      const std::vector<int> before = order_in(draft.route);
      const int seed = draft.random_target();
      if (i % 3 == 0) {
        ruin(draft, seed);
        recreate(draft, seed);
      } else if (i % 3 == 1) {
        move_region(draft, seed, 10);
      } else {
        cross_over(draft, some_targets(targets, 1, 2));
      }
      ASSERT_LE(draft.route.cost(), draft.limit * (1 + kCostRounding));
      ASSERT_EQ(std::count(draft.marked.begin(), draft.marked.end(), 1), 0);
      if (rng.below(2) == 0) {
        draft.route.keep();
      } else {
        draft.route.undo();
        ASSERT_EQ(order_in(draft.route), before);
      }
    }
    EXPECT_GT(order_in(draft.route).size(), 5U);
  }
}

TEST(Annealing, RecombinesRoutes) {
  const World world = family_world("tree", 100, /*weighted=*/true);
  const Task task = task_of(world);
  const Targets targets(task, {});
  const auto order_of = [&](const Plan& plan) {
    std::vector<int> order;
    for (const NodeId node : plan.walk) {
      const int target = targets.target_of(node);
      if (target > 0 && std::find(order.begin(), order.end(), target) == order.end()) order.push_back(target);
    }
    return order;
  };
  const auto contains = [](const std::vector<int>& order, int target) {
    return std::find(order.begin(), order.end(), target) != order.end();
  };
  const std::vector<int> one = order_of(make_planner("nearest", 1)->plan(task));
  const std::vector<int> other = order_of(make_planner("dfs", 1)->plan(task));
  int mixed = 0;
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    const Tour start{.order = one, .links = std::vector<double>(one.size() + 1, kNoLimit)};
    Annealing annealing(targets, task.budget(), seed, start);
    annealing.recombine(other);
    const Tour& best = annealing.best();
    const std::vector<int>& child = best.order;
    EXPECT_LE(best.cost, task.budget() * (1 + 1e-9));
    EXPECT_EQ(best.prize, static_cast<double>(child.size() + 1));  // the start's
    bool from_one = false;
    bool from_other = false;
    for (const int target : child) {
      EXPECT_TRUE(contains(one, target) || contains(other, target));
      from_one = from_one || !contains(other, target);
      from_other = from_other || !contains(one, target);
    }
    if (from_one && from_other) ++mixed;
  }
  EXPECT_GT(mixed, 5);
}

TEST(LocalSearch, IsNeverWorseThanWhatItBeginsWith) {
  for (const bool directed : {false, true}) {
    for (const bool weighted : {false, true}) {
      const World world = family_world("erdos-renyi", 60, weighted, directed);
      for (const End& asked : {End::anywhere(), End::at_start()}) {
        const Task task = task_of(world, asked);
        const NodeId end = task.end();
        const Plan found = make_planner("search:2000")->plan(task);
        for (const char* const name : {"nearest", "dfs", "beam", "explorer"}) {
          EXPECT_FALSE(better(make_planner(name)->plan(task), found)) << name;
        }
        EXPECT_GE(found.bound, found.prize);
        Episode episode(world, {.budget = task.budget(), .action_space = ActionSpace::kNeighbours});
        follow_walk(episode, found.walk);
        EXPECT_EQ(episode.visited_count(), found.visited);
        EXPECT_TRUE(end == kNoNode || found.walk.back() == end);
      }
    }
  }
}

TEST(LocalSearch, ImprovesWhatBeamsFind) {
  int better_plans = 0;
  for (const char* const family : {"obstacles", "loop-maze", "rooms"}) {
    const World world = family_world(family, 15);
    const Task task = task_of(world);
    better_plans += make_planner("search:20000")->plan(task).visited > make_planner("beam:50")->plan(task).visited;
  }
  EXPECT_GE(better_plans, 2);
}

// Without a table, links that lead far are known only as long as they stand.
TEST(LocalSearch, WorksWithoutATable) {
  const World grid = family_world("obstacles", 61);
  const World streets = family_world("geometric", 2600, /*weighted=*/true, /*directed=*/true);
  for (const World& world : {grid, streets}) {
    const Task task = task_of(world);
    const Plan found = make_planner("search:20000")->plan(task);
    Episode episode(world, {.budget = task.budget(), .action_space = ActionSpace::kNeighbours});
    follow_walk(episode, found.walk);
    EXPECT_EQ(episode.visited_count(), found.visited);
    EXPECT_TRUE(better(found, make_planner("nearest")->plan(task)));
  }
}

TEST(LocalSearch, WalksTheSameForAnyNumberOfThreads) {
  const World world = family_world("obstacles", 11);
  const Task task = task_of(world);
  std::vector<std::vector<NodeId>> walks;
  for (const int count : {1, 2, 3}) {
    set_threads(count);
    walks.push_back(make_planner("search:3000", 7)->plan(task).walk);
  }
  set_threads(1);
  EXPECT_EQ(walks[0], walks[1]);
  EXPECT_EQ(walks[0], walks[2]);
  EXPECT_NE(walks[0], make_planner("search:3000", 8)->plan(task).walk);
}

TEST(LocalSearch, EndsWhereAllIsVisited) {
  const World room("room", GridMap{.rows = 30, .cols = 30, .blocked = std::vector<bool>(900)});
  const Plan plan = make_planner("search:1000000000000")->plan(task_of(room));
  EXPECT_TRUE(plan.optimal);
  EXPECT_EQ(plan.visited, 900);
}

TEST(LocalSearch, HasAWalkWhateverTheTime) {
  const World world = family_world("obstacles", 61);
  for (const End& asked : {End::anywhere(), End::at_start()}) {
    const Task task = task_of(world, asked);
    const NodeId end = task.end();
    for (const double seconds : {0.0, 0.001, 0.01, 0.1}) {
      const Plan plan = make_planner("search")->plan(task, Clock(seconds));
      Episode episode(world, {.budget = task.budget(), .action_space = ActionSpace::kNeighbours});
      follow_walk(episode, plan.walk);
      EXPECT_TRUE(end == kNoNode || plan.walk.back() == end);
    }
  }
}

}  // namespace
}  // namespace graphdrl
