#include "graphdrl/io/readers.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmock/gmock.h>

#include "graphdrl/env/load_worlds.h"
#include "graphdrl/io/file.h"
#include "support.h"

namespace graphdrl {
namespace {

using ::testing::AnyOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(NodeLink, ReadsNodesEdgesCostsAndObstacles) {
  const GraphMap map = parse_node_link(R"({"directed": true, "multigraph": false, "graph": {"name": "x"},
    "nodes": [{"id": "a", "colour": 3}, {"id": 7, "blocked": true}, {"id": "c", "blocked": false}],
    "links": [{"source": "a", "target": "7", "weight": 2.5}, {"source": 7, "target": "c", "cost": 4}]})",
                                       "test");
  EXPECT_THAT(map.labels, ElementsAre("a", "7", "c"));
  EXPECT_THAT(map.blocked, ElementsAre(false, true, false));
  EXPECT_TRUE(map.graph.directed());
  EXPECT_THAT(map.graph.neighbours(0), ElementsAre(1));
  EXPECT_EQ(map.graph.cost(0, 0), 2.5);
  EXPECT_EQ(map.graph.cost(1, 0), 4);
}

TEST(NodeLink, PlainIdsAreNoLabelsAndEdgesMayBeCalledSo) {
  const GraphMap map =
      parse_node_link(R"({"nodes": [{"id": 0}, {"id": 1}], "edges": [{"source": 0, "target": 1}]})", "test");
  EXPECT_TRUE(map.labels.empty());
  EXPECT_FALSE(map.graph.directed());
  EXPECT_FALSE(map.graph.weighted());
  EXPECT_EQ(map.graph.edge_count(), 1);
}

TEST(NodeLink, WhatIsWrittenIsReadBack) {
  Rng rng(1);
  for (int i = 0; i < 100; ++i) {
    const auto nodes = static_cast<NodeId>(1 + rng.below(9));
    std::vector<Edge> edges;
    for (int k = 0; k < 12; ++k) {
      const auto end = [&] { return static_cast<NodeId>(rng.below(static_cast<std::uint32_t>(nodes))); };
      edges.push_back({end(), end(), rng.below(2) == 0 ? 1.0 : rng.uniform() + 0.1});
    }
    const EdgeKind kind = i % 2 == 0 ? EdgeKind::kDirected : EdgeKind::kUndirected;
    GraphMap map{.graph = Graph::from_edges(nodes, edges, kind), .blocked = std::vector<bool>(nodes), .labels = {}};
    map.blocked[nodes - 1] = nodes > 1;
    if (i % 3 == 0) {
      for (NodeId node = 0; node < nodes; ++node) map.labels.push_back("n\u00f6\"" + std::to_string(node));
    }
    const GraphMap read = parse_node_link(format_node_link(map), "test");
    EXPECT_EQ(read.labels, map.labels);
    EXPECT_EQ(read.blocked, map.blocked);
    EXPECT_TRUE(read.prizes.empty());
    EXPECT_EQ(read.graph.directed(), map.graph.directed());
    const auto same = [](const Edge& a, const Edge& b) { return a.a == b.a && a.b == b.b && a.cost == b.cost; };
    const auto before = map.graph.edges();
    const auto after = read.graph.edges();
    EXPECT_TRUE(std::equal(before.begin(), before.end(), after.begin(), after.end(), same));
  }
}

