#include "graphdrl/report/plan_files.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "explored.h"
#include "graphdrl/io/file.h"
#include "support.h"

namespace graphdrl {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

World labelled_world() {
  const std::vector<Edge> edges = {{0, 1, 2.5}, {1, 2, 1}};
  return World("map", Graph::from_edges(3, edges), std::vector<bool>(3), {"a, \"b\"", "7", "<c>"}, {}, {},
               {.points = {{0, 0}, {0, 2}, {-1, 2}}, .unit = "m"});
}

Answer report_of(const World& world, std::vector<NodeId> walk) {
  const Task task(world, walk.front(), 10);
  Answer answer{.world = world, .task = task, .policy = "search", .plan = plan_of_walk(task, std::move(walk))};
  answer.plan.bound = 3;
  return answer;
}

class PlanFiles : public ::testing::Test {
 protected:
  std::string written(const Answer& answer, const std::string& name) {
    write_plan(answer, (folder_ / name).string());
    return read_file(folder_ / name);
  }

  TemporaryFolder folder_;
};

TEST_F(PlanFiles, CsvHasEveryStep) {
  EXPECT_EQ(written(report_of(labelled_world(), {0, 1, 0}), "a.csv"),
            "step,node,label,x,y,cost,visited\n0,0,\"a, \"\"b\"\"\",0,0,0,1\n1,1,7,0,2,2.5,2\n2,0,\"a, "
            "\"\"b\"\"\",0,0,5,2\n");
  EXPECT_EQ(written(report_of(grid_world("..\n#.\n"), {0, 0, 1}), "b.csv"),
            "step,node,row,column,cost,visited\n0,0,0,0,0,1\n1,0,0,0,1,1\n2,1,0,1,2,2\n");
}

TEST_F(PlanFiles, RosPathLooksAhead) {
  const std::string path = written(report_of(labelled_world(), {0, 1, 2}), "a.yaml");
  const double half = std::numbers::sqrt2 / 2;
  EXPECT_THAT(path,
              HasSubstr(fmt::format("position: {{x: 0, y: 0, z: 0.0}}\n      orientation: {{x: 0.0, y: 0.0, z: {}",
                                    std::sin(std::numbers::pi / 4))));
  EXPECT_NEAR(half, std::sin(std::numbers::pi / 4), 1e-12);
  EXPECT_THAT(path, HasSubstr("position: {x: -1, y: 2, z: 0.0}\n      orientation: {x: 0.0, y: 0.0, z: 1, w: 6"));
}

TEST_F(PlanFiles, GeoJsonHasALineAndThePoints) {
  const auto json = nlohmann::json::parse(written(report_of(labelled_world(), {0, 1}), "a.geojson"));
  EXPECT_EQ(json["features"].size(), 4u);
  EXPECT_EQ(json["features"][0]["geometry"]["coordinates"].dump(), "[[0.0,0.0],[0.0,2.0]]");
  EXPECT_EQ(json["features"][2]["properties"]["visit_order"], 1);
  EXPECT_TRUE(json["features"][3]["properties"]["visit_order"].is_null());
}

TEST_F(PlanFiles, GraphsHaveTheOrderOfVisits) {
  const Answer answer = report_of(labelled_world(), {0, 1, 0});
  EXPECT_THAT(written(answer, "a.graphml"), HasSubstr("<data key=\"visit_order\">1</data>"));
  EXPECT_THAT(written(answer, "a.dot"),
              HasSubstr("1 [label=\"7\", pos=\"0,2\", visit_order=\"1\"];\n  2 [label=\"<c>\", pos"));
}

TEST_F(PlanFiles, RefuseWhatTheyCannotHold) {
  const World grid = grid_world("..\n");
  EXPECT_THAT(error_of([&] { check_plan_file(grid, "a.pdf"); }), HasSubstr("expected .json, .csv"));
  EXPECT_THAT(error_of([&] { check_plan_file(grid, "a.geojson"); }), HasSubstr("needs coordinates"));
  EXPECT_THAT(error_of([&] { check_plan_file(grid, "a.yaml"); }), HasSubstr("needs coordinates"));
  EXPECT_EQ(error_of([&] { check_plan_file(grid, "a.anim.svg"); }), "");
}

TEST_F(PlanFiles, WalksAreReadBack) {
  const World world = labelled_world();
  const Answer answer = report_of(world, {0, 1, 2, 1});
  for (const char* const name : {"a.csv", "a.json"}) {
    written(answer, name);
    EXPECT_THAT(read_plan(world, (folder_ / name).string()).plan.walk, ElementsAre(0, 1, 2, 1)) << name;
  }
  const auto read = [&](const std::string& text) {
    write_file(folder_ / "walk", text);
    return read_plan(world, (folder_ / "walk").string()).plan.walk;
  };
  EXPECT_THAT(read("\"a, \"\"b\"\"\"\n7\n<c>\n"), ElementsAre(0, 1, 2));
  EXPECT_THAT(read(format_walk(world, std::vector<NodeId>{0, 1, 2})), ElementsAre(0, 1, 2));
  EXPECT_THAT(read("cost,label\n1,7\n2,<c>\n"), ElementsAre(1, 2));
  EXPECT_THAT(read("[0, \"7\", 2]"), ElementsAre(0, 1, 2));
  EXPECT_THAT(read("# comment\n#0\n7\n"), ElementsAre(0, 1));
  EXPECT_THAT(error_of([&] { read(""); }), HasSubstr("the walk is empty"));
  EXPECT_THAT(error_of([&] { read("7\nnowhere\n"); }), HasSubstr("walk:2: node outside the map"));
  EXPECT_THAT(error_of([&] { read("cost,label\n1\n"); }), HasSubstr("walk:2: no node"));
  EXPECT_THAT(error_of([&] { read("{\"walk\": 3}"); }), HasSubstr("no walk"));
  EXPECT_THAT(error_of([&] { read("[1.5]"); }), HasSubstr("not a node"));
  EXPECT_THAT(error_of([&] { read("[9]"); }), HasSubstr("step 0 outside the map"));
}

TEST_F(PlanFiles, AWalkOnOneLineIsReadWhole) {
  const World world = grid_world("...\n...\n");
  const auto read = [&](const std::string& text) { return parse_plan(world, text, "walk").plan.walk; };
  EXPECT_THAT(read("0 1 2\n"), ElementsAre(0, 1, 2));
  EXPECT_THAT(read("# by hand\n0, 1, 2\n\n"), ElementsAre(0, 1, 2));
  EXPECT_THAT(read("node visited\n0 1\n"), ElementsAre(0));
  EXPECT_THAT(read("0,5\n1,9\n"), ElementsAre(0, 1));
  EXPECT_EQ(format_walk(world, std::vector<NodeId>{0, 1}), "node\n0\n1\n");
  // Either of two walks, or one and something beside it.
  EXPECT_THAT(error_of([&] { read("0 1 2\n1 2 5\n"); }), HasSubstr("walk:1: several words a line"));
}

TEST_F(PlanFiles, WhatAWalkHasSeenIsReadBack) {
  const World world = labelled_world();
  const Answer answer = explored(world, "radius:1.5", {0, 1});
  EXPECT_THAT(answer.discovered.after_step, ElementsAre(2, 3));
  written(answer, "a.json");
  const Answer read = read_plan(world, (folder_ / "a.json").string());
  EXPECT_EQ(read.reveal.text(), "radius:1.5");
  EXPECT_EQ(read.score, Score::kVisited);
  EXPECT_EQ(read.discovered.nodes, answer.discovered.nodes);
  EXPECT_EQ(read.discovered.after_step, answer.discovered.after_step);

  const auto discovery = [&](const std::string& reveal, const std::string& nodes, const std::string& counts) {
    return parse_plan(world,
                      fmt::format(R"({{"walk": [0, 1], "reveal": {}, "score": "seen", "seen_nodes": {}, )"
                                  R"("seen_after_step": {}}})",
                                  reveal, nodes, counts),
                      "walk");
  };
  EXPECT_EQ(discovery("\"edges\"", "[0, 1, 2]", "[2, 3]").score, Score::kSeen);
  EXPECT_THAT(error_of([&] { discovery("\"far\"", "[0, 1]", "[2, 2]"); }), HasSubstr("walk: bad reveal"));
  EXPECT_THAT(error_of([&] { discovery("\"edges\"", "3", "[2, 2]"); }), HasSubstr("walk: bad seen_nodes"));
  EXPECT_THAT(error_of([&] { discovery("\"edges\"", "[0, 0]", "[2, 2]"); }), HasSubstr("each node once"));
  EXPECT_THAT(error_of([&] { discovery("\"edges\"", "[0, 9]", "[2, 2]"); }), HasSubstr("walk: seen_nodes outside"));
  for (const char* const counts : {"[2]", "[2, 1]", "[2, 3]", "[0, 2]", "[2, \"2\"]"}) {
    EXPECT_THAT(error_of([&] { discovery("\"edges\"", "[0, 1]", counts); }), HasSubstr("walk: bad seen_after_step"))
        << counts;
  }
  EXPECT_TRUE(parse_plan(world, R"({"walk": [0], "reveal": "edges"})", "walk").reveal.all()) << "the rest is missing";
}

TEST(ReadPlan, TellsNodesFromComments) {
  const World world("map", Graph::from_edges(2, std::vector<Edge>{{0, 1}}), std::vector<bool>(2), {"#1", "% x"});
  const auto walk_of = [&](const std::string& text) { return parse_plan(world, text, "walk").plan.walk; };
  EXPECT_THAT(walk_of("# 1\n#1\n\"% x\"\n%\n"), ElementsAre(0, 1));
  EXPECT_THAT(walk_of("#0 \"% x\"\n"), ElementsAre(0, 1));
}

// A number is a node's id, whatever the nodes are called.
TEST(ReadPlan, TakesNumbersForIds) {
  const World world("map", Graph::from_edges(2, std::vector<Edge>{{0, 1}}), std::vector<bool>(2), {"#1", "0"});
  EXPECT_THAT(parse_plan(world, "[1, 0]", "walk").plan.walk, ElementsAre(1, 0));
  EXPECT_THAT(parse_plan(world, "node\n1\n0\n", "walk").plan.walk, ElementsAre(1, 0));
}

TEST(ReadPlan, NamesTheFileOfABadTask) {
  const World world = labelled_world();
  EXPECT_THAT(error_of([&] { parse_plan(world, R"({"walk": [0], "budget": -5})", "walk"); }),
              HasSubstr("walk: bad budget"));
  EXPECT_THAT(error_of([&] { parse_plan(world, R"({"walk": [0], "budget": 1, "end": 2})", "walk"); }),
              HasSubstr("walk: map: the end cannot be reached within the budget"));
}

// Whatever a file says of a bound, no walk visits more nodes than there are, or fewer than none.
TEST(ReadPlan, KeepsTheMostVisitedWithinTheMap) {
  const World world = labelled_world();
  EXPECT_EQ(parse_plan(world, "7\n", "walk").max_visited(), 3) << "no bound";
  EXPECT_EQ(parse_plan(world, R"({"walk": [0], "upper_bound": 1e300})", "walk").max_visited(), 3);
  EXPECT_EQ(parse_plan(world, R"({"walk": [0], "upper_bound": -1e300})", "walk").max_visited(), 0);
  EXPECT_EQ(parse_plan(world, R"({"walk": [0], "upper_bound": 66.7})", "walk").max_visited(), 2);
}

}  // namespace
}  // namespace graphdrl
