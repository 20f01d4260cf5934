#include "graphdrl/planners/frontier.h"

#include <gmock/gmock.h>

#include <optional>

#include "graphdrl/env/discovery.h"
#include "graphdrl/eval/rollout.h"
#include "graphdrl/planners/rules.h"
#include "support.h"

namespace graphdrl {
namespace {

using ::testing::ElementsAre;

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
  std::vector<FrontierPart> parts(int most_steps) {
    return frontier_parts(exploration(End::anywhere()), search_, most_steps);
  }
  NodeId first_stop(int smallest_part = 1, const End& end = End::anywhere()) {
    return first_stop_of_frontier_tour(exploration(end), search_, smallest_part);
  }

 private:
  Exploration exploration(const End& end) {
    task_.emplace(known_.view(), 0, kNoLimit, end);
    return {*task_, ground_, count_, 0, task_->limit()};
  }

  Discovery known_;
  NodeSet ground_;
  int count_;
  std::optional<Task> task_;
  NearestFirst search_;
};

std::vector<int> sizes_of(const std::vector<FrontierPart>& parts) {
  std::vector<int> sizes;
  for (const FrontierPart& part : parts) sizes.push_back(part.size);
  return sizes;
}

// Ground is 0, 1 and 2. Beside 1 are 3 and 4, beside 2 are 5 and 6.
TEST(FrontierParts, AreFirstVisitsNextToEachOtherOrToTheSameGround) {
  const std::vector<Edge> edges = {{0, 1}, {0, 2}, {1, 3}, {1, 4}, {2, 5}, {2, 6}};
  KnownPart apart(7, 3, edges);
  EXPECT_THAT(sizes_of(apart.parts(9)), ElementsAre(2, 2));
  EXPECT_THAT(sizes_of(apart.parts(0)), ElementsAre(1, 1, 1, 1));
  EXPECT_EQ(apart.parts(9).front().nearest.cost, 2);
  std::vector<Edge> joined = edges;
  joined.push_back({4, 5});
  KnownPart together(7, 3, joined);
  EXPECT_THAT(sizes_of(together.parts(3)), ElementsAre(4)) << "3, 4, 5, 6";
  EXPECT_THAT(sizes_of(together.parts(2)), ElementsAre(3, 1));
}

// Ways from 0: two steps to the frontier at 10, seven to 12 beyond it, and three to 11 on the other side.
//   12 - 7 - 6 - 5 - 4 - 3 - 2 - 1 - 0 - 8 - 9 - 11, and 10 beside 1
std::vector<Edge> line_with_a_branch() {
  std::vector<Edge> edges = {{0, 8}, {8, 9}, {9, 11}, {1, 10}, {7, 12}};
  for (NodeId node = 0; node < 7; ++node) edges.push_back({node, node + 1});
  return edges;
}

TEST(FrontierTour, BeginsWhereAShortTourDoesAndNotWhereItIsNearest) {
  KnownPart map(13, 10, line_with_a_branch());
  EXPECT_EQ(map.parts(9).front().nearest.node, 10);
  // 11, 10, 12 costs 3 + 5 + 8; from 10 on the best costs 2 + 5 + 11.
  EXPECT_EQ(map.first_stop(), 11);
}

TEST(FrontierTour, EndsWhereTheWalkMust) {
  KnownPart map(13, 10, line_with_a_branch());
  // To the end at 9: with 11 last, both other orders cost 22; 11, 10, 12 costs 3 + 5 + 8 + 10.
  EXPECT_NE(map.first_stop(1, End::at(9)), 11);
}

// 11 and 12 are at one place, so that the way between them is taken to cost half of the known one, 5.5. 10, 11, 12 then
// costs 11.2, and 11, 10, 12 costs 11.9.
TEST(FrontierTour, TakesStraightWaysForPossible) {
  std::vector<Point> places(13, {0, 0});
  for (NodeId node = 1; node <= 7; ++node) places[node] = {-2.0 * node, 0};
  places[8] = {2, 0};
  places[9] = {4, 0};
  places[10] = {-2, 2};
  places[11] = places[12] = {6, 0};
  EXPECT_EQ(KnownPart(13, 10, line_with_a_branch(), places).first_stop(), 10);
}

// A dead end of one first visit is next to the position, four first visits are three steps away.
TEST(FrontierTour, LeavesSmallPartsForLater) {
  std::vector<Edge> edges = {{0, 1}, {0, 3}, {1, 2}};
  for (NodeId node = 4; node < 8; ++node) edges.push_back({2, node});
  KnownPart map(8, 3, edges);
  EXPECT_EQ(map.first_stop(), 3);
  EXPECT_EQ(map.first_stop(4), 4);
  EXPECT_EQ(map.first_stop(5), 3) << "there is no larger one";
  EXPECT_EQ(KnownPart(3, 3, {{0, 1}, {1, 2}}).first_stop(), kNoNode);
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
