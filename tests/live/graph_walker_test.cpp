#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "graphdrl/live/graph_walker_service.h"
#include "support.h"

namespace graphdrl {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

// A login: begins by an edge from nowhere.
constexpr const char* kLogin = R"json({"models":[{"name":"Login","generator":"random(edge_coverage(100))",
  "startElementId":"e0","vertices":[{"id":"v0","name":"v_start"},{"id":"v1","name":"v_home","properties":{"x":1}},
  {"id":"v2","name":"v_error"}],
  "edges":[{"id":"e0","name":"e_open","targetVertexId":"v0"},
  {"id":"e1","name":"e_in","sourceVertexId":"v0","targetVertexId":"v1"},
  {"id":"e2","name":"e_bad","sourceVertexId":"v0","targetVertexId":"v2"},
  {"id":"e3","name":"e_back","sourceVertexId":"v2","targetVertexId":"v0"},
  {"id":"e4","name":"e_out","sourceVertexId":"v1","targetVertexId":"v0"},
  {"id":"e5","name":"e_again","sourceVertexId":"v1","targetVertexId":"v1"}]
}]
})json";

std::vector<std::string> walk(const std::string& generator, const char* model = kLogin, int most = 1000) {
  ModelWalk walk(parse_walker_models(model, "test", generator).front());
  std::vector<std::string> names;
  while (static_cast<int>(names.size()) < most && walk.has_next()) {
    const auto [edge, number] = walk.next();
    names.push_back(edge ? walk.model().edges[number].name : walk.model().vertices[number].name);
  }
  return names;
}

TEST(WalkGenerator, Parses) {
  const WalkGenerator generator =
      parse_walk_generator("quick_random( edge_coverage(80.5) && vertex_coverage(100) or reached_vertex(v_a))");
  ASSERT_EQ(generator.stop.any_of.size(), 2u);
  ASSERT_EQ(generator.stop.any_of[0].size(), 2u);
  EXPECT_EQ(generator.stop.any_of[0][0].value, 80.5);
  EXPECT_EQ(generator.stop.any_of[1][0].name, "v_a");
  for (const char* const bad :
       {"", "random", "random(", "random()", "a_star(reached_vertex(v))", "random(edge_coverage(101))",
        "random(edge_coverage(x))", "random(requirement_coverage(100))", "random(length(-1))", "random(reached_edge())",
        "random(length(1)) random(length(2))", "random(length(1) xor length(2))"}) {
    EXPECT_NE(error_of([&] { parse_walk_generator(bad); }), "") << bad;
  }
  EXPECT_THAT(error_of([] { parse_walk_generator("a_star(never)"); }), HasSubstr("a_star"));
}

TEST(WalkerModels, RefuseWhatIsNotRun) {
  const auto error_with = [](const std::string& from, const std::string& to) {
    std::string text = kLogin;
    text.replace(text.find(from), from.size(), to);
    return error_of([&] { parse_walker_models(text, "test"); });
  };
  EXPECT_THAT(error_with(R"("name":"e_in",)", R"("name":"e_in","guard":"x > 1",)"), HasSubstr("\"e_in\" has guard"));
  EXPECT_THAT(error_with(R"("name":"e_in",)", R"("name":"e_in","actions":["x=1"],)"), HasSubstr("actions"));
  EXPECT_THAT(error_with(R"("name":"v_home",)", R"("name":"v_home","sharedState":"HOME",)"), HasSubstr("v_home"));
  EXPECT_EQ(error_with(R"("name":"e_in",)", R"("name":"e_in","guard":"","actions":[],)"), "");
  EXPECT_THAT(error_with(R"("startElementId":"e0")", R"("startElementId":"e9")"), HasSubstr("startElementId"));
  EXPECT_THAT(error_with(R"("targetVertexId":"v2")", R"("targetVertexId":"v7")"), HasSubstr("no vertex"));
  EXPECT_THAT(error_with(R"("id":"v1")", R"("id":"v0")"), HasSubstr("same id"));
  EXPECT_THAT(error_of([] { parse_walker_models("[]", "test"); }), HasSubstr("models"));
}

TEST(ModelWalk, CoversAllEdgesByTheShortestWalk) {
  const auto names = walk("");
  EXPECT_THAT(names, ElementsAre("e_open", "v_start", "e_in", "v_home", "e_again", "v_home", "e_out", "v_start",
                                 "e_bad", "v_error", "e_back", "v_start"))
      << "each edge once";
}

