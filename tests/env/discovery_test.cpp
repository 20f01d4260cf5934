#include "graphdrl/env/discovery.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <vector>

#include "graphdrl/env/episode.h"
#include "graphdrl/planners/registry.h"
#include "graphdrl/planners/rules.h"
#include "support.h"

namespace graphdrl {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::UnorderedElementsAre;

// A connected graph: a random tree with more edges.
std::vector<Edge> random_edges(Rng& rng, int nodes, int more, int most_cost) {
  std::vector<Edge> edges;
  const auto cost = [&] { return 1.0 + rng.index(most_cost); };
  for (NodeId node = 1; node < nodes; ++node) edges.push_back({node, rng.index(node), cost()});
  for (int i = 0; i < more; ++i) {
    const NodeId a = rng.index(nodes);
    const NodeId b = rng.index(nodes);
    const bool there = std::ranges::any_of(
        edges, [&](const Edge& edge) { return (edge.a == a && edge.b == b) || (edge.a == b && edge.b == a); });
    if (a != b && !there) edges.push_back({a, b, cost()});
  }
  return edges;
}

World hidden_graph(int nodes, const std::vector<Edge>& edges, EdgeKind kind = EdgeKind::kUndirected) {
  return World("graph", Graph::from_edges(nodes, edges, kind), std::vector<bool>(nodes));
}

// The nodes known, in the world's numbers.
std::vector<NodeId> seen(const HiddenWorld& hidden) {
  std::vector<NodeId> nodes;
  for (const NodeId node : hidden.view().valid_nodes()) nodes.push_back(hidden.in_world(node));
  return nodes;
}

TEST(Reveal, Parses) {
  for (const char* const text : {"all", "edges", "radius:2.5", "sight:inf"}) {
    EXPECT_EQ(Reveal::parse(text).text(), text);
  }
  for (const char* const text :
       {"", "edge", "edges:1", "radius", "radius:", "radius:0", "radius:-1", "radius:nan", "sight:2m", "all:3"}) {
    EXPECT_THAT(error_of([&] { Reveal::parse(text); }), HasSubstr("bad reveal")) << text;
  }
}

TEST(Discovery, KeepsCostsToTheEnd) {
  Rng rng(5);
  for (const EdgeKind kind : {EdgeKind::kUndirected, EdgeKind::kDirected}) {
    for (int round = 0; round < 20; ++round) {
      Discovery known("test", kind);
      known.see();
      const auto costs = known.keep_costs_to(0);
      std::vector<Edge> edges = random_edges(rng, 15, 20, 9);
      for (const Edge& edge : edges) {
        while (known.view().node_count() <= std::max(edge.a, edge.b)) known.see();
        known.connect(edge);
        ASSERT_EQ(*costs, costs_to(known.view().into(), 0));
      }
      for (; !edges.empty(); edges.pop_back()) {
        known.disconnect(edges.back().a, edges.back().b);
        ASSERT_EQ(*costs, costs_to(known.view().into(), 0));
      }
    }
  }
}

TEST(Discovery, ForgetsWhatWasNoNode) {
  Discovery known("test", EdgeKind::kDirected);
  known.see();
  const NodeId one = known.see({.prize = 3});
  const NodeId two = known.see();
  known.connect({0, one});
  known.connect({0, two});
  known.connect({two, 0});
  EXPECT_EQ(known.view().frontier_neighbours(0), 2);
  known.disconnect(0, one);
  known.forget(one);
  EXPECT_EQ(known.view().frontier_neighbours(0), 1);
  EXPECT_EQ(known.view().frontier_count(), 2);
  EXPECT_EQ(known.view().total_prize(), 2);
  EXPECT_EQ(known.view().prize(one), 0);
  known.disconnect(0, two);
  EXPECT_EQ(known.view().frontier_neighbours(0), 1) << "an arc the other way is left";
  EXPECT_THAT(known.view().both_ways().neighbours(0), ElementsAre(two));
  EXPECT_THAT(known.view().into().neighbours(0), ElementsAre(two));
}

TEST(HiddenWorld, ShowsTheEdgesOfNodesVisited) {
  //  0 - 1 - 2 - 3, and 0 - 3
  HiddenWorld hidden(hidden_graph(4, {{0, 1}, {1, 2}, {2, 3}, {0, 3, 5}}), Reveal::parse("edges"), Score::kVisited, 1,
                     7);
  EXPECT_EQ(hidden.known_as(1), 0);
  EXPECT_THAT(seen(hidden), UnorderedElementsAre(1, 0, 2));
  EXPECT_EQ(hidden.known_as(3), kNoNode);
  EXPECT_FALSE(hidden.view().is_frontier(0));
  EXPECT_TRUE(hidden.view().is_frontier(hidden.known_as(0)));
  hidden.visit(hidden.known_as(0));
  EXPECT_THAT(seen(hidden), UnorderedElementsAre(1, 0, 2, 3));
  EXPECT_EQ(hidden.view().open().edge_count(), 3) << "2 - 3 was not seen";
  EXPECT_EQ(hidden.view().open().max_cost(), 5);
}

TEST(HiddenWorld, ShowsWhereNodesLie) {
  const World map = grid_world("..\n..\n");
  HiddenWorld cells(map, Reveal::parse("edges"), Score::kVisited, 0, 7);
  ASSERT_EQ(cells.view().places().size(), 3u);
  for (NodeId node = 0; node < 3; ++node) EXPECT_EQ(cells.view().places()[node], map.place(cells.in_world(node)));
  HiddenWorld graph(hidden_graph(3, {{0, 1}, {1, 2}}), Reveal::parse("edges"), Score::kVisited, 1, 7);
  EXPECT_TRUE(graph.view().places().empty());
}

TEST(HiddenWorld, ShowsWhatIsWithinARadius) {
  const World path = hidden_graph(6, {{0, 1, 2}, {1, 2, 2}, {2, 3, 2}, {3, 4, 2}, {4, 5, 2}});
  HiddenWorld hidden(path, Reveal::parse("radius:4"), Score::kSeen, 2, 7);
  EXPECT_THAT(seen(hidden), UnorderedElementsAre(2, 0, 1, 3, 4));
  EXPECT_TRUE(hidden.view().is_frontier(hidden.known_as(4)));
  EXPECT_FALSE(hidden.view().is_frontier(hidden.known_as(0))) << "no edge leads on";
  EXPECT_FALSE(hidden.ground().contains(hidden.known_as(4)));
  EXPECT_TRUE(hidden.ground().contains(hidden.known_as(0))) << "there is nothing to be seen";
}

TEST(HiddenWorld, SightEndsAtObstacles) {
  const World world = grid_world(
      ".....\n"
      ".###.\n"
      ".....\n"
      "##.##\n"
      ".....\n");
  HiddenWorld hidden(world, Reveal::parse("sight:10"), Score::kVisited, 12, 7);
  const auto nodes = seen(hidden);
  for (const NodeId cell : {10, 11, 12, 13, 14, 17, 22}) EXPECT_THAT(nodes, testing::Contains(cell)) << cell;
  for (const NodeId cell : {1, 2, 3}) EXPECT_EQ(hidden.known_as(cell), kNoNode) << "behind the wall: " << cell;
  EXPECT_THAT(error_of([&] {
                HiddenWorld(hidden_graph(2, {{0, 1}}), Reveal::parse("sight:1"), Score::kVisited, 0, 1);
              }),
              HasSubstr("sight needs a map of cells"));
}

// Walks the policy to its end, or for so many first visits; gives the walk in the world's numbers.
std::vector<NodeId> explore(Episode& episode, Policy& policy, int visits = 1 << 30) {
  while (!episode.done() && episode.visited_count() < visits) {
    const Observation now = episode.observation();
    int action = kStop;
    policy.act({&now, 1}, {&action, 1});
    if (action == kStop) break;
    EXPECT_TRUE(now.affordable(action));
    episode.step(action);
  }
  return episode.walk_in_world();
}

const std::vector<std::string> kPolicies = {"nearest", "dfs",    "pocket",    "open",     "frontier",
                                            "tour",    "beam:3", "search:40", "explorer", "random-walk"};

// What is not seen may be anything: edges between nodes that were not visited.
TEST(HiddenWorld, LetsNothingThroughThatWasNotSeen) {
  constexpr int kNodes = 24;
  constexpr int kVisits = 9;
  Rng rng(11);
  for (const std::string& name : kPolicies) {
    for (int round = 0; round < 6; ++round) {
      const std::vector<Edge> edges = random_edges(rng, kNodes, 14, 3);
      const World world = hidden_graph(kNodes, edges);
      const EpisodeOptions options{.action_space = ActionSpace::kNeighbours, .reveal = Reveal::parse("edges")};
      const Task task(world, 0, 60, End::at_start());
      Episode episode(world, task, options);
      const std::vector<NodeId> walk = explore(episode, *make_online_policy(parse_policy(name), 1), kVisits);
      std::vector<bool> visited(kNodes);
      for (const NodeId node : walk) visited[node] = true;
      if (!walk.empty()) visited[walk.back()] = false;  // what the last visit shows changes nothing before it
      std::vector<Edge> others;
      for (const Edge& edge : edges) {
        if (visited[edge.a] || visited[edge.b]) others.push_back(edge);
      }
      std::vector<NodeId> rest;
      for (NodeId node = 0; node < kNodes; ++node) {
        if (!visited[node]) rest.push_back(node);
      }
      for (std::size_t i = 1; i < rest.size(); ++i) {
        others.push_back({rest[i], rest[rng.index(static_cast<int>(i))], 1.0 + rng.index(3)});
      }
      const World other = hidden_graph(kNodes, others);
      Episode twin(other, Task(other, 0, 60, End::at_start()), options);
      EXPECT_EQ(explore(twin, *make_online_policy(parse_policy(name), 1), kVisits), walk) << name << " " << round;
    }
  }
}

// Numbers that lead through a grid row by row are worth nothing where they are hidden.
TEST(HiddenWorld, GivesNumbersThatTellNothing) {
  constexpr int kSide = 8;
  constexpr int kRounds = 300;
  const Graph grid = Graph::grid(kSide, kSide);
  Rng rng(3);
  std::vector<NodeId> renamed(kSide * kSide);
  for (NodeId node = 0; node < std::ssize(renamed); ++node) renamed[node] = node;
  for (int left = static_cast<int>(renamed.size()); left > 1; --left)
    std::swap(renamed[rng.index(left)], renamed[left - 1]);
  std::vector<Edge> edges = grid.edges();
  const World in_order = hidden_graph(kSide * kSide, edges);
  for (Edge& edge : edges) edge = {renamed[edge.a], renamed[edge.b]};
  const World shuffled = hidden_graph(kSide * kSide, edges);
  for (const char* const name : {"nearest", "dfs", "pocket", "open", "explorer"}) {
    const auto mean = [&](const World& world, NodeId start) {
      const auto policy = make_online_policy(parse_policy(name), 1);
      Episode episode(world, Task(world, start, 40),
                      {.action_space = ActionSpace::kNeighbours, .reveal = Reveal::parse("edges")});
      double sum = 0;
      for (int round = 0; round < kRounds; ++round) {
        episode.reset(start, round);
        explore(episode, *policy);
        sum += episode.visited_count();
      }
      return sum / kRounds;
    };
    EXPECT_NEAR(mean(in_order, 9), mean(shuffled, renamed[9]), 0.8) << name;  // some three standard errors
  }
}

TEST(HiddenEpisode, AlwaysEndsWhereItMust) {
  Rng rng(17);
  for (const std::string& name : kPolicies) {
    for (const EdgeKind kind : {EdgeKind::kUndirected, EdgeKind::kDirected}) {
      for (int round = 0; round < 4; ++round) {
        std::vector<Edge> edges = random_edges(rng, 20, 30, 4);
        if (kind == EdgeKind::kDirected) {
          for (NodeId node = 0; node < 20; ++node) edges.push_back({node, (node + 1) % 20, 2});
        }
        const World world = hidden_graph(20, edges, kind);
        for (const End& end : {End::at_start(), End::at(13)}) {
          const Task task(world, 0, 45, end);
          Episode episode(world, task, {.action_space = ActionSpace::kNeighbours, .reveal = Reveal::parse("edges")});
          const auto walk = explore(episode, *make_online_policy(parse_policy(name), 1));
          EXPECT_LE(episode.spent(), 45);
          EXPECT_NE(episode.observation().task->cost_to_end(episode.position()), kNoLimit) << name;
          if (name == "random-walk") continue;  // it stops where no move can be paid for
          EXPECT_EQ(episode.position(), episode.task().end()) << name;
        }
      }
    }
  }
}

// An end that is a node becomes the end once it is seen; the way back to the start is kept until then.
TEST(HiddenEpisode, TakesANodeForItsEndOnceItIsSeen) {
  const World path = hidden_graph(5, {{0, 1}, {1, 2}, {2, 3}, {3, 4}});
  Episode episode(path, Task(path, 0, 6, End::at(3)),
                  {.action_space = ActionSpace::kNeighbours, .reveal = Reveal::parse("edges")});
  EXPECT_EQ(episode.task().end(), 0);
  episode.step(0);
  EXPECT_EQ(episode.task().end(), 0);
  episode.step(episode.observation().action_to(2));
  EXPECT_EQ(episode.in_world(episode.task().end()), 3);
  EXPECT_EQ(episode.task().cost_to_end(episode.position()), 1);
}

TEST(HiddenEpisode, CountsWhatIsSeen) {
  const World path = hidden_graph(5, {{0, 1}, {1, 2}, {2, 3}, {3, 4}});
  Episode episode(
      path, Task(path, 0, 6),
      {.action_space = ActionSpace::kNeighbours, .reveal = Reveal::parse("radius:2"), .score = Score::kSeen});
  EXPECT_EQ(episode.prize(), 3);
  const auto policy = make_online_policy(parse_policy("nearest"), 1);
  EXPECT_THAT(explore(episode, *policy), ElementsAre(0, 1, 2)) << "everything has been seen";
  EXPECT_EQ(episode.prize(), 5);
}

}  // namespace
}  // namespace graphdrl
