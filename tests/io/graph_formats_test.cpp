// What programs write into the graph formats beyond plain nodes and edges.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <pugixml.hpp>

#include "graphdrl/io/map_formats.h"
#include "graphdrl/io/xml.h"
#include "support.h"

namespace graphdrl {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

struct NotedGraph {
  GraphMap map;
  std::vector<std::string> notes;
};
NotedGraph noted_graph(const std::string& text, MapOptions options = {}) {
  NotedGraph result;
  options.note = [&](const std::string& note) { result.notes.push_back(note); };
  result.map = std::get<GraphMap>(format_of(text).read(text, "file", options));
  return result;
}
GraphMap graph_of(const std::string& text) {
  return noted_graph(text).map;
}
std::string graph_complaint(const std::string& text) {
  return error_of([&] { graph_of(text); });
}

TEST(Dot, KnowsListsOfNodes) {
  const GraphMap map = graph_of("digraph { a, b:port -> c, d -> a; c, d [prize=5]; e, f }");
  EXPECT_THAT(map.labels, ElementsAre("a", "b", "c", "d", "e", "f"));
  EXPECT_EQ(map.graph.edge_count(), 6);
  EXPECT_THAT(map.graph.neighbours(1), ElementsAre(2, 3));
  EXPECT_THAT(map.prizes, ElementsAre(1, 1, 5, 5, 1, 1));
  EXPECT_THAT(graph_complaint("graph { a, [prize=5] }"), HasSubstr("not a node after a comma"));
}

TEST(Dot, ASubgraphNamedAgainIsTheOneBefore) {
  const GraphMap map = graph_of(
      "digraph { subgraph A { node [prize=2]; a; subgraph B { b } } subgraph A { c; subgraph B { e } -> f } -> d;"
      " subgraph B { g } -> d; { h } -> d }");
  EXPECT_THAT(map.labels, ElementsAre("a", "b", "c", "e", "f", "d", "g", "h"));
  EXPECT_THAT(map.prizes, ElementsAre(2, 2, 2, 2, 2, 1, 1, 1));
  EXPECT_THAT(map.graph.neighbours(1), ElementsAre(4, 5));  // b -> f, d
  EXPECT_THAT(map.graph.neighbours(6), ElementsAre(5));
  EXPECT_EQ(map.graph.edge_count(), 2 + 5 + 1 + 1);
  std::string again = "graph { subgraph A { a";
  for (int i = 0; i < 1000; ++i) again += fmt::format(" {}", i);
  for (int i = 0; i < 1000; ++i) again += "} subgraph A {";
  EXPECT_THAT(graph_complaint(again + "} }"), HasSubstr("far more edges"));
}

TEST(Dot, LabelsHaveEscapes) {
  const GraphMap map = graph_of(R"(graph { a [label="\\N"]; b [label="at \N"]; "c\\d" [label="c"]; a -- b })");
  EXPECT_THAT(map.labels, ElementsAre("\\N", "at b", "c"));
  EXPECT_THAT(graph_of(R"(graph { a -- "c\\d" [label="\\N"] })").labels, ElementsAre("a", "c\\d"));
  EXPECT_THAT(graph_of(R"(graph { a [label=<\\N>]; b [label="\N"] })").labels, ElementsAre("a", "b"));
}

TEST(Dot, TheStartOfAModelIsNoState) {
  for (const char* const label : {"[label=\"\", shape=none]", ""}) {
    const NotedGraph model = noted_graph(fmt::format(
        "digraph g {{ __start0 {}; s0 [label=\"off\"]; s1 [label=\"on\"]; __start0 -> s1; s0 -> s1; s1 -> s0 }}",
        label));
    EXPECT_THAT(model.map.labels, ElementsAre("off", "on"));
    EXPECT_EQ(model.map.task.start, 1);
    EXPECT_EQ(model.map.graph.edge_count(), 2);
    EXPECT_THAT(model.notes, ElementsAre(HasSubstr("`__start` points at 's1', the start, and is left out")));
  }
  const GraphMap last = graph_of("digraph { 6; 0; __start0 [label=\"\"]; __start0 -> 6; 6 -> 0 }");
  EXPECT_THAT(last.labels, ElementsAre("6", "0"));
  EXPECT_EQ(last.task.start, 0);
  // Nodes of that name that are states.
  EXPECT_EQ(graph_of("digraph { __start [label=here]; __start -> b }").task.start, kNoNode);
  EXPECT_EQ(graph_of("digraph { __start -> b -> __start }").graph.node_count(), 2);
  EXPECT_EQ(graph_of("graph { __start -- b }").graph.node_count(), 2);
  const NotedGraph two = noted_graph("digraph { __start0 -> a; __start1 -> b; a -> b }");
  EXPECT_EQ(two.map.task.start, 0);
  EXPECT_THAT(two.notes, ElementsAre(HasSubstr("2 starts, of which 'a' is taken")));
}

constexpr const char* kYed = R"(<graphml xmlns:y="http://www.yworks.com/xml/graphml">
  <key for="node" id="d6" yfiles.type="nodegraphics"/>
  <graph edgedefault="directed" id="G">
    <node id="n0"><data key="d6"><y:GenericNode><y:Geometry height="30" width="50" x="10" y="-2.5"/>
      <y:NodeLabel>Start
        <y:LabelModel/></y:NodeLabel></y:GenericNode></data></node>
    <node id="n1" yfiles.foldertype="group"><data key="d6"><y:ProxyAutoBoundsNode><y:Realizers><y:GroupNode>
      <y:Geometry x="0" y="0"/><y:NodeLabel>Frame</y:NodeLabel></y:GroupNode></y:Realizers>
      </y:ProxyAutoBoundsNode></data>
      <graph edgedefault="directed" id="n1:">
        <node id="n1::n0"><data key="d6"><y:ShapeNode><y:Geometry x="1" y="2"/><y:NodeLabel>A</y:NodeLabel>
          </y:ShapeNode></data></node>
        <node id="n1::n1"><data key="d6"><y:ShapeNode><y:Geometry x="3" y="4"/><y:NodeLabel>B</y:NodeLabel>
          </y:ShapeNode></data></node>
        <edge source="n1::n0" target="n1::n1"/>
      </graph></node>
    <edge source="n0" target="n1::n0"/>
  </graph>
</graphml>)";