TEST(NodeLink, SaysWhatIsWrongAndWhere) {
  const auto error = [](const std::string& text) { return error_of([&] { parse_node_link(text, "file.json"); }); };
  EXPECT_THAT(error("{\n\"nodes\": [}"), HasSubstr("file.json:2: not JSON"));
  EXPECT_THAT(error("[]"), HasSubstr("not a graph in node-link form"));
  EXPECT_THAT(error("{}"), HasSubstr("no key \"nodes\""));
  EXPECT_THAT(error(R"({"nodes": {}})"), HasSubstr("nodes: bad value: expected an array"));
  EXPECT_THAT(error(R"({"nodes": [], "links": []})"), HasSubstr("no free node"));
  EXPECT_THAT(error(R"({"nodes": [{"id": 1, "blocked": true}], "links": []})"), HasSubstr("no free node"));
  EXPECT_THAT(error(R"({"nodes": [{"id": 1}]})"), HasSubstr("no key \"links\""));
  EXPECT_THAT(error(R"({"nodes": [3], "links": []})"), HasSubstr("nodes[0]: no key \"id\""));
  EXPECT_THAT(error(R"({"nodes": [{"id": 1.5}], "links": []})"), HasSubstr("bad \"id\""));
  EXPECT_THAT(error(R"({"nodes": [{"id": 1}, {"id": "1"}], "links": []})"), HasSubstr("nodes[1]: an id used twice"));
  EXPECT_THAT(error(R"({"nodes": [{"id": 1, "blocked": 0}], "links": []})"), HasSubstr("expected true or false, got"));
  EXPECT_THAT(error(R"({"directed": 1, "nodes": [{"id": 1}], "links": []})"), HasSubstr("directed: bad value"));
  const auto link = [&](const std::string& text) {
    return error(R"({"nodes": [{"id": 0}, {"id": 1}], "links": [)" + text + "]}");
  };
  EXPECT_THAT(link(R"({"source": 0})"), HasSubstr("links[0]: no key \"target\""));
  EXPECT_THAT(link(R"({"source": 0, "target": 2})"),
              HasSubstr("links[0]: no such node: expected the id of a node, got '2'"));
  for (const char* const cost : {"-1", "-1e-300", "\"2\"", "null", "true", "[]", "{}"}) {
    EXPECT_THAT(link(fmt::format(R"({{"source": 0, "target": 1, "weight": {}}})", cost)),
                HasSubstr(fmt::format("links[0]: bad weight: expected a number from 0 up, got '{}'", cost)));
  }
  EXPECT_THAT(link(R"({"source": 1, "target": 1}, {"source": [1, {"x": 2}], "target": 1})"),
              HasSubstr(R"(links[1]: bad "source": expected a text or a whole number, got '[1,{"x":2}]')"));
  EXPECT_THAT(link(R"({"source": 1, "target": 1}, {"target": 1, "width": [3]})"),
              HasSubstr(R"(links[1]: no key "source": expected an object with it, got '{"target":1,"width":[3]}')"));
  EXPECT_THAT(error(R"({"nodes": [{"id": 0}], "edges": [{"source": 0, "target": "door"}]})"),
              HasSubstr("file.json: edges[0]: no such node: expected the id of a node, got 'door'"));
  EXPECT_THAT(error(R"({"links": [{"source": 0, "target": 2}], "nodes": [{"id": 0}]})"),
              HasSubstr("links[0]: no such node"));
  EXPECT_THAT(error(R"({"nodes": [{"id": 0}, {"id": 7, "colour": 3}, {"id": 7, "colour": 4}], "links": []})"),
              HasSubstr("nodes[2]: an id used twice: expected ids all different, got '7'"));
  for (const char* const prize : {"-1", "\"2\"", "null", "[1]"}) {
    EXPECT_THAT(error(fmt::format(R"({{"nodes": [{{"id": 0}}, {{"id": 1, "prize": {}}}], "links": []}})", prize)),
                HasSubstr(fmt::format("nodes[1]: bad prize: expected a number from 0 up, got '{}'", prize)));
  }
  EXPECT_THAT(error(R"({"nodes": [], "nodes": []})"), HasSubstr("the key \"nodes\" stands twice"));
  EXPECT_THAT(link(R"({"source": 0, "target": 1, "weight": 1e999})"), HasSubstr("a number too large"));
}

TEST(NodeLink, FilesAreToldFromAsciiMapsByTheirFirstCharacter) {
  const TemporaryFolder folder;
  write_file(folder / "graph.json", "\n {\"nodes\": [{\"id\": \"dock\"}, {\"id\": \"shelf\"}], \"links\": []}");
  const World world = load_one_world((folder / "graph.json").string());
  EXPECT_FALSE(world.is_grid());
  EXPECT_EQ(parse_node(world, "shelf", "start"), 1);
  EXPECT_EQ(parse_node(world, "#0", "start"), 0);
  EXPECT_THAT(error_of([&] { parse_node(world, "0", "start"); }), HasSubstr("start outside the map"));
}

