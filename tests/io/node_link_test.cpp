#include "graphdrl/io/node_link.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "graphdrl/env/load_worlds.h"
#include "graphdrl/io/file.h"
#include "support.h"

namespace graphdrl {
namespace {

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
  EXPECT_THAT(link(R"({"source": 0, "target": 2})"), HasSubstr("\"target\" is no node"));
  for (const char* const cost : {"0", "-1", "\"2\"", "null", "true"}) {
    EXPECT_THAT(link(fmt::format(R"({{"source": 0, "target": 1, "weight": {}}})", cost)),
                HasSubstr("bad \"weight\": expected a positive number"));
  }
  EXPECT_THAT(link(R"({"source": 0, "target": 1, "weight": 1e999})"), HasSubstr("a number too large"));
}

TEST(NodeLink, FilesAreToldFromAsciiMapsByTheirFirstCharacter) {
  const TemporaryFolder folder;
  write_file(folder / "graph.json", "\n {\"nodes\": [{\"id\": \"dock\"}, {\"id\": \"shelf\"}], \"links\": []}");
  const World world = load_one_world((folder / "graph.json").string());
  EXPECT_FALSE(world.is_grid());
  EXPECT_EQ(parse_start(world, "shelf"), 1);
  EXPECT_EQ(parse_start(world, "0"), 0);
  EXPECT_THAT(error_of([&] { parse_start(world, "door"); }), HasSubstr("start outside the map"));
}

}  // namespace
}  // namespace graphdrl
