// Plans, optima and bounds against brute force, on thousands of small random worlds of every kind.
#include <gtest/gtest.h>

#include <bit>
#include <chrono>
#include <map>
#include <queue>

#include "graphdrl/env/episode.h"
#include "graphdrl/env/world_families.h"
#include "graphdrl/eval/rollout.h"
#include "graphdrl/planners/baselines.h"
#include "graphdrl/planners/beam.h"
#include "graphdrl/planners/bound.h"
#include "graphdrl/planners/exact.h"
#include "graphdrl/planners/explorer.h"
#include "graphdrl/planners/registry.h"
#include "support.h"

namespace graphdrl {
namespace {

struct Case {
  World world;
  NodeId start;
  double budget;

  Task task() const { return Task(world, start, budget); }
};

// Sparse and dense, undirected and directed, with and without costs and blocked nodes, connected or not.
Case random_case(Rng& rng) {
  const auto nodes = static_cast<NodeId>(1 + rng.below(8));
  const bool directed = rng.below(2) == 0;
  const bool weighted = rng.below(2) == 0;
  const auto edge_count = rng.below(static_cast<std::uint32_t>(2 * nodes));
  std::vector<Edge> edges;
  for (std::uint32_t i = 0; i < edge_count; ++i) {
    const auto end = [&] { return static_cast<NodeId>(rng.below(static_cast<std::uint32_t>(nodes))); };
    edges.push_back({end(), end(), weighted ? 0.25 * (1 + rng.below(12)) : 1.0});
  }
  std::vector<bool> blocked(nodes);
  for (NodeId node = 1; node < nodes; ++node) blocked[node] = rng.below(6) == 0;
  World world("random", Graph::from_edges(nodes, edges, directed ? EdgeKind::kDirected : EdgeKind::kUndirected),
              blocked);
  const NodeId start = world.valid_nodes()[rng.below(static_cast<std::uint32_t>(world.valid_count()))];
  return {std::move(world), start, 0.5 * rng.below(28)};
}

struct Optimum {
  int visited;
  double cost;  // of the cheapest walk that visits so many
};

// The least cost of every pair of visited set and position, step by step.
Optimum brute_force(const Case& c) {
  using Key = std::pair<unsigned, NodeId>;
  std::map<Key, double> least;
  std::priority_queue<std::pair<double, Key>, std::vector<std::pair<double, Key>>, std::greater<>> queue;
  queue.push({0, {1U << c.start, c.start}});
  Optimum best{.visited = 0, .cost = 0};
  while (!queue.empty()) {
    const auto [cost, key] = queue.top();
    queue.pop();
    if (!least.try_emplace(key, cost).second) continue;
    const int visited = std::popcount(key.first);
    if (visited > best.visited) best = {visited, cost};
    const Graph& graph = c.world.graph();
    for (int i = 0; i < graph.degree(key.second); ++i) {
      const NodeId next = graph.neighbours(key.second)[i];
      const double after = cost + graph.cost(key.second, i);
      if (!c.world.is_blocked(next) && after <= c.budget) queue.push({after, {key.first | 1U << next, next}});
    }
  }
  return best;
}

TEST(Optimality, PlansOptimaAndBoundsHoldOnRandomWorlds) {
  Rng rng(11);
  int tight = 0;
  ExplorerScorer scorer(builtin_explorer());
  ExplorerPlanner explorer(std::make_shared<ExplorerScorer>(builtin_explorer()));
  constexpr int kCases = 10'000;
  for (int i = 0; i < kCases; ++i) {
    SCOPED_TRACE(i);
    const Case c = random_case(rng);
    const Task task = c.task();
    const Optimum optimum = brute_force(c);
    const double most = max_prize(task);
    ASSERT_GE(most, optimum.visited);
    tight += most == optimum.visited;

    const auto follow = [&](const std::vector<NodeId>& walk) {
      Episode episode(c.world, {.budget = c.budget, .action_space = ActionSpace::kNeighbours});
      follow_walk(episode, walk);  // throws where a step is no edge or cannot be paid for
      return Optimum{episode.visited_count(), episode.spent()};
    };
    const auto exact = exact_walk(task);
    ASSERT_TRUE(exact);
    const Optimum found = follow(*exact);
    ASSERT_EQ(found.visited, optimum.visited);
    ASSERT_NEAR(found.cost, optimum.cost, 1e-9);
    ASSERT_EQ(exact_prize(task), optimum.visited);
    for (const int width : {1, 3}) ASSERT_LE(follow(beam_plan(task, {.width = width}).walk).visited, optimum.visited);
    const auto complete = beam_plan(task, {.width = 1000});  // no partial walk is dropped
    ASSERT_TRUE(complete.optimal);
    const Optimum all = follow(complete.walk);
    ASSERT_EQ(all.visited, optimum.visited);
    ASSERT_NEAR(all.cost, optimum.cost, 1e-9);
    const auto guided = beam_plan(task, {.width = 1000}, {}, &scorer);
    ASSERT_TRUE(guided.optimal);
    ASSERT_EQ(follow(guided.walk).visited, optimum.visited);
    const auto narrow = beam_plan(task, {.width = 1}, {}, &scorer);
    ASSERT_TRUE(!narrow.optimal || follow(narrow.walk).visited == optimum.visited);
    const Plan alone = explorer.plan(task);
    ASSERT_TRUE(!alone.optimal || follow(alone.walk).visited == optimum.visited);
    for (const char* const name :
         {"random", "random-walk", "dfs", "nearest", "beam:2", "explorer", "guided:2", "exact"}) {
      const auto policy = make_policy(name, 1);
      const EpisodeOptions options{.budget = c.budget, .action_space = ActionSpace::kNeighbours};
      const RolloutResult result = roll_out(Episode(c.world, options), std::span(&c.start, 1), *policy).front();
      ASSERT_LE(follow(result.walk).visited, optimum.visited) << name;
    }
  }
  EXPECT_GT(tight, kCases * 9 / 10) << "the bound is loose";
}

// With ends and prizes: the highest prize, and the least cost of a walk that has it and ends where it must.
struct PrizeOptimum {
  double prize;
  double cost;
};

std::optional<PrizeOptimum> brute_force_prize(const Case& c, NodeId end) {
  using Key = std::pair<unsigned, NodeId>;
  std::map<Key, double> least;
  std::priority_queue<std::pair<double, Key>, std::vector<std::pair<double, Key>>, std::greater<>> queue;
  queue.push({0, {1U << c.start, c.start}});
  std::optional<PrizeOptimum> best;
  while (!queue.empty()) {
    const auto [cost, key] = queue.top();
    queue.pop();
    if (!least.try_emplace(key, cost).second) continue;
    double prize = 0;
    for (NodeId node = 0; node < c.world.node_count(); ++node) {
      if ((key.first >> node & 1U) != 0) prize += c.world.prize(node);
    }
    if ((end == kNoNode || key.second == end) && (!best || prize > best->prize)) best = {prize, cost};
    const Graph& graph = c.world.open();
    for (int i = 0; i < graph.degree(key.second); ++i) {
      const NodeId next = graph.neighbours(key.second)[i];
      const double after = cost + graph.cost(key.second, i);
      if (after <= c.budget) queue.push({after, {key.first | 1U << next, next}});
    }
  }
  return best;
}

// A way through other places may cost less than the straight one.
class RandomCosts final : public PairCosts {
 public:
  RandomCosts(NodeId nodes, Rng& rng) : nodes_(nodes) {
    for (int i = 0; i < nodes * nodes; ++i) costs_.push_back(rng.below(6));
  }
  double cost(NodeId from, NodeId to) const override {
    return costs_[std::min(from, to) * nodes_ + std::max(from, to)];
  }

