#include "graphdrl/planners/frontier.h"

#include <gmock/gmock.h>

#include "graphdrl/env/discovery.h"
#include "graphdrl/eval/rollout.h"
#include "graphdrl/planners/rules.h"
#include "support.h"

namespace graphdrl {
namespace {

using ::testing::UnorderedElementsAre;

// What is known of a map: edges among `ground` nodes, which come first, and to the frontier.
class KnownPart {
 public:
  KnownPart(int nodes, int ground, const std::vector<Edge>& edges, const std::vector<Point>& places = {})
      : known_("part", EdgeKind::kUndirected), ground_(nodes), count_(ground) {
    for (NodeId node = 0; node < nodes; ++node) {
      known_.see(places.empty() ? Discovery::Seen() : Discovery::Seen{.place = places[node]});
    }
    for (const Edge& edge : edges) known_.connect(edge);
    for (NodeId node = 0; node < ground; ++node) {
      known_.close(node);
      ground_.insert(node);
    }
  }

  // From node 0.
  std::vector<FrontierPart> parts(int most_steps) { return frontier_parts(exploration(), search_, most_steps); }
  NodeId begin(int smallest_part = 1) { return begin_of_frontier_tour(exploration(), search_, smallest_part); }

 private:
  Exploration exploration() {
    task_.emplace(known_.view(), 0, kNoLimit, End::anywhere());
    return {*task_, ground_, count_, 0, task_->limit()};
  }

  Discovery known_;
  NodeSet ground_;
  int count_;
  std::optional<Task> task_;
  NearestFirst search_;
};

//   3 - 4   6    0, 1 and 2 are ground
//   |   |   |
//   1 - 5   |
//    \     /
//     0 - 2 - 7
TEST(FrontierParts, AreFirstVisitsNextToEachOtherOrToTheSameGround) {
  KnownPart map(8, 3, {{0, 1}, {0, 2}, {1, 3}, {1, 5}, {3, 4}, {4, 5}, {2, 6}, {2, 7}});
  const auto sizes = [](const std::vector<FrontierPart>& parts) {
    std::vector<int> all;
    for (const FrontierPart& part : parts) all.push_back(part.size);
    return all;
  };
  // 4 is a first visit once 3 or 5 is ground.
  EXPECT_THAT(sizes(map.parts(9)), UnorderedElementsAre(2, 2));
  EXPECT_THAT(sizes(map.parts(0)), UnorderedElementsAre(1, 1, 1, 1));
  EXPECT_EQ(map.parts(9).front().nearest.cost, 2);
}

// From 0 two steps to the frontier at 11, three to 12 on the other side, and eight to 13 beyond the first:
//   13 - 7 - 6 - 5 - 4 - 3 - 2 - 1 - 0 - 8 - 9 - 12, and 11 beside 1
std::vector<Edge> line_with_a_branch() {
  std::vector<Edge> edges = {{0, 8}, {8, 9}, {9, 12}, {1, 11}, {7, 13}};
  for (NodeId node = 0; node < 7; ++node) edges.push_back({node, node + 1});
  return edges;
}

TEST(FrontierTour, BeginsWhereAShortTourDoesAndNotWhereItIsNearest) {
  KnownPart map(14, 10, line_with_a_branch());
  EXPECT_EQ(map.parts(9).front().nearest.node, 11);
  // 12, 11, 13 costs 3 + 5 + 8; from 11 on the best costs 2 + 5 + 11.
  EXPECT_EQ(map.begin(), 12);
}

// Were there a straight way from 12 to 13, 11 would come first: 2 + 5 + 6 and not 3 + 6 + 8.
TEST(FrontierTour, TakesStraightWaysForPossible) {
  std::vector<Point> places(14);
  places[11] = {-2, 0};
  places[12] = {3, 0};
  places[13] = {3, 1};
  for (NodeId node = 1; node <= 7; ++node) places[node] = {-node / 1.0, 0};
  EXPECT_EQ(KnownPart(14, 10, line_with_a_branch(), places).begin(), 11);
}

// A dead end of one first visit is next to the position, four first visits are two steps away.
TEST(FrontierTour, LeavesSmallPartsForLater) {
  std::vector<Edge> edges = {{0, 1}, {0, 3}, {1, 2}};
  for (NodeId node = 4; node < 8; ++node) edges.push_back({2, node});
  KnownPart map(8, 3, edges);
  EXPECT_EQ(map.begin(), 3);
  EXPECT_EQ(map.begin(4), 4);
  EXPECT_EQ(map.begin(5), 3) << "there is no larger one";
  EXPECT_EQ(KnownPart(3, 3, {{0, 1}, {1, 2}}).begin(), kNoNode);
}

// Rooms of which a robot sees what is in sight: it sees them all, and comes home.
TEST(FrontierTour, SeesAWholeMapAndComesHome) {
  const World world = grid_world(
      "..........#..........\n"
      "..........#..........\n"
      ".....................\n"
      "..........#..........\n"
      "####.##########.#####\n"
      "..........#..........\n"
      "..........#..........\n"
      "..........#..........\n");
  const EpisodeOptions options{
      .action_space = ActionSpace::kNeighbours, .reveal = Reveal::parse("sight:6"), .score = Score::kSeen};
  for (const End& end : {End::anywhere(), End::at_start()}) {
    RulePolicy policy(Rule::kTour);
    Discovered discovered;
    const Plan plan = plan_by_steps(world, Task(world, 0, kNoLimit, end), options, policy, {}, kNoLimit, &discovered);
    EXPECT_EQ(std::ssize(discovered.nodes), world.valid_count());
    if (end.of(0) == 0) {
      EXPECT_EQ(plan.walk.back(), 0);
    }
  }
}

}  // namespace
}  // namespace graphdrl
