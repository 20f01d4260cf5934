#include "graphdrl/io/readers.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "../support.h"

namespace graphdrl {
namespace {

using ::testing::HasSubstr;

const std::string kHeader =
    "NAME : four\nTYPE : OP\nCOMMENT : a: b\nDIMENSION : 4\nCOST_LIMIT : 20\nEDGE_WEIGHT_TYPE : EUC_2D\n";
const std::string kPlaces = "NODE_COORD_SECTION\n1 0 0\n3 3.0e0 4\n2 0 1.5\n4 0 0\n";
const std::string kScores = "NODE_SCORE_SECTION\n1 0\n2 7\n3 2\n4 5\n";
const std::string kDepot = "DEPOT_SECTION\n 2\n -1\nEOF\n";

GraphMap parse(const std::string& text) {
  return parse_tsplib(text, "four.oplib");
}

std::string replaced(std::string text, const std::string& what, const std::string& with) {
  return text.replace(text.find(what), what.size(), with);
}

TEST(Tsplib, ReadsAnOrienteeringProblem) {
  const std::string text = kHeader + kPlaces + kScores + kDepot;
  EXPECT_TRUE(is_tsplib(text));
  EXPECT_FALSE(is_tsplib("..#\n"));
  EXPECT_FALSE(is_tsplib(""));
  const GraphMap map = parse(text);
  EXPECT_EQ(map.labels, (std::vector<std::string>{"1", "2", "3", "4"}));
  EXPECT_EQ(map.prizes, (std::vector<double>{0, 7, 2, 5}));
  EXPECT_EQ(map.task.budget, 20);
  EXPECT_EQ(map.task.start, 1);
  EXPECT_EQ(map.task.end, 1);
  const Graph& graph = map.graph;
  EXPECT_TRUE(graph.is_complete() && graph.weighted() && graph.integer_costs() && !graph.directed());
  EXPECT_EQ(graph.edge_count(), 6);
  const std::vector<std::vector<double>> costs = {{0, 2, 5, 0}, {2, 0, 4, 2}, {5, 4, 0, 5}, {0, 2, 5, 0}};
  for (NodeId node = 0; node < 4; ++node) {
    EXPECT_EQ(graph.degree(node), 3);
    EXPECT_EQ(graph.index_of(node, node), -1);
    for (NodeId other = 0; other < 4; ++other) {
      if (other == node) continue;
      const int index = graph.index_of(node, other);
      EXPECT_EQ(graph.neighbours(node)[index], other);
      EXPECT_EQ(graph.cost(node, index), costs[node][other]);
    }
  }
  EXPECT_EQ(graph.min_cost(), 0);
  EXPECT_EQ(graph.max_cost(), 5);
  EXPECT_EQ(graph.mean_cost(), 3);
  EXPECT_EQ(graph.without({false, true, false, false}).edge_count(), 3);
}

TEST(Tsplib, TakesSectionsAndKeywordsInAnyOrder) {
  const std::string whole = kHeader + kPlaces + kScores + kDepot;
  const std::string sections = kScores + "DEPOT_SECTION\n2\n-1\n" + kPlaces;
  for (const std::string& text : {sections + kHeader + "EOF\n", kPlaces + kHeader + kScores + kDepot}) {
    EXPECT_TRUE(is_tsplib(text));
    const GraphMap map = parse(text);
    EXPECT_EQ(map.prizes, parse(whole).prizes);
    EXPECT_EQ(map.task.start, 1);
    EXPECT_EQ(map.graph.mean_cost(), 3);
  }
  const GraphMap matrix = parse(
      "TYPE: TSP\nEDGE_WEIGHT_SECTION\n1 2\n3\nDIMENSION: 3\nEDGE_WEIGHT_FORMAT: UPPER_ROW\nEDGE_WEIGHT_TYPE: "
      "EXPLICIT");
  EXPECT_EQ(matrix.graph.cost(1, 0), 3);
}

// As TSPLIB's bayg29 and others have them.
TEST(Tsplib, TakesCommentsBehindTypes) {
  const std::string text = replaced(kHeader, ": OP", ": OP (by hand)") + kPlaces + kScores + kDepot;
  EXPECT_EQ(parse(replaced(text, ": EUC_2D", ": EUC_2D  rounded")).graph.max_cost(), 5);
}

TEST(Tsplib, SkipsWhatChangesNothing) {
  const std::string more =
      "COMMENT : more\nTSPSOL : 7\nNODE_COORD_TYPE : TWOD_COORDS\nDISPLAY_DATA_TYPE : "
      "COORD_DISPLAY\nEDGE_WEIGHT_FORMAT : "
      "FUNCTION\n";
  EXPECT_EQ(parse(more + kHeader + kPlaces + kScores + kDepot).graph.max_cost(), 5);
  EXPECT_TRUE(is_tsplib(more.substr(more.find("TSPSOL"))));
}

// Lengths of edges that TSPLIB's own instances have: burma14 from 1 to 2, att48 from 1 to 2 and from 1 to 3.
TEST(Tsplib, ComputesTheDistancesOfTsplib) {
  const auto cost = [](const std::string& type, const std::string& one, const std::string& other) {
    return parse("TYPE: TSP\nDIMENSION: 2\nEDGE_WEIGHT_TYPE: " + type + "\nNODE_COORD_SECTION\n1 " + one + "\n2 " +
                 other + "\n")
        .graph.cost(0, 0);
  };
  EXPECT_EQ(cost("GEO", "16.47 96.10", "16.47 94.44"), 153);
  EXPECT_EQ(cost("ATT", "6734 1453", "2233 10"), 1495);
  EXPECT_EQ(cost("ATT", "6734 1453", "5530 1424"), 381);
  EXPECT_EQ(cost("CEIL_2D", "0 0", "1 1"), 2);
  EXPECT_EQ(cost("EUC_2D", "0 0", "1 1"), 1);
  EXPECT_EQ(cost("EUC_2D", "-1e15 0", "1e15 0"), 2e15);
  for (const char* const type : {"EUC_2D", "CEIL_2D", "GEO", "ATT"}) {
    EXPECT_THAT(error_of([&] { cost(type, "0 0", "1e200 0"); }), HasSubstr(":6: too large a number in NODE_COORD"));
  }
}

TEST(Tsplib, ReadsMatricesInEveryForm) {
  const auto read = [](const std::string& format, const std::string& numbers) {
    const Graph graph = parse("TYPE: TSP\nDIMENSION: 3\nEDGE_WEIGHT_TYPE: EXPLICIT\nEDGE_WEIGHT_FORMAT: " + format +
                              "\nEDGE_WEIGHT_SECTION\n" + numbers + "\nEOF\n")
                            .graph;
    return std::vector<double>{graph.cost(0, 0), graph.cost(0, 1), graph.cost(1, 0)};
  };
  const std::vector<double> expected = {1, 2, 3};
  EXPECT_EQ(read("FULL_MATRIX", "0 1 2 1 0 3 2 3 0"), expected);
  EXPECT_EQ(read("UPPER_ROW", "1 2\n3"), expected);
  EXPECT_EQ(read("LOWER_ROW", "1 2 3"), expected);
  EXPECT_EQ(read("UPPER_DIAG_ROW", "0 1 2 0 3 0"), expected);
  EXPECT_EQ(read("LOWER_DIAG_ROW", "0 1 0 2 3 0"), expected);
  EXPECT_THAT(error_of([&] { read("FULL_MATRIX", "0 1 2 1 0 3 2 4 0"); }), HasSubstr("not symmetric"));
  EXPECT_THAT(error_of([&] { read("FUNCTION", ""); }), HasSubstr("bad EDGE_WEIGHT_FORMAT"));
  EXPECT_THAT(error_of([&] { read("UPPER_ROW", "1 2"); }), HasSubstr("EDGE_WEIGHT_SECTION"));
  EXPECT_THAT(error_of([&] { read("UPPER_ROW", "1 -2 3"); }), HasSubstr("a negative cost"));
  for (const char* const cost : {"1e999", "nan", "inf", "-inf"}) {
    EXPECT_THAT(error_of([&] { read("UPPER_ROW", fmt::format("1 {} 3", cost)); }), HasSubstr("not a number in EDGE"));
  }
  EXPECT_THAT(error_of([&] { read("UPPER_ROW", "1 1e308 1e308"); }), HasSubstr("too large a number in EDGE"));
}

TEST(Tsplib, TakesNoMoreMemoryThanTheFileCanFill) {
  const auto matrix = [](int nodes, const std::string& format) {
    return fmt::format(
        "TYPE : TSP\nDIMENSION : {}\nEDGE_WEIGHT_TYPE : EXPLICIT\nEDGE_WEIGHT_FORMAT : {}\n"
        "EDGE_WEIGHT_SECTION\n",
        nodes, format);
  };
  EXPECT_THAT(error_of([&] { parse(matrix(20'000, "FULL_MATRIX") + "0 1\n"); }),
              HasSubstr("bad DIMENSION: a number of nodes from 1 to 114, for a file of this size"));
  // Too few numbers are known before the first one is read.
  for (const char* const format : {"FULL_MATRIX", "UPPER_ROW", "LOWER_DIAG_ROW"}) {
    EXPECT_THAT(error_of([&] { parse(matrix(20'000, format) + std::string(20'000, ' ') + "x"); }),
                HasSubstr("the file ends within EDGE_WEIGHT_SECTION"));
  }
  EXPECT_EQ(parse(matrix(3, "UPPER_ROW") + "1 2 3").graph.node_count(), 3);
}

TEST(Tsplib, SaysWhatIsWrong) {
  const std::string whole = kHeader + kPlaces + kScores + kDepot;
  const std::vector<std::pair<std::string, std::string>> cases = {
      {kHeader + kPlaces + kScores, "DEPOT_SECTION is missing"},
      {kHeader + kPlaces + kDepot, "NODE_SCORE_SECTION is missing"},
      {kHeader + kScores + kDepot, "NODE_COORD_SECTION is missing"},
      {replaced(whole, "COST_LIMIT : 20\n", ""), "COST_LIMIT is missing"},
      {replaced(whole, "DIMENSION : 4\n", ""), "DIMENSION is missing"},
      {replaced(whole, ": 4\n", ": 5\n"), "not a number in NODE_COORD_SECTION"},
      {replaced(whole, ": 4\n", ": 0\n"), "bad DIMENSION"},
      {replaced(whole, ": 20", ": -20"), "a negative COST_LIMIT"},
      {replaced(whole, ": 20", ": many"), "not a number in COST_LIMIT"},
      {replaced(whole, "EUC_2D", "XRAY1"), "bad EDGE_WEIGHT_TYPE"},
      {replaced(whole, "EUC_2D", "EXPLICIT"), "EDGE_WEIGHT_SECTION is missing"},
      {replaced(whole, ": OP", ": ATSP"), "bad TYPE"},
      {replaced(whole, "4 5\n", "4 -5\n"), "a negative score"},
      {replaced(whole, "4 5\n", "4 1e308\n"), "too large a number in NODE_SCORE_SECTION: got '1e308'"},
      {replaced(whole, "4 5\n", "4 nan\n"), "not a number in NODE_SCORE_SECTION"},
      {replaced(whole, "4 5\n", "3 5\n"), "four.oplib:16: node 3 comes twice in NODE_SCORE_SECTION"},
      {replaced(whole, "4 0 0\n", "1 9 9\n"), "four.oplib:11: node 1 comes twice in NODE_COORD_SECTION"},
      {replaced(whole, " 2\n -1", " 7\n -1"), "no such depot"},
      {replaced(whole, " 2\n -1", " 2 3\n -1"), "more than one depot"},
      {replaced(whole, " 2\n -1", " -1"), "names no depot"},
      {replaced(whole, "NODE_SCORE", "NODE_SCARE"), "an unknown section"},
      {replaced(whole, "COMMENT", "COMMENTS"), "four.oplib:3: an unknown keyword: got 'COMMENTS'"},
      {replaced(whole, "COST_LIMIT", "Cost_Limit"), "four.oplib:5: an unknown keyword: got 'Cost_Limit'"},
      {replaced(whole, "4 0 0\n", "4 0 0\n5 0 0\n"), "four.oplib:12: an unknown keyword: got '5'"},
      {replaced(whole, "TYPE : OP\n", "TYPE : OP\nTYPE : TSP\n"), "four.oplib:3: TYPE comes twice"},
      {replaced(whole, "DEPOT_SECTION", kScores + "DEPOT_SECTION"), "four.oplib:17: NODE_SCORE_SECTION comes twice"},
      {whole.substr(0, whole.find("-1")), "the file ends within DEPOT_SECTION"},
      {whole.substr(0, whole.find("4 5\n")), "the file ends within NODE_SCORE_SECTION"},
  };
  for (const auto& [text, expected] : cases) {
    EXPECT_THAT(error_of([&] { parse(text); }), ::testing::AllOf(HasSubstr(expected), HasSubstr("four.oplib")));
  }
}

}  // namespace
}  // namespace graphdrl