TEST(GraphMl, TakesTextsPlacesAndGroupsOfYed) {
  const NotedGraph drawing = noted_graph(kYed);
  EXPECT_THAT(drawing.map.labels, ElementsAre("Start", "A", "B"));
  EXPECT_THAT(drawing.map.places.points, ElementsAre(Point{10, -2.5}, Point{1, 2}, Point{3, 4}));
  EXPECT_EQ(drawing.map.graph.edge_count(), 2);
  EXPECT_THAT(drawing.map.graph.neighbours(1), ElementsAre(2));
  EXPECT_THAT(drawing.notes, ElementsAre(HasSubstr("groups without edges of their own are left out: 1")));
}

TEST(GraphMl, AGroupWithAnEdgeIsANode) {
  const NotedGraph map = noted_graph(
      "<graphml><graph edgedefault='directed'><node id='a'/><node id='g'><graph edgedefault='undirected'><node id='b'/>"
      "<node id='c'/><edge source='b' target='c'/></graph></node><edge source='a' target='g'/></graph></graphml>");
  EXPECT_THAT(map.map.labels, ElementsAre("a", "g", "b", "c"));
  EXPECT_EQ(map.map.graph.edge_count(), 3);
  EXPECT_THAT(map.notes, IsEmpty());
}

TEST(GraphMl, IsValidXmlWhateverLabelsHold) {
  const std::vector<std::string> labels = {
      "a\x01"
      "b",
      std::string("nul\0l", 5),
      "\xFF",
      "\xEF\xBF\xBE!",
      "a\tb",
      "a\nb",
      "a\rb",
      "a b",
      "\x1B[31m <&>\"'"};
  const auto count = static_cast<NodeId>(labels.size());
  GraphMap map{.graph = Graph::from_edges(count, std::vector<Edge>{{0, 1}}),
               .blocked = std::vector<bool>(count),
               .labels = labels};
  const std::string text = format_map(map, "x.graphml");
  for (std::uint32_t code = 0; code < 32; ++code) {
    if (code == '\t' || code == '\n' || code == '\r') continue;
    EXPECT_THAT(text, Not(HasSubstr(fmt::format("&#{};", code)))) << code;
  }
  const GraphMap again = graph_of(text);
  EXPECT_THAT(again.labels, ElementsAre("a␁b", "nul␀l", "�", "�!", "a\tb", "a\nb", "a\rb", "a b", "␛[31m <&>\"'"));
  map.labels = {"\xFE", "\xFF"};
  map.graph = Graph::from_edges(2, std::vector<Edge>{{0, 1}});
  map.blocked.resize(2);
  EXPECT_EQ(graph_of(format_map(map, "x.graphml")).graph.node_count(), 2);
}