 private:
  NodeId nodes_;
  std::vector<double> costs_;
};

TEST(Optimality, HoldsForEndsAndPrizes) {
  Rng rng(13);
  int compared = 0;
  std::map<std::string, std::unique_ptr<Planner>> planners;
  std::map<std::string, int> missed;
  for (const char* const name : {"dfs", "nearest", "beam:8", "beam:1000", "guided:4", "explorer", "search:200"}) {
    planners[name] = make_planner(name);
  }
  for (int i = 0; i < 6'000; ++i) {
    SCOPED_TRACE(i);
    Case c = random_case(rng);
    std::vector<double> prizes;
    for (NodeId node = 0; node < c.world.node_count(); ++node) prizes.push_back(0.5 * rng.below(7));
    if (rng.below(2) == 0) prizes.clear();
    const NodeId count = c.world.node_count();
    const bool complete = rng.below(4) == 0;
    c.world =
        World("prizes", complete ? Graph::complete(count, std::make_shared<RandomCosts>(count, rng)) : c.world.graph(),
              complete ? std::vector<bool>(count) : c.world.blocked(), {}, prizes);
    const auto nodes = c.world.valid_nodes();
    const NodeId node = nodes[rng.below(static_cast<std::uint32_t>(nodes.size()))];
    const std::uint32_t kind = rng.below(3);
    const NodeId end = kind == 0 ? kNoNode : kind == 1 ? c.start : node;
    const End asked = end == kNoNode ? End::anywhere() : End::at(end);
    const auto optimum = brute_force_prize(c, end);
    if (!optimum) {
      EXPECT_THROW(Task(c.world, c.start, c.budget, asked), Error);
      continue;
    }
    const Task task(c.world, c.start, c.budget, asked);
    ++compared;
    ASSERT_GE(max_prize(task), optimum->prize - 1e-9);
    const Plan plan = ExactPlanner().plan(task);
    ASSERT_TRUE(plan.optimal);
    ASSERT_NEAR(plan.prize, optimum->prize, 1e-9);
    ASSERT_NEAR(plan.cost, optimum->cost, 1e-9);
    Episode episode(c.world, task, {.action_space = ActionSpace::kNeighbours});
    follow_walk(episode, plan.walk);
    ASSERT_NEAR(episode.prize(), optimum->prize, 1e-9);
    ASSERT_TRUE(end == kNoNode || episode.position() == end);
    for (const auto& [name, planner] : planners) {
      SCOPED_TRACE(name);
      const Plan found = planner->plan(task);
      episode.reset(c.start);
      follow_walk(episode, found.walk);
      ASSERT_TRUE(end == kNoNode || found.walk.back() == end);
      ASSERT_NEAR(episode.prize(), found.prize, 1e-9);
      ASSERT_LE(found.prize, optimum->prize + 1e-9);
      ASSERT_GE(found.bound, optimum->prize - 1e-9);
      ASSERT_TRUE(!found.optimal || found.prize >= optimum->prize - 1e-9);
      if (name == "beam:1000" && !complete) {
        ASSERT_TRUE(found.optimal);
        ASSERT_NEAR(found.cost, optimum->cost, 1e-9);
      }
      // Beams go straight to where a way round may cost less.
      if (name != "beam:8" || !complete) missed[name] += found.prize < optimum->prize - 1e-9;
    }
  }
  EXPECT_GT(compared, 3'000);
  EXPECT_LE(missed["search:200"], compared / 1000) << "search falls short of the optimum";
  EXPECT_LE(missed["beam:8"], compared / 50);
}

TEST(Beam, ClaimsNoOptimumWhereItDidNotLookAtEverything) {
  const auto star = [](NodeId leaves) {
    std::vector<Edge> rays;
    for (NodeId leaf = 1; leaf <= leaves; ++leaf) rays.push_back({0, leaf});
    return World("star", Graph::from_edges(leaves + 1, rays), std::vector<bool>(leaves + 1));
  };
  const Task small(star(60), 0, 1);
  const Task large(star(200), 0, 1);
  ExplorerScorer scorer(builtin_explorer());
  EXPECT_FALSE(beam_plan(large, {.width = 1000}, {}, &scorer).optimal);
  EXPECT_FALSE(ExplorerPlanner(std::make_shared<ExplorerScorer>(builtin_explorer())).plan(large).optimal);
  EXPECT_TRUE(beam_plan(small, {.width = 1000}).optimal) << "all leaves are as near as the sixteenth";
  EXPECT_FALSE(beam_plan(large, {.width = 1000}).optimal) << "64 ties are enough";
  // One way out of 200, each longer than the last.
  std::vector<Edge> rays;
  for (NodeId leaf = 1; leaf <= 200; ++leaf) rays.push_back({0, leaf, 1.0 * leaf});
  const World longer("longer", Graph::from_edges(201, rays, EdgeKind::kDirected), std::vector<bool>(201));
  const Task far(longer, 0, 200);
  EXPECT_FALSE(beam_plan(far, {.width = 1000}).optimal);
  EXPECT_TRUE(beam_plan(far, {.width = 1000, .branching = 200}).optimal);
}

// Ties were exempt from branching: a hundred thousand candidates for each of fifty walks of a level, level after level.
TEST(Beam, LooksAtFewTies) {
  constexpr NodeId kLeaves = 100'000;
  std::vector<Edge> rays;
  for (NodeId leaf = 1; leaf <= kLeaves; ++leaf) rays.push_back({0, leaf});
  const World star("star", Graph::from_edges(kLeaves + 1, rays), std::vector<bool>(kLeaves + 1));
  EXPECT_EQ(beam_plan(Task(star, 0, 40), {}).visited, 21);
}

TEST(Beam, TakesTheLongWayPastManyLeavesWhereTheBudgetIsShort) {
  // A hub with leaves, each of which costs two steps, and a path, each node of which costs one. Whatever the numbering,
  // the path is among the first visits looked at, and the rank without penalties prefers it.
  constexpr NodeId kNodes = 100;
  for (const NodeId leaves : {10, 40}) {
    for (const bool path_first : {false, true}) {
      std::vector<Edge> edges;
      for (NodeId i = 1; i < kNodes; ++i) {
        const bool on_path = path_first ? i < kNodes - leaves : i > leaves;
        const bool first = path_first ? i == 1 : i == leaves + 1;
        edges.push_back({on_path && !first ? i - 1 : 0, i});
      }
      const World world("hub", Graph::from_edges(kNodes, edges), std::vector<bool>(kNodes));
      const Plan plan = beam_plan(Task(world, 0, 40), {});
      EXPECT_EQ(plan.visited, 41) << leaves << path_first;
    }
  }
}

NodeSet random_set(const World& world, Rng& rng) {
  NodeSet set(world.node_count());
  for (const NodeId node : world.valid_nodes()) {
    if (rng.below(3) == 0) set.insert(node);
  }
  return set;
}

// As in a world where they have no prize.
TEST(Optimality, LeavesOutWhatOthersHaveClaimed) {
  Rng rng(14);
  const auto search = make_planner("search:200");
  for (int i = 0; i < 500; ++i) {
    SCOPED_TRACE(i);
    const Case c = random_case(rng);
    const NodeSet claimed = random_set(c.world, rng);
    std::vector<double> prizes(c.world.node_count(), 1);
    for (NodeId node = 0; node < c.world.node_count(); ++node) prizes[node] = claimed.contains(node) ? 0 : 1;
    const Task task = c.task().without(claimed);
    const Task other(World("other", c.world.graph(), c.world.blocked(), {}, prizes), c.start, c.budget);
    const Plan exact = ExactPlanner().plan(other);
    ASSERT_EQ(ExactPlanner().plan(task).walk, exact.walk);
    ASSERT_GE(max_prize(task), exact.prize);
    ASSERT_EQ(NearestPlanner().plan(task).walk, NearestPlanner().plan(other).walk);
    const Plan complete = beam_plan(task, {.width = 1000});
    ASSERT_TRUE(complete.optimal);
    ASSERT_NEAR(complete.prize, exact.prize, 1e-9);
    const Plan found = search->plan(task);
    ASSERT_NEAR(found.prize, plan_of_walk(other, found.walk).prize, 1e-9);
    ASSERT_LE(found.prize, exact.prize + 1e-9);
    ASSERT_GE(found.bound, exact.prize - 1e-9);
  }
}

TEST(Optimality, PlansGoOnFromWhereSomeoneElseLed) {
  Rng rng(12);
  for (int i = 0; i < 500; ++i) {
    const Case c = random_case(rng);
    const Task task = c.task().rest(c.start, c.budget, random_set(c.world, rng));
    const auto walk = exact_walk(task);
    ASSERT_TRUE(walk);
    const Plan exact = plan_of_walk(task, *walk);
    ASSERT_GE(max_prize(task), exact.prize);
    ASSERT_LE(beam_plan(task, {}).prize, exact.prize);
    ASSERT_LE(NearestPlanner().plan(task).prize, exact.prize);
    ASSERT_LE(exact.cost, c.budget + 1e-9);
  }
}

TEST(Bound, IsWorkedOutByHand) {
  // A star of four leaves: each leaf but the last is paid twice.
  const std::vector<Edge> star = {{0, 1}, {0, 2}, {0, 3}, {0, 4}};
  const World world("star", Graph::from_edges(5, star), std::vector<bool>(5));
  const auto bound = [](const World& of, NodeId start, double budget, NodeId end = kNoNode) {
    return max_prize(Task(of, start, budget, end == kNoNode ? End::anywhere() : End::at(end)));
  };
  EXPECT_EQ(bound(world, 0, 0), 1);
  EXPECT_EQ(bound(world, 0, 3), 3);
  EXPECT_EQ(bound(world, 0, 6), 4);
  EXPECT_EQ(bound(world, 0, 7), 5);
  EXPECT_EQ(bound(world, 1, 6), 5);
  EXPECT_EQ(bound(world, 1, 5), 4);
  EXPECT_EQ(bound(world, 0, 7, 0), 4) << "home again: the fourth leaf is paid twice too";
  EXPECT_EQ(bound(world, 0, 8, 0), 5);
  EXPECT_EQ(bound(world, 1, 2, 2), 3);
  // Worth 10, 1, 1 and 1: with three steps two leaves, one of them the dear one.
  const World dear("dear", Graph::from_edges(5, star), std::vector<bool>(5), {}, {1, 10, 1, 1, 1});
  EXPECT_GE(bound(dear, 0, 3), 12);
  EXPECT_LE(bound(dear, 0, 3), 12.5);
  // A one-way street of three nodes with a side street at the start: what was left is lost.
  const std::vector<Edge> street = {{0, 1}, {1, 2}, {0, 3}};
  const World one_way("street", Graph::from_edges(4, street, EdgeKind::kDirected), std::vector<bool>(4));
  EXPECT_EQ(bound(one_way, 0, 100), 3);
  EXPECT_EQ(bound(one_way, 2, 100), 1);
  // Two ways that meet: no walk takes both.
  const std::vector<Edge> ways = {{0, 1}, {0, 2}, {1, 3}, {2, 3}};
  const World meeting("ways", Graph::from_edges(4, ways, EdgeKind::kDirected), std::vector<bool>(4));
  EXPECT_EQ(bound(meeting, 0, 100), 3);
  // A checkerboard's colours alternate: of 3 × 3 cells, eight steps from one of the four have at most eight.
  const World board = grid_world("...\n...\n...\n");
  EXPECT_EQ(bound(board, 1, 8), 8);
  EXPECT_EQ(bound(board, 0, 8), 9);
}

// The exact knapsack is quadratic on a corridor; it gives way to the fractional one.
TEST(Bound, TakesItsTimeOnNoCorridor) {
  constexpr NodeId kNodes = 200'000;
  const World corridor = grid_world(std::string(kNodes, '.') + "\n");
  EXPECT_EQ(max_prize(Task(corridor, 0, 1000)), 1001);
  const double both_ends = max_prize(Task(corridor, kNodes / 2, 1.0 * kNodes));
  EXPECT_LE(both_ends, 0.76 * kNodes);
}

TEST(SpendingLimit, IsOneRuleForEpisodesSearchesAndBounds) {
  // 1000.0000005 of 1000 is within the rounding of sums, whoever adds up; two tiny edges of nothing are not, and of
  // whole numbers nothing is.
  const auto path = [](double first, double second) {
    const std::vector<Edge> edges = {{0, 1, first}, {1, 2, second}};
    return World("path", Graph::from_edges(3, edges), std::vector<bool>(3));
  };
  struct Expected {
    World world;
    double budget;
    int visited;
  };
  for (const auto& [world, budget, visited] :
       {Expected{path(999, 1.0000005), 1000, 3}, Expected{path(999, 1.0000005), 999.9, 2},
        Expected{path(1e-10, 1e-10), 0, 1}, Expected{path(1e-10, 1e-10), 1e-10, 2},
        Expected{path(1, 1'000'000'000), 1'000'000'000, 2}, Expected{path(1, 999'999'999), 1'000'000'000, 3}}) {
    const Task task(world, 0, budget);
    EXPECT_EQ(ExactPlanner().plan(task).visited, visited);
    EXPECT_EQ(beam_plan(task, {}).visited, visited);
    EXPECT_EQ(NearestPlanner().plan(task).visited, visited);
    EXPECT_EQ(DepthFirstPlanner().plan(task).visited, visited);
    EXPECT_EQ(max_prize(task), visited);
    Episode episode(world, {.budget = budget, .action_space = ActionSpace::kNeighbours});
    follow_walk(episode, *exact_walk(task));
    EXPECT_EQ(episode.visited_count(), visited);
  }
}

Clock ample() {
  return Clock(3600);
}

TEST(Beam, WithTimeWidensUntilNothingIsDropped) {
  const World world = grid_world("..#..\n.....\n#.#.#\n.....\n..#..\n");
  int improved = 0;
  for (const NodeId node : world.valid_nodes()) {
    const Task task(world, node, 20);
    const double optimum = *exact_prize(task);
    BeamPlanner beam({.width = 1, .branching = 1});
    improved += beam.plan(task).prize < optimum;
    const Plan wide = beam.plan(task, ample());
    EXPECT_TRUE(wide.optimal);
    EXPECT_EQ(wide.prize, optimum);
    const Plan exact = ExactPlanner().plan(task, ample());
    EXPECT_TRUE(exact.optimal);
    EXPECT_EQ(exact.prize, optimum);
  }
  EXPECT_GT(improved, 0) << "a beam of one never goes astray here: the test shows nothing";
}

// Once the time is up, whatever they are at, planners give a walk that can be walked.
TEST(Planners, GiveWhatTheyHaveWhenTheTimeIsUp) {
  const World world = split_world({"obstacles", 60}, Split::kValidation, 0);
  const Task task(world, world.valid_nodes()[0], 1.0 * world.valid_count());
  for (const char* const name : {"dfs", "nearest", "beam", "guided", "explorer", "exact"}) {
    const auto planner = make_planner(name);
    const Plan plan = planner->plan(task, Clock(0));
    Episode episode(world, {.budget = task.budget()});
    follow_walk(episode, plan.walk);
    EXPECT_EQ(episode.visited_count(), plan.visited) << name;
    EXPECT_FALSE(plan.optimal) << name;
    EXPECT_LT(plan.visited, world.valid_count() / 2) << name;
  }
}

TEST(Baselines, FollowOneWayStreetsAndCosts) {
  // 0 → 1 → 2 → 0, and a side street 1 → 3 → 1.
  const std::vector<Edge> edges = {{0, 1, 1}, {1, 2, 1}, {2, 0, 1}, {1, 3, 5}, {3, 1, 1}};
  const World world("streets", Graph::from_edges(4, edges, EdgeKind::kDirected), std::vector<bool>(4));
  const auto walk_of = [&](const char* name, double budget) {
    return make_planner(name)->plan(Task(world, 0, budget)).walk;
  };
  EXPECT_EQ(walk_of("dfs", 20), (std::vector<NodeId>{0, 1, 2, 0, 1, 3}));
  EXPECT_EQ(walk_of("nearest", 20), (std::vector<NodeId>{0, 1, 2, 0, 1, 3}));
  EXPECT_EQ(walk_of("nearest", 8), (std::vector<NodeId>{0, 1, 2})) << "the next first visit costs 7 of 6";
}

}  // namespace
}  // namespace graphdrl