TEST(NodeLink, CostsMayBeZeroAndNodesHavePrizes) {
  const GraphMap map =
      parse_node_link(R"({"nodes": [{"id": 0}, {"id": 1, "prize": 2.5}, {"prize": 0, "id": 2}, {"id": 3}],
    "links": [{"source": 0, "target": 1, "weight": 0}, {"source": 1, "target": 2, "weight": -0.0, "cost": 9}]})",
                      "test");
  EXPECT_THAT(map.prizes, ElementsAre(1, 2.5, 0, 1));
  EXPECT_EQ(map.graph.max_cost(), 0);
  EXPECT_THAT(format_node_link(map), HasSubstr(R"([{"id":0},{"id":1,"prize":2.5},{"id":2,"prize":0.0},{"id":3}])"));
  EXPECT_EQ(parse_node_link(format_node_link(map), "test").prizes, map.prizes);
  EXPECT_TRUE(parse_node_link(R"({"nodes": [{"id": 0, "prize": 1}], "links": []})", "test").prizes.empty());
}

TEST(NodeLink, IdsMayBeTuplesOfPython) {
  const GraphMap map = parse_node_link(R"({"nodes": [{"id": [0, 0]}, {"id": [0, 1]}, {"id": ["a", [2.5]]}],
    "links": [{"source": [0, 1], "target": ["a", [2.5]]}]})",
                                       "test");
  EXPECT_THAT(map.labels, ElementsAre("(0, 0)", "(0, 1)", "('a', (2.5,))"));
  EXPECT_THAT(map.graph.neighbours(1), ElementsAre(2));
  EXPECT_EQ(parse_node_link(format_node_link(map), "test").labels, map.labels);
  EXPECT_THAT(error_of([] { parse_node_link(R"({"nodes": [{"id": [0, null]}], "links": []})", "f"); }),
              HasSubstr("nodes[0]: bad \"id\": expected a text or a whole number, got '[0,null]'"));
}

TEST(NodeLink, NamesNumbersThatJsonDoesNotHave) {
  for (const char* const number : {"NaN", "Infinity", "-Infinity"}) {
    const std::string text = fmt::format("{{\"nodes\": [{{\"id\": 0,\n\"height\": {}}}], \"links\": []}}", number);
    EXPECT_THAT(error_of([&] { parse_node_link(text, "f"); }),
                HasSubstr("f:2: not JSON: expected a number or null, got"))
        << number;
  }
}

TEST(NodeLink, BadAttributesOfNoUseAreSkipped) {
  const GraphMap map = parse_node_link(
      R"({"nodes": [{"id": 0, "label": 4, "x": "left", "score": "high", "prize": 2}, {"id": 1, "y": null}],
          "links": [{"source": 0, "target": 1, "length": "5 m", "weight": 3, "cost": null}]})",
      "test");
  EXPECT_THAT(map.prizes, ElementsAre(2, 1));
  EXPECT_EQ(map.graph.cost(0, 0), 3);
}

TEST(NodeLink, WrittenIdsAreAllDifferent) {
  const GraphMap map{.graph = Graph::from_edges(2, std::vector<Edge>{{0, 1}}),
                     .blocked = {false, false},
                     .labels = {"Caf\xE8", "Caf\xE9"}};
  EXPECT_EQ(parse_node_link(format_node_link(map), "test").graph.edge_count(), 1);
}

TEST(NodeLink, LinksComeBeforeEdgesOfThatName) {
  for (const char* const text :
       {R"({"nodes": [{"id": 0}, {"id": 1}], "edges": [{"source": 0, "target": 1}], "links": []})",
        R"({"links": [], "edges": [{"source": 0, "target": 1}], "nodes": [{"id": 0}, {"id": 1}]})"}) {
    EXPECT_EQ(parse_node_link(text, "test").graph.edge_count(), 0) << text;
  }
}

// The members of an object in a random order.
std::string shuffled(std::vector<std::string> members, Rng& rng) {
  std::string text;
  while (!members.empty()) {
    const auto chosen = members.begin() + rng.below(static_cast<std::uint32_t>(members.size()));
    text += fmt::format("{}{}", text.empty() ? "" : ", ", *chosen);
    members.erase(chosen);
  }
  return fmt::format("{{{}}}", text);
}