TEST(Gexf, IsRead) {
  const GraphMap map = graph_of(R"(<?xml version="1.0" encoding="UTF-8"?>
<gexf xmlns="http://gexf.net/1.3" xmlns:viz="http://gexf.net/1.3/viz" version="1.3">
  <graph defaultedgetype="undirected">
    <attributes class="node"><attribute id="0" title="prize" type="float"><default>2</default></attribute></attributes>
    <attributes class="edge"><attribute id="0" title="blocked" type="string"/></attributes>
    <nodes>
      <node id="0" label="dock"><attvalues><attvalue for="0" value="7"/></attvalues>
        <viz:position x="1" y="-2" z="0"/></node>
      <node id="1" label="hall"><viz:position x="3" y="4"/><nodes><node id="2" label="desk">
        <viz:position x="5" y="6"/></node></nodes></node>
    </nodes>
    <edges><edge id="0" source="0" target="1" weight="2.5"/><edge source="1" target="2"/></edges>
  </graph>
</gexf>)");
  EXPECT_THAT(map.labels, ElementsAre("dock", "hall", "desk"));
  EXPECT_THAT(map.prizes, ElementsAre(7, 2, 2));
  EXPECT_THAT(map.places.points, ElementsAre(Point{1, -2}, Point{3, 4}, Point{5, 6}));
  EXPECT_FALSE(map.graph.directed());
  EXPECT_EQ(map.graph.cost(0, 0), 2.5);
  EXPECT_EQ(map.graph.cost(1, 1), 1);
}

TEST(Gexf, KnowsDirections) {
  const GraphMap map = graph_of(
      "<gexf><graph defaultedgetype='directed'><nodes><node id='a'/><node id='b'/><node id='c'/></nodes><edges>"
      "<edge source='a' target='b'/><edge source='b' target='c' type='mutual'/></edges></graph></gexf>");
  EXPECT_TRUE(map.graph.directed());
  EXPECT_EQ(map.graph.edge_count(), 3);
}

TEST(Gexf, RefusesWhatIsNoGraph) {
  EXPECT_THAT(graph_complaint("<gexf>"), HasSubstr("not well formed"));
  EXPECT_THAT(graph_complaint("<gexf/>"), HasSubstr("no graph"));
  EXPECT_THAT(graph_complaint("<gexf><graph/></gexf>"), HasSubstr("no free node"));
  EXPECT_THAT(graph_complaint("<gexf><graph><nodes>\n<node/></nodes></graph></gexf>"),
              HasSubstr("file:2: a node without an id"));
  const std::string begin = "<gexf><graph><nodes><node id='a'/></nodes><edges>\n<edge source='a' target=";
  EXPECT_THAT(graph_complaint(begin + "'b'/></edges></graph></gexf>"), HasSubstr("file:2: no such node"));
  EXPECT_THAT(graph_complaint(begin + "'a' weight='-1'/></edges></graph></gexf>"), HasSubstr("file:2: bad weight"));
}

TEST(Gml, KnowsNamedCharacters) {
  const GraphMap map = graph_of(
      "graph [ node [ id 1 label \"Caf&eacute; &amp; M&uuml;nchen &#8364;&#x20ac;\" ] node [ id 2 label \"&alpha; "
      "&nix; &\" ]"
      " ]");
  EXPECT_THAT(map.labels, ElementsAre("Café & München €€", "α &nix; &"));
}

constexpr const char* kWalkerModel = R"({"name": "login", "models": [{"name": "m", "generator": "quick_random",
  START"vertices": [{"id": "v0", "name": "v_Start", "properties": {"x": 1, "y": 2, "blocked": true}},
                    {"id": "v1", "name": "v_Page", "properties": {"x": 3, "y": 4}}],
  "edges": [{"id": "e0", "name": "e_Init", "targetVertexId": "v1"},
            {"id": "e1", "sourceVertexId": "v0", "targetVertexId": "v1", "weight": 0.3},
            {"id": "e2", "sourceVertexId": "v1", "targetVertexId": "v0", "weight": 0.7}]}]})";

std::string walker_model(const std::string& start) {
  std::string text = kWalkerModel;
  text.replace(text.find("START"), 5, start);
  return text;
}