TEST(ModelWalk, StopsAsAsked) {
  EXPECT_THAT(walk("random(vertex_coverage(100))").size(), 8u);
  EXPECT_THAT(walk("random(reached_vertex(v_error))"), ElementsAre("e_open", "v_start", "e_bad", "v_error"));
  EXPECT_THAT(walk("random(reached_edge(e_again))").back(), "v_home");
  EXPECT_EQ(walk("random(length(20))").size(), 40u);
  EXPECT_EQ(walk("random(never)", kLogin, 500).size(), 500u);
  EXPECT_EQ(walk("random(time_duration(0))").size(), 2u);
  EXPECT_EQ(walk("random(edge_coverage(50))").size(), 6u) << "three of six edges";
}

TEST(ModelWalk, GoesAsFarAsItCan) {
  constexpr const char* kTrap =
      R"json({"models":[{"name":"m","generator":"random(edge_coverage(100))","startElementId":"a",
    "vertices":[{"id":"a","name":"a"},{"id":"b","name":"b"},{"id":"c","name":"c"}],
    "edges":[{"id":"1","name":"ab","sourceVertexId":"a","targetVertexId":"b"},
             {"id":"2","name":"ac","sourceVertexId":"a","targetVertexId":"c"}]}]
})json";
  EXPECT_THAT(walk("", kTrap), ElementsAre("a", "ab", "b"));
  EXPECT_THAT(walk("random(length(9))", kTrap), ElementsAre("a", "ab", "b"));
}

TEST(ModelWalk, EndsThoughAnEdgeFromNowhereIsNotWalked) {
  constexpr const char* kEntries = R"json({"models":[{"name":"m","generator":"random(edge_coverage(100))",
    "startElementId":"a","vertices":[{"id":"a","name":"a"},{"id":"b","name":"b"}],
    "edges":[{"id":"1","name":"ab","sourceVertexId":"a","targetVertexId":"b"},
             {"id":"2","name":"ba","sourceVertexId":"b","targetVertexId":"a"},
             {"id":"3","name":"in","targetVertexId":"a"}]}]})json";
  EXPECT_THAT(walk("", kEntries), ElementsAre("a", "ab", "b", "ba", "a"));
  EXPECT_EQ(walk("random(length(7))", kEntries).size(), 15u);
}

TEST(GraphWalkerService, SpeaksAsItsClientsExpect) {
  HttpServer server(0);
  const GraphWalkerService service(server, {});
  const auto ask = [&](const std::string& method, const std::string& path, const std::string& body = "") {
    const HttpAnswer answer = server.ask({.method = method, .path = "/graphwalker/" + path, .query = "", .body = body});
    EXPECT_EQ(answer.status, 200);
    return nlohmann::json::parse(*answer.body);
  };
  for (const char* const path : {"hasNext", "getNext", "getData", "getStatistics"}) {
    EXPECT_EQ(ask("GET", path)["result"], "nok") << path;
  }
  EXPECT_EQ(ask("PUT", "restart")["result"], "nok");
  EXPECT_EQ(ask("POST", "load", "nonsense")["result"], "nok");
  const auto loaded = ask("POST", "load", kLogin);
  EXPECT_EQ(loaded["result"], "ok");
  EXPECT_THAT(loaded["note"].get<std::string>(), HasSubstr("planned"));
  EXPECT_EQ(ask("PUT", "setData/user%20name=%22a%3Db%22")["result"], "ok");
  EXPECT_EQ(ask("GET", "getData")["data"]["user name"], "a=b");
  EXPECT_EQ(ask("PUT", "setData/%ff=1")["result"], "nok");
  EXPECT_EQ(ask("PUT", "setData/path=a/b")["result"], "ok");
  EXPECT_EQ(ask("GET", "getData")["data"]["path"], "a/b");
  int steps = 0;
  for (; ask("GET", "hasNext")["hasNext"] == "true"; ++steps) {
    const auto step = ask("GET", "getNext");
    EXPECT_EQ(step["modelName"], "Login");
    EXPECT_EQ(step["properties"].contains("x"), step["currentElementName"] == "v_home");
  }
  EXPECT_EQ(steps, 12);
  EXPECT_EQ(ask("GET", "getNext")["result"], "nok");
  const auto statistics = ask("GET", "getStatistics");
  EXPECT_EQ(statistics["totalCompletedNumberOfModels"], 1);
  EXPECT_EQ(statistics["edgeCoverage"], 100);
  EXPECT_EQ(statistics["totalNumberOfVisitedVertices"], 3);
  EXPECT_TRUE(statistics["edgesNotVisited"].empty());
  EXPECT_EQ(ask("PUT", "restart")["result"], "ok");
  EXPECT_EQ(ask("GET", "getNext")["currentElementID"], "e0");
  EXPECT_EQ(ask("PUT", "fail/it%20broke")["result"], "ok");
  EXPECT_EQ(ask("GET", "hasNext")["hasNext"], "false");
  EXPECT_EQ(ask("GET", "getStatistics")["totalFailedNumberOfModels"], 1);
}

}  // namespace
}  // namespace graphdrl