TEST(NodeLink, KeysStandInAnyOrder) {
  Rng rng(2);
  for (int i = 0; i < 200; ++i) {
    const bool plain = i % 2 == 0;
    const auto id = [&](NodeId node) { return fmt::format("{0}{1}{2}{0}", plain ? "" : "\"", plain ? "" : "n", node); };
    std::vector<std::string> nodes;
    std::vector<std::string> links;
    for (NodeId node = 0; node < 5; ++node) {
      std::vector<std::string> members = {fmt::format("\"id\": {}", id(node)), R"("pos": [1, {"id": [2]}, "}"])"};
      if (node == 2) members.push_back("\"blocked\": true");
      if (node == 3) members.push_back("\"prize\": 4");
      nodes.push_back(shuffled(std::move(members), rng));
      members = {fmt::format("\"source\": {}", id(node)), fmt::format("\"target\": {}", id((node + 1) % 5)),
                 fmt::format("\"cost\": {}", node)};
      links.push_back(shuffled(std::move(members), rng));
    }
    const std::string text = shuffled({"\"directed\": true", fmt::format("\"nodes\": [{}]", fmt::join(nodes, ", ")),
                                       fmt::format("\"links\": [{}]", fmt::join(links, ", ")),
                                       R"("graph": {"nodes": [3], "links": {"directed": 7}})"},
                                      rng);
    const GraphMap map = parse_node_link(text, "test");
    EXPECT_EQ(map.labels.empty(), plain);
    EXPECT_THAT(map.blocked, ElementsAre(false, false, true, false, false));
    EXPECT_THAT(map.prizes, ElementsAre(1, 1, 1, 4, 1));
    ASSERT_TRUE(map.graph.directed());
    ASSERT_EQ(map.graph.edge_count(), 5) << text;
    for (NodeId node = 0; node < 5; ++node) {
      EXPECT_THAT(map.graph.neighbours(node), ElementsAre((node + 1) % 5));
      EXPECT_EQ(map.graph.cost(node, 0), node);
    }
  }
}

TEST(NodeLink, SurvivesDeepNestingAnywhere) {
  const std::string deep = std::string(1'000'000, '[') + std::string(1'000'000, ']');
  for (const std::string form :
       {R"({"nodes":[DEEP],"links":[]})", R"({"nodes":[{"id":DEEP}],"links":[]})", R"({"directed":DEEP})",
        R"({"nodes":[{"id":0}],"links":[{"source":DEEP}]})", R"({"graph":DEEP,"nodes":[{"id":0}],"links":[]})",
        R"({"nodes":[7],"links":[DEEP]})", "DEEP"}) {
    std::string text = form;
    text.replace(text.find("DEEP"), 4, deep);
    EXPECT_THAT(error_of([&] { parse_node_link(text, "f"); }),
                AnyOf(HasSubstr("nested too deeply"), HasSubstr("an object")))
        << form;
  }
}

TEST(NodeLink, DamageIsAnErrorOrAnotherMap) {
  const std::string whole = R"({"directed":true,"nodes":[{"id":"a","prize":2.0},{"id":1,"blocked":true},{"id":2}],)"
                            R"("links":[{"source":"a","target":1,"weight":1.5},{"source":2,"target":"a"}],"x":[{}]})";
  EXPECT_EQ(error_of([&] { parse_node_link(whole, "f"); }), "");
  for (std::size_t size = 0; size < whole.size(); ++size) {
    EXPECT_NE(error_of([&] { parse_node_link(whole.substr(0, size), "f"); }), "");
  }
  Rng rng(3);
  const std::string alphabet = "[]{}\",:0129.-eatrul\\ \xff";
  for (int i = 0; i < 30'000; ++i) {
    std::string damaged = whole;
    for (std::uint32_t n = 1 + rng.below(4); n > 0; --n) {
      const auto place = rng.below(static_cast<std::uint32_t>(damaged.size()));
      const char c = alphabet[rng.below(static_cast<std::uint32_t>(alphabet.size()))];
      if (rng.below(2) == 0) {
        damaged[place] = c;
      } else {
        damaged.insert(place, 1, c);
      }
    }
    const std::string error = error_of([&] { parse_node_link(damaged, "f"); });
    EXPECT_EQ(error.find('\n'), std::string::npos);
  }
}

}  // namespace
}  // namespace graphdrl