TEST(GraphWalker, ModelsAreDirectedGraphsWithAStart) {
  const GraphMap map = graph_of(walker_model(""));
  EXPECT_TRUE(map.graph.directed());
  EXPECT_THAT(map.labels, ElementsAre("v_Start", "v_Page"));
  EXPECT_EQ(map.graph.edge_count(), 2);
  EXPECT_FALSE(map.graph.weighted());  // weights are probabilities
  EXPECT_THAT(map.places.points, ElementsAre(Point{1, 2}, Point{3, 4}));
  EXPECT_EQ(map.task.start, 1);
  EXPECT_EQ(graph_of(walker_model(R"("startElementId": "v0",)")).task.start, 0);
  EXPECT_EQ(graph_of(walker_model(R"("startElementId": "e0",)")).task.start, 1);
  EXPECT_EQ(graph_of(walker_model(R"("startElementId": "e2",)")).task.start, 0);
  EXPECT_EQ(noted_graph(walker_model(""), {.cost_attribute = "weight"}).map.graph.cost(0, 0), 0.3);
  EXPECT_THAT(noted_graph(walker_model("")).notes, ElementsAre(HasSubstr("so its only edge from nowhere does")));
  EXPECT_THAT(noted_graph(walker_model(R"("startElementId": "v0",)")).notes, IsEmpty());
  const NotedGraph two = noted_graph(
      R"({"models": [{"vertices": [{"id": "a"}], "edges": [{"targetVertexId": "a"}, {"targetVertexId": "a"}]}]})");
  EXPECT_EQ(two.map.task.start, kNoNode);
  EXPECT_THAT(two.notes, ElementsAre(HasSubstr("none of its 2 edges from nowhere is taken")));
}

TEST(GraphWalker, RefusesWhatIsNoModel) {
  EXPECT_THAT(graph_complaint(R"({"models": [], "x": {"vertices": 1}})"), HasSubstr("expected one model, got '0'"));
  EXPECT_THAT(graph_complaint(R"({"models": [{"vertices": 1}]})"), HasSubstr("no list \"vertices\""));
  EXPECT_THAT(graph_complaint(R"({"models": [{"vertices": [{}], "edges": []}]})"), HasSubstr("vertices[0]: no \"id\""));
  EXPECT_THAT(graph_complaint(R"({"models": [{"vertices": [{"id": "a"}], "edges": [{"targetVertexId": "b"}]}]})"),
              HasSubstr("edges[0]: no such node"));
  EXPECT_THAT(graph_complaint(walker_model(R"("startElementId": "v7",)")), HasSubstr("models[0]: no such node"));
}

// Few bytes may say many attributes of many nodes.
TEST(GraphFormats, LimitDefaultsByTheSizeOfTheFile) {
  constexpr int kDefaults = 2000;
  constexpr int kNodes = 4000;
  std::string xml = "<graphml>";
  std::string gexf = "<gexf><graph><attributes>";
  std::string dot = "graph { node [";
  for (int i = 0; i < kDefaults; ++i) {
    xml += fmt::format("<key id='{}'><default/></key>", i);
    gexf += fmt::format("<attribute id='{}'><default/></attribute>", i);
    dot += fmt::format("a{} ", i);
  }
  xml += "<graph>";
  gexf += "</attributes><nodes>";
  dot += "]";
  for (int i = 0; i < kNodes; ++i) {
    xml += fmt::format("<node id='{}'/>", i);
    gexf += fmt::format("<node id='{}'/>", i);
    dot += fmt::format(" {}", i);
  }
  EXPECT_THAT(graph_complaint(xml + "</graph></graphml>"), HasSubstr("far more edges or attributes than a file"));
  EXPECT_THAT(graph_complaint(gexf + "</nodes></graph></gexf>"), HasSubstr("far more edges or attributes than a file"));
  EXPECT_THAT(graph_complaint(dot + "}"), HasSubstr("far more edges or attributes than a file"));
  // A default in place of the one before.
  std::string states = "digraph {";
  for (int i = 0; i < kNodes; ++i) states += fmt::format(" node [shape=circle]; {}", i);
  EXPECT_EQ(graph_of(states + "}").graph.node_count(), kNodes);
}

// The same graph in every format that has attributes: node a, node b, with what is given, and an edge.
std::vector<std::string> in_every_format(const std::string& node, const std::string& edge, const std::string& value) {
  return {
      fmt::format(R"({{"nodes": [{{"id": "a", "{0}": {2}}}, {{"id": "b"}}],)"
                  R"("links": [{{"source": "a", "target": "b", "{1}": {2}}}]}})",
                  node, edge, value),
      fmt::format("<graphml><key id='n' for='node' attr.name='{0}'/><key id='e' for='edge' attr.name='{1}'/><graph>"
                  "<node id='a'><data key='n'>{2}</data></node><node id='b'/><edge source='a' target='b'>"
                  "<data key='e'>{2}</data></edge></graph></graphml>",
                  node, edge, value),
      fmt::format("graph {{ a [{0}=\"{2}\"]; b; a -- b [{1}=\"{2}\"] }}", node, edge, value),
      fmt::format("graph [ node [ id 1 {0} {2} ] node [ id 2 ] edge [ source 1 target 2 {1} {2} ] ]", node, edge,
                  value),
      fmt::format(
          "<gexf><graph><attributes class='node'><attribute id='0' title='{0}'/></attributes>"
          "<attributes class='edge'><attribute id='0' title='{1}'/></attributes><nodes><node id='a'><attvalues>"
          "<attvalue for='0' value='{2}'/></attvalues></node><node id='b'/></nodes><edges><edge source='a' target='b'>"
          "<attvalues><attvalue for='0' value='{2}'/></attvalues></edge></edges></graph></gexf>",
          node, edge, value)};
}

TEST(GraphFormats, TakeAttributesByNameOrNot) {
  for (const std::string& text : in_every_format("score", "length", "3")) {
    EXPECT_EQ(graph_of(text).prizes, (std::vector<double>{3, 1})) << text;
    EXPECT_EQ(graph_of(text).graph.max_cost(), 3) << text;
  }
  for (const std::string& text : in_every_format("Gold", "Time", "3")) {
    const GraphMap map = noted_graph(text, {.cost_attribute = "time", .prize_attribute = "gold"}).map;
    EXPECT_EQ(map.prizes, (std::vector<double>{3, 1})) << text;
    EXPECT_EQ(map.graph.max_cost(), 3) << text;
    EXPECT_THAT(error_of([&] { noted_graph(text, {.prize_attribute = "silver"}); }),
                HasSubstr("no node has this attribute"))
        << text;
  }
  for (const std::string& text : in_every_format("score", "weight", "-3")) {
    EXPECT_THAT(graph_complaint(text), HasSubstr("expected a number from 0 up, got '-3'")) << text;
    const GraphMap map = noted_graph(text, {.cost_attribute = "none", .prize_attribute = "none"}).map;
    EXPECT_THAT(map.prizes, IsEmpty()) << text;
    EXPECT_FALSE(map.graph.weighted()) << text;
  }
}

TEST(GraphFormats, NeverMixKindsOfCoordinates) {
  const GraphMap map = graph_of(
      "graph { node [lon=-122, lat=42]; a [x=1, y=2]; b [x=3, y=4, LAT=43]; c [x=5, y=6, lon=7, lat=8]; a -- b -- c }");
  EXPECT_THAT(map.places.points, ElementsAre(Point{1, 2}, Point{3, 4}, Point{5, 6}));
  EXPECT_EQ(map.places.unit, "");
  const GraphMap degrees = graph_of("graph { node [longitude=-122, latitude=42]; a [x=1]; b [x=3, y=4]; a -- b }");
  EXPECT_THAT(degrees.places.points, ElementsAre(Point{-122, 42}, Point{-122, 42}));
  EXPECT_EQ(degrees.places.unit, "degrees");
}

TEST(GraphFormats, SayWhatWasGuessedOrLeftOut) {
  EXPECT_THAT(noted_graph("graph { a -- b [weight=5]; b -- c [length=7] }").notes,
              ElementsAre(HasSubstr("costs come from weight and length")));
  EXPECT_THAT(noted_graph("graph { a [label=x]; b [label=x]; a -- b }").notes,
              ElementsAre(HasSubstr("the 2 nodes have 1 different labels, so ids name them")));
  EXPECT_THAT(noted_graph(R"({"nodes": [{"id": "a", "x": 0, "y": 0}, {"id": "b"}], "links": []})").notes,
              ElementsAre(HasSubstr("only 1 of 2 nodes have coordinates")));
}

TEST(Pajek, LinesMayEndAsOnOldMachines) {
  const GraphMap map = graph_of("*Vertices 2\r1 \"a\"\r2 \"b\"\r*Edges\r1 2\r");
  EXPECT_THAT(map.labels, ElementsAre("a", "b"));
  EXPECT_EQ(map.graph.edge_count(), 1);
}

}  // namespace
}  // namespace graphdrl
