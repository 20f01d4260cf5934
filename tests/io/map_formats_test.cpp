#include "graphdrl/io/map_formats.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "graphdrl/io/readers.h"
#include "support.h"

namespace graphdrl {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

AnyMap read(const std::string& text) {
  return format_of(text).read(text, "file", {});
}

GraphMap read_graph(const std::string& text) {
  return std::get<GraphMap>(read(text));
}

GridMap read_grid(const std::string& text) {
  return std::get<GridMap>(read(text));
}

TEST(MapFormats, AreKnownByTheirContent) {
  const std::vector<std::pair<std::string, std::string>> texts = {
      {"ascii", "...\n.#.\n"},
      {"ascii", "##\n#.\n"},
      {"ascii", ""},
      {"moving-ai", "type octile\nheight 1\nwidth 1\nmap\n.\n"},
      {"node-link", "\n {\"nodes\": []}"},
      {"graph-walker", R"({"models": [{"vertices": []}]})"},
      {"graphml", "<?xml version='1.0'?>\n<!-- a -->\n<graphml/>"},
      {"gexf", "<?xml version='1.0'?>\n<gexf><graph/></gexf>"},
      {"tsplib", "NAME : a\nTYPE : OP\n"},
      {"dimacs", "c a comment\n\np edge 2 1\ne 1 2\n"},
      {"dimacs", "p sp 2 1\na 1 2 7\n"},
      {"edge-list", "# comment\n0 1\n"},
      {"edge-list", "a,b\n"},
      {"ascii", "a\x01 b\n"},
      {"edge-list", "\"a b\";c;1\n"},
      {"edge-list", "P5 10 3\n"},
      {"netpbm", "P5 10 3 255\n"},
      {"edge-list", "graph 1\n"},
      {"edge-list", "sep=;\na;b\n"},
      {"edge-list", "1 a\n2 b\n1 c\n#\n1 2\n"},
      {"edge-list", "0 1\n1 0\n"},
      {"edge-list", "0,1,1\n"},
      {"edge-list", "4 4\n2 4\n1 3\n2 4\n"},
      {"edge-list", "10,11\n11,10\n"},
      {"edge-list", "1 2 3 4 5 6 7 8 9\n2 3 1 1 1 1 1 1 1\n"},
      {"tgf", "1 a\n2\n#\n1 2\n"},
      {"tgf", "a\nb\n#\n"},
      {"ascii", ".\n#\n.\n"},
      {"chao", "n 2\nm 1\ntmax 3\n"},
      {"metis", "% a ring\n3 3\n2 3\n1 3\n1 2\n"},
      {"cell-table", "0,1\n0,0\n"},
      {"cell-table", "0011\n0000\n"},
      {"gml", "# by hand\nCreator \"a\"\ngraph\n[\n]\n"},
      {"dot", "/* x */ strict  digraph \"a\" {"},
      {"dot", "// x\ngraph{}"},
      {"pajek", "% x\n*vertices 3\n"},
      {"netpbm", "P2\n# x\n1 1 255 0"},
      {"png", "\x89PNG\r\n\x1a\n"},
      {"numpy", "\x93NUMPY\x01"},
      {"ros", "resolution: 0.05\nimage: a.pgm\n"},
  };
  for (const auto& [name, text] : texts) EXPECT_EQ(format_of(text).name, name) << text;
}

TEST(MovingAi, IsReadAndWritten) {
  const GridMap map = read_grid("type octile\r\nheight 2\r\nwidth 7\r\nmap\r\n.GS@OTW\r\n@@@@@@.\r\n\r\n");
  EXPECT_EQ(map.rows, 2);
  EXPECT_EQ(map.cols, 7);
  EXPECT_THAT(map.blocked, ElementsAre(false, false, false, true, true, true, true,  //
                                       true, true, true, true, true, true, false));
  const std::string text = format_moving_ai(map);
  EXPECT_EQ(text, "type octile\nheight 2\nwidth 7\nmap\n...@@@@\n@@@@@@.\n");
  EXPECT_EQ(read_grid(text).blocked, map.blocked);
}

// Of the League of Robot Runners: E and S are where robots load and unload.
TEST(MovingAi, TakesWarehouses) {
  EXPECT_THAT(read_grid("type octile\nheight 1\nwidth 4\nmap\nE@S.\n").blocked, ElementsAre(false, true, false, false));
}

TEST(MovingAi, RefusesWhatItsHeaderDoesNotSay) {
  const auto complaint = [](const std::string& text) { return error_of([&] { read(text); }); };
  EXPECT_THAT(complaint("type tile\n"), HasSubstr("file:1: a map of another type: expected octile, got 'tile'"));
  EXPECT_THAT(complaint("type octile\nheight 2\nheight 2\n"), HasSubstr("file:3: given twice"));
  EXPECT_THAT(complaint("type octile\nheight -2\n"), HasSubstr("bad height"));
  EXPECT_THAT(complaint("type octile\nheight 2\ndepth 2\n"), HasSubstr("strange line in the header"));
  EXPECT_THAT(complaint("type octile\nheight 2\n"), HasSubstr("the file ends within the header"));
  EXPECT_THAT(complaint("type octile\nheight 2\nmap\n"), HasSubstr("no width in the header"));
  EXPECT_THAT(complaint("type octile\nheight 2000000000\nwidth 2000000000\nmap\n"), HasSubstr("too many cells"));
  EXPECT_THAT(complaint("type octile\nheight 20000\nwidth 20000\nmap\n"), HasSubstr("expected 20000 rows, got 0"));
  const std::string header = "type octile\nheight 1\nwidth 2\nmap\n";
  EXPECT_THAT(complaint(header + "...\n"), HasSubstr("file:5: a row of another length: expected 2 cells"));
  EXPECT_THAT(complaint(header + ".x\n"), HasSubstr("file:5:2: strange character"));
  EXPECT_THAT(complaint(header + "..\n..\n"), HasSubstr("file:6: more rows"));
  EXPECT_THAT(complaint(header + "@@\n"), HasSubstr("no free cell"));
}

TEST(Dimacs, HoldsUndirectedGraphs) {
  for (const char* const problem : {"p edge 4 2", "p col 4 2", "p edge 4 4", "p edge 4 1"}) {
    const GraphMap map = read_graph(std::string("c named so\n") + problem + "\ne 1 3\ne 3 4\n");
    EXPECT_THAT(map.labels, ElementsAre("1", "2", "3", "4"));
    EXPECT_FALSE(map.graph.directed());
    EXPECT_FALSE(map.graph.weighted());
    EXPECT_EQ(map.graph.edge_count(), 2);
    EXPECT_THAT(map.graph.neighbours(2), ElementsAre(0, 3));
  }
}

TEST(Dimacs, HoldsDirectedGraphsWithCosts) {
  const GraphMap map = read_graph("p sp 3 2\na 1 2 2.5\na 3 1 0\n");
  EXPECT_TRUE(map.graph.directed());
  EXPECT_THAT(map.graph.neighbours(0), ElementsAre(1));
  EXPECT_EQ(map.graph.cost(0, 0), 2.5);
  EXPECT_TRUE(map.graph.neighbours(1).empty());
  EXPECT_EQ(map.graph.cost(2, 0), 0);
}

TEST(Dimacs, RefusesWhatItsProblemDoesNotSay) {
  const auto complaint = [](const std::string& text) { return error_of([&] { read(text); }); };
  EXPECT_THAT(complaint("c igraph\np max 3 2\n"), HasSubstr("file:2: bad problem: expected p edge, p col or p sp"));
  EXPECT_THAT(complaint("p edge 0 0\n"), HasSubstr("bad number: expected a number of nodes from 1 to"));
  EXPECT_THAT(complaint("p edge 2000000000 0\n"), HasSubstr("for a file of this size"));
  EXPECT_THAT(complaint("p edge 3 1\np edge 3 1\n"), HasSubstr("file:2: a second problem"));
  EXPECT_THAT(complaint("p edge 3 1\na 1 2 3\n"), HasSubstr("expected an edge `e U V`, got 'a 1 2 3'"));
  EXPECT_THAT(complaint("p edge 3 1\ne 1 4\n"), HasSubstr("expected nodes from 1 to 3"));
  EXPECT_THAT(complaint("p edge 3 1\ne 1 2 3 4 5 6\n"), HasSubstr("strange line"));
  EXPECT_THAT(complaint("p sp 3 1\na 1 2 -1\n"), HasSubstr("bad cost: expected a number from 0 up"));
  EXPECT_THAT(complaint("p sp 3 2\na 1 2 1\n"), HasSubstr("another number of edges than the file says"));
  EXPECT_THAT(complaint("p edge 3 7\ne 1 2\n"), HasSubstr("expected 7, got 1"));
}

TEST(EdgeList, TakesWhatOthersWrite) {
  // igraph and SNAP.
  const GraphMap plain = read_graph("# Nodes: 3 Edges: 2\n0\t1\n1\t2\n");
  EXPECT_TRUE(plain.labels.empty());
  EXPECT_EQ(plain.graph.node_count(), 3);
  EXPECT_EQ(plain.graph.edge_count(), 2);
  EXPECT_FALSE(plain.graph.directed());
  // networkx, with and without data.
  const GraphMap data = read_graph("a b {}\nb c {'colour': 'red, dark', 'weight': 2.5}\n");
  EXPECT_THAT(data.labels, ElementsAre("a", "b", "c"));
  EXPECT_EQ(data.graph.cost(1, 0), 1);
  EXPECT_EQ(data.graph.cost(1, 1), 2.5);
  // A spreadsheet.
  const GraphMap table = read_graph("Distance;To;From;note\n3;\"Saint \"\"M\"\"; north\";Ulm;x\n0.5;Ulm;Bonn;\n");
  EXPECT_THAT(table.labels, ElementsAre("Ulm", "Saint \"M\"; north", "Bonn"));
  EXPECT_EQ(table.graph.cost(0, 0), 3);
  EXPECT_EQ(table.graph.cost(2, 0), 0.5);
  // KONECT: a loop, an edge twice and the other way round.
  const GraphMap konect = read_graph("% sym weighted\n7 7 1\n7 8 5\n8 7 4\n");
  EXPECT_THAT(konect.labels, ElementsAre("7", "8"));
  EXPECT_EQ(konect.graph.edge_count(), 1);
  EXPECT_EQ(konect.graph.cost(0, 0), 4);
}

TEST(EdgeList, RefusesWhatIsNoEdge) {
  const auto complaint = [](const std::string& text) { return error_of([&] { read(text); }); };
  EXPECT_THAT(complaint("1 2\n3\n"), HasSubstr("file:2: not an edge"));
  EXPECT_THAT(complaint("1,2\n,3\n"), HasSubstr("file:2: not an edge"));
  EXPECT_THAT(complaint("1,2\n\"1,3\n"), HasSubstr("file:2: not an edge"));
  EXPECT_THAT(complaint("1,2\n\"1\"x,3\n"), HasSubstr("file:2: not an edge"));
  EXPECT_THAT(complaint("1 2 -4\n"), HasSubstr("file:1: bad cost: expected a number from 0 up, got '-4'"));
  EXPECT_THAT(complaint("1 2 nan\n"), HasSubstr("bad cost"));
  EXPECT_THAT(complaint("1 2 {'weight': 'x'}\n"), HasSubstr("bad cost"));
  EXPECT_THAT(complaint("1 2 {'weight': 1\n"), HasSubstr("bad cost"));
  EXPECT_THAT(complaint("from,to\n"), HasSubstr("no edges"));
}

// What the reader tells, of an edge list named "file".
std::string note_of(const std::string& text, MapOptions options = {}) {
  std::string note;
  options.note = [&](const std::string& line) { note = line; };
  format_of(text).read(text, "file", options);
  return note;
}

TEST(EdgeList, SaysThatItWasTakenForOneAndWhatWasGuessed) {
  EXPECT_EQ(note_of("a b\nb c\n"),
            "file: taken for an edge list: fields between spaces, no header, every cost 1, edges lead both ways "
            "(--directed: one way)");
  EXPECT_EQ(
      note_of("sep=;\nto;from;weight\na;b;2,5\n"),
      "file: taken for an edge list: fields between ';', the first line a header, column 'weight' is the cost with "
      "decimal commas, edges lead both ways (--directed: one way)");
  EXPECT_THAT(note_of("from,to,km,road\na,b,2,x\n"), HasSubstr("every cost 1 (columns besides: km, road)"));
  EXPECT_THAT(note_of("a\tb\t2\n", {.directed = true}),
              HasSubstr("between tabs, no header, the third field is the cost, edges lead one way"));
}

// Names that are no node below: above numbers, numbered themselves, or where nodes below occur again.
TEST(EdgeList, KnowsAHeaderByItsRows) {
  const auto nodes = [](const std::string& text) { return read_graph(text).graph.node_count(); };
  EXPECT_EQ(nodes("id_1,id_2\n0,1\n1,2\n2,0\n"), 3);
  EXPECT_EQ(nodes("# by hand\nKnoten Nachbar\n10 20\n20 30\n"), 3);
  EXPECT_EQ(nodes("hither;thither;km\na;b;2\nb;c;3\n"), 3);
  EXPECT_EQ(nodes("node1\tnode2\na\tb\nc\td\n"), 4);
  // Nodes.
  EXPECT_EQ(nodes("a1,a2\na2,a3\n"), 3) << "a2 occurs again";
  EXPECT_EQ(nodes("a,b\nc,d\n"), 4) << "nothing tells";
  EXPECT_EQ(nodes("a,b\n"), 2);
  EXPECT_EQ(nodes("0 1\n2 3\n3 4\n"), 5) << "numbers";
  EXPECT_EQ(nodes("a,b,5\nc,d,6\nd,e,7\n"), 5) << "a cost";
  // Columns in any order.
  const GraphMap map = read_graph("km,From Node,To Node,cost\n9,a,b,2\n9,b,c,3\n");
  EXPECT_THAT(map.labels, ElementsAre("a", "b", "c"));
  EXPECT_EQ(map.graph.cost(0, 0), 2);
  EXPECT_THAT(read_graph("nr,stop1,stop2\n7,a,b\n8,b,c\n").labels, ElementsAre("a", "b", "c"));
}

TEST(EdgeList, TakesItsDirectionFromColumnCommentOrOption) {
  const auto edges = [](const std::string& text, const MapOptions& options = {}) {
    const Graph graph = std::get<GraphMap>(format_of(text).read(text, "file", options)).graph;
    return std::pair(graph.directed(), graph.edge_count());
  };
  EXPECT_EQ(edges("Source,Target,Type,Weight\na,b,Directed,1\nb,c,Directed,1\n"), std::pair(true, std::int64_t{2}));
  EXPECT_EQ(edges("Source,Target,Type\na,b,Directed\nb,c,Undirected\n"), std::pair(true, std::int64_t{3}));
  EXPECT_EQ(edges("Source,Target,Type\na,b,Undirected\n"), std::pair(false, std::int64_t{1}));
  EXPECT_EQ(edges("Source,Target,Type\na,b,1\n").first, false) << "a type of another kind";
  EXPECT_EQ(edges("source;target;directed\na;b;true\n").first, true);
  EXPECT_EQ(edges("# Directed graph (each unordered pair of nodes is saved once)\n0\t1\n1\t2\n").first, true);
  EXPECT_EQ(edges("# Undirected graph: x\n0\t1\n").first, false);
  EXPECT_EQ(edges("# directed: false\n0\t1\n").first, false);
  EXPECT_EQ(edges("% asym unweighted\n1 2\n").first, true);
  EXPECT_EQ(edges("0 1\n# Directed edges come here\n1 2\n").first, false) << "below the first edge";
  EXPECT_EQ(edges("0 1\n1 2\n", {.directed = true}), std::pair(true, std::int64_t{2}));
}

TEST(EdgeList, TakesSpreadsheetsOfOtherCountries) {
  for (const char* const text : {"sep=;\nsource;target;weight\na;b;2,5\n", "\"sep=;\"\r\na;b;2,5\r\n", "a;b;2,5;;\n",
                                 "sep=|\na|b|2,5\n", "a\tb\t2,5\n", "source;target;weight\n\"a\";b;2.5\n"}) {
    EXPECT_EQ(read_graph(text).graph.cost(0, 0), 2.5) << text;
  }
  EXPECT_THAT(read_graph("\"a;b\",c\nc,d\n").labels, ElementsAre("a;b", "c", "d"));
  EXPECT_THAT(error_of([] { read("a;b;1.234,5\n"); }), HasSubstr("bad cost"));
}

// Nothing is an edge list because nothing else fits.
TEST(EdgeList, FitsEveryLine) {
  const auto complaint = [](const std::string& text) { return error_of([&] { read(text); }); };
  EXPECT_THAT(complaint("1 2 3 4\n2 3\n3 4 5 6 7\n"), HasSubstr("file:3: not an edge: expected 4 fields"));
  EXPECT_THAT(complaint("source,target\na,b,c\n"), HasSubstr("file:2: not an edge: expected 2 fields"));
  EXPECT_THAT(complaint("10.5 14.4 0\n18.0 15.9 10\n"), HasSubstr("looks like a table of coordinates"));
  EXPECT_THAT(complaint("x,y,score\n1,2,3\n2,1,4\n"), HasSubstr("looks like a table of coordinates"));
  EXPECT_EQ(complaint("x,y\ny,z\n"), "");
  EXPECT_THAT(complaint("Id;Label\n1;dock\n2;hall\n"), HasSubstr("looks like a table of nodes"));
  EXPECT_THAT(complaint("version 1\n0\tmaps/a.map\t9\t9\t1\t1\t2\t2\t1.4\n"),
              HasSubstr("file: this looks like a scenario of MovingAI"));
  EXPECT_THAT(complaint("version 1.0\n0 a.map 9 9 1 1 2 2 1.4\n"), HasSubstr("looks like a scenario"));
  EXPECT_THAT(complaint("%%MatrixMarket matrix coordinate real general\n3 3 1\n1 2 5\n"), HasSubstr("Matrix Market"));
  EXPECT_THAT(complaint("nothing\n"), HasSubstr("no format of maps is known by this content"));
  EXPECT_THAT(complaint("<svg/>"), HasSubstr("XML of another kind"));
}

TEST(Tgf, HoldsNodesAndEdges) {
  const std::string text = "1 dock\n2 the hall\n3 lab\n#\n1 2 2.5\n2 3 1\n";
  const GraphMap map = read_graph(text);
  EXPECT_THAT(map.labels, ElementsAre("dock", "the hall", "lab"));
  EXPECT_EQ(map.graph.edge_count(), 2);
  EXPECT_EQ(map.graph.cost(0, 0), 2.5);
  EXPECT_FALSE(map.graph.directed());
  EXPECT_THAT(note_of(text), HasSubstr("edges of TGF lead both ways (--directed: one way)"));
  EXPECT_TRUE(std::get<GraphMap>(format_of(text).read(text, "file", {.directed = true})).graph.directed());
  EXPECT_THAT(read_graph("a\nb\n# \n\na b road\n").labels, ElementsAre("a", "b"));
  EXPECT_THAT(note_of("a\nb\n#\na b road\n"), HasSubstr("1 with a text for a label cost 1"));
  const auto complaint = [](const std::string& rest) { return error_of([&] { read("1 a\n2 b\n#\n" + rest); }); };
  EXPECT_THAT(complaint("1 3\n"), HasSubstr("file:4: no such node"));
  EXPECT_THAT(complaint("1\n"), HasSubstr("file:4: not an edge"));
  EXPECT_THAT(complaint("1 2 -3\n"), HasSubstr("file:4: bad cost"));
}

TEST(Metis, HoldsNeighboursOfEachNode) {
  const GraphMap ring = read_graph("4 4\n2 4\n1 3\n2 4\n1 3\n");
  EXPECT_EQ(ring.graph.node_count(), 4);
  EXPECT_EQ(ring.graph.edge_count(), 4);
  EXPECT_THAT(ring.labels, ElementsAre("1", "2", "3", "4"));
  // Weights of nodes, costs of edges, comments, a node without edges.
  const GraphMap costs = read_graph("%x\n3 1 011\n5 2 7\n% y\n6 1 7\n8\n\n");
  EXPECT_EQ(costs.graph.edge_count(), 1);
  EXPECT_EQ(costs.graph.cost(1, 0), 7);
  EXPECT_EQ(read_graph("3 1\n2\n1\n\n").graph.node_count(), 3);
  EXPECT_EQ(note_of("3 1\n2\n1\n\n"), "file: taken for a graph of METIS: 3 nodes and the neighbours of each");
  EXPECT_THAT(note_of("3 1 010\n5 2\n6 1\n8\n"), HasSubstr("of each; weights and sizes of nodes are skipped"));
  const auto complaint = [](const std::string& text) { return error_of([&] { read(text); }); };
  EXPECT_THAT(complaint("3 3\n2 3\n1 3\n2 2\n"), HasSubstr("looks like a graph of METIS, but edge 1 3 is not listed"));
  EXPECT_THAT(complaint("2 1 1\n2 5\n1 6\n"), HasSubstr("not listed at both of its ends"));
}

TEST(Chao, HoldsAProblemOfOneExplorer) {
  const std::string text = "n 4\nm 1\ntmax 9.5\n0.0\t0.0\t0\n3 0 20\n3.0;4.0;30\n0 4 0\n";
  const GraphMap map = read_graph(text);
  EXPECT_EQ(map.graph.node_count(), 4);
  EXPECT_TRUE(map.graph.is_complete());
  EXPECT_EQ(map.graph.cost(0, map.graph.index_of(0, 2)), 5);
  EXPECT_THAT(map.prizes, ElementsAre(0, 20, 30, 0));
  EXPECT_EQ(map.task.budget, 9.5);
  EXPECT_EQ(map.task.start, 0);
  EXPECT_EQ(map.task.end, 3);
  EXPECT_THAT(map.places.points.back(), (Point{0, 4}));
  const auto complaint = [](const std::string& other) { return error_of([&] { read(other); }); };
  EXPECT_THAT(complaint("n 4\nm 3\ntmax 9\n"), HasSubstr("file:2: teams cannot be planned yet"));
  EXPECT_THAT(complaint("n 2\nm 1\ntmax 9\n0 0 0\n"), HasSubstr("the file ends too early"));
  EXPECT_THAT(complaint("n 1\nm 1\ntmax 9\n0 0 0\n1 1 1\n"), HasSubstr("file:5: more places than n"));
  EXPECT_THAT(complaint("n 1\nm 1\ntmax 9\n0 0 -1\n"), HasSubstr("bad score"));
  EXPECT_THAT(complaint("n 1\nm 1\ntmax 9\n0 0\n"), HasSubstr("strange line"));
}

TEST(CellTable, IsAGrid) {
  for (const char* const text :
       {"0,0,1\n0,1,1\n", "0;0;1\r\n0;1;1\r\n", "0 0 1\n0 1 1", "0\t0\t1\n0\t1\t1\n\n", "001\n011\n"}) {
    const GridMap map = read_grid(text);
    EXPECT_EQ(map.rows, 2);
    EXPECT_THAT(map.blocked, ElementsAre(false, false, true, false, true, true)) << text;
  }
  EXPECT_THAT(note_of("0,0,1\n0,1,1\n"), HasSubstr("taken for a grid of 2 rows and 3 columns, 1 is blocked"));
  EXPECT_THAT(note_of("0,1,0\n1,0,1\n0,1,0\n"), HasSubstr("an adjacency matrix is read as"));
  EXPECT_THAT(error_of([] { read("1,1\n1,1\n"); }), HasSubstr("no free cell"));
}

constexpr const char* kGraphMl = R"(<?xml version="1.0" encoding="UTF-8"?>
<graphml xmlns="http://graphml.graphdrawing.org/xmlns">
  <key id="d0" for="node" attr.name="label" attr.type="string"/>
  <key id="d1" for="node" attr.name="score" attr.type="double"><default>2</default></key>
  <key id="d2" for="edge" attr.name="distance" attr.type="double"/>
  <key id="d3" for="all" attr.name="colour" attr.type="string"/>
  <graph edgedefault="undirected">
    <node id="n0"><data key="d0">dock &amp; yard</data><data key="d1">5</data></node>
    <node id="n1"><data key="d0">gate</data><data key="d3">red</data></node>
    <node id="n2"><data key="d0">hall</data></node>
    <edge source="n0" target="n1"><data key="d2">2.5</data></edge>
    <edge source="n1" target="n2"/>
  </graph>
</graphml>
)";

TEST(GraphMl, TakesWhatOthersWrite) {
  const GraphMap map = read_graph(kGraphMl);
  EXPECT_THAT(map.labels, ElementsAre("dock & yard", "gate", "hall"));
  EXPECT_THAT(map.prizes, ElementsAre(5, 2, 2));
  EXPECT_TRUE(map.places.points.empty());
  EXPECT_FALSE(map.graph.directed());
  EXPECT_EQ(map.graph.cost(1, 0), 2.5);
  EXPECT_EQ(map.graph.cost(1, 1), 1);
}

TEST(GraphMl, MixesEdgesOneWayAndBothWays) {
  const GraphMap map = read_graph(
      "<graphml><graph edgedefault='undirected'><node id='a'/><node id='b'/><node id='c'/>"
      "<edge source='a' target='b'/><edge source='b' target='c' directed='true'/></graph></graphml>");
  EXPECT_TRUE(map.graph.directed());
  EXPECT_THAT(map.labels, ElementsAre("a", "b", "c"));
  EXPECT_THAT(map.graph.neighbours(1), ElementsAre(0, 2));
  EXPECT_TRUE(map.graph.neighbours(2).empty());
}

TEST(GraphMl, RefusesWhatIsNoGraph) {
  const auto complaint = [](const std::string& graph) {
    return error_of([&] { read("<graphml>\n<key id='w' for='edge' attr.name='weight'/>" + graph + "</graphml>"); });
  };
  EXPECT_THAT(complaint("<graph>"), HasSubstr("XML that is not well formed"));
  EXPECT_THAT(complaint(""), HasSubstr("no graph"));
  EXPECT_THAT(complaint("<graph><node id='a'/></graph>\n<graph/>"), HasSubstr("file:3: a second graph"));
  EXPECT_THAT(complaint("<graph/>"), HasSubstr("no free node"));
  EXPECT_THAT(complaint("<graph><node/></graph>"), HasSubstr("file:2: a node without an id"));
  EXPECT_THAT(complaint("<graph><node id='a'/>\n<node id='a'/></graph>"), HasSubstr("file:3: an id used twice"));
  EXPECT_THAT(complaint("<graph><node id='a'/><hyperedge/></graph>"), HasSubstr("more than two nodes"));
  EXPECT_THAT(complaint("<graph><node id='a'/><edge source='a' target='b'/></graph>"),
              HasSubstr("no such node: expected the id of a node, got 'b'"));
  EXPECT_THAT(complaint("<graph><node id='a'/><edge source='a' target='a'><data key='w'>-1</data></edge></graph>"),
              HasSubstr("bad weight: expected a number from 0 up, got '-1'"));
}

TEST(Gml, TakesWhatOthersWrite) {
  const GraphMap map = read_graph(R"(# comment
Creator "somebody"
graph [
  directed 1
  name "x [ y"
  edge [ source 10 target 11 weight 2.5 data [ weight "x" ] ]
  node [ id 10 label "a &amp; &quot;b&quot; &#252;" graphics [ x 1.5 y -2 w 9 ] ]
  node [ id 11 label "gate" score 3 graphics [ x 0 y 0 ] ]
]
)");
  EXPECT_THAT(map.labels, ElementsAre("a & \"b\" ü", "gate"));
  EXPECT_TRUE(map.graph.directed());
  EXPECT_EQ(map.graph.cost(0, 0), 2.5);
  EXPECT_THAT(map.prizes, ElementsAre(1, 3));
  EXPECT_THAT(map.places.points, ElementsAre(Point{1.5, -2}, Point{0, 0}));
}

TEST(Gml, RefusesWhatIsNoGraph) {
  const auto complaint = [](const std::string& rest) { return error_of([&] { read("graph [\n" + rest); }); };
  EXPECT_THAT(complaint(""), HasSubstr("the file ends within a list"));
  EXPECT_THAT(complaint("node ["), HasSubstr("the file ends within a list"));
  EXPECT_THAT(complaint("]"), HasSubstr("no free node"));
  EXPECT_THAT(complaint("]\ngraph [ ]"), HasSubstr("file:3: a second graph"));
  EXPECT_THAT(complaint("node [ label \"a\" ] ]"), HasSubstr("a node without `id`"));
  EXPECT_THAT(complaint("node [ id 1 ]\nnode [ id 1 ] ]"), HasSubstr("file:3: an id used twice"));
  EXPECT_THAT(complaint("node [ id 1 ]\nedge [ source 1 target 2 ] ]"), HasSubstr("file:3: no such node"));
  EXPECT_THAT(complaint("node [ id 1 ] edge [ source 1 target 1 weight -1 ] ]"), HasSubstr("bad weight"));
  EXPECT_THAT(complaint("node [ id 1 ] edge [ source 1 target 1 weight NaN ] ]"), HasSubstr("bad weight"));
  EXPECT_THAT(complaint("node [ id 1 label \"a ] ]"), HasSubstr("a text that does not end"));
  EXPECT_THAT(complaint("node [ id ] ]"), HasSubstr("not a value"));
  EXPECT_THAT(complaint("7 ]"), HasSubstr("not a key"));
  std::string deep;
  for (int i = 0; i < 100'000; ++i) deep += "a [ ";
  EXPECT_THAT(complaint(deep), HasSubstr("too deep"));
}

TEST(Pajek, TakesWhatOthersWrite) {
  const GraphMap map = read_graph(
      "*Network x\n%c\n*Vertices 4\n1 \"a b\" 0.1 0.2 0.5 ellipse\n2 c 1 1\n3 d 2 2\n4 e 3 3\n*Edges\n1 2 2.5\n"
      "*Arcs :1 \"r\"\n2 3\n*Arcslist\n3 1 4\n*Edgeslist\n4 1\n");
  EXPECT_THAT(map.labels, ElementsAre("a b", "c", "d", "e"));
  EXPECT_THAT(map.places.points, ElementsAre(Point{0.1, 0.2}, Point{1, 1}, Point{2, 2}, Point{3, 3}));
  EXPECT_TRUE(map.graph.directed());
  EXPECT_EQ(map.graph.edge_count(), 7);
  EXPECT_EQ(map.graph.cost(1, 0), 2.5);
  const GraphMap plain = read_graph("*vertices 3\n*edges\n1 3\n");
  EXPECT_THAT(plain.labels, ElementsAre("1", "2", "3"));
  EXPECT_FALSE(plain.graph.directed());
  const GraphMap matrix = read_graph("*Vertices 2\n*Matrix\n0 3\n0 0\n");
  EXPECT_EQ(matrix.graph.cost(0, 0), 3);
  EXPECT_EQ(matrix.graph.edge_count(), 1);
}

TEST(Pajek, RefusesWhatIsNoGraph) {
  const auto complaint = [](const std::string& text) { return error_of([&] { read(text); }); };
  EXPECT_THAT(complaint("*Vertices\n"), HasSubstr("file:1: bad number of nodes"));
  EXPECT_THAT(complaint("*Vertices 10000000\n"), HasSubstr("for a file of this size"));
  EXPECT_THAT(complaint("*Network\n*Edges\n"), HasSubstr("no *Vertices before"));
  EXPECT_THAT(complaint("*Network\n1 2\n"), HasSubstr("no *Vertices before"));
  EXPECT_THAT(complaint("*Vertices 2\n2 a\n1 b\n"), HasSubstr("file:3: a node used twice, or out of order"));
  EXPECT_THAT(complaint("*Vertices 2\n1 \"a\n"), HasSubstr("a text that does not end"));
  EXPECT_THAT(complaint("*Vertices 2\n*Edges\n1 3\n"), HasSubstr("file:3: no such node"));
  EXPECT_THAT(complaint("*Vertices 2\n*Edges\n1\n"), HasSubstr("not an edge"));
  EXPECT_THAT(complaint("*Vertices 2\n*Edges\n1 2 -1\n"), HasSubstr("bad weight"));
  EXPECT_THAT(complaint("*Vertices 2\n*Partition x\n"), HasSubstr("a section that is none of a graph"));
  EXPECT_THAT(complaint("*Vertices 2\n*Matrix\n0 1\n"), HasSubstr("the file ends within *Matrix"));
  EXPECT_THAT(complaint("*Vertices 2\n*Matrix\n0 1 2\n"), HasSubstr("bad row of *Matrix"));
}

TEST(Dot, TakesWhatOthersWrite) {
  const GraphMap map = read_graph(R"(# by hand
strict digraph "my graph" {
  graph [bb="0,0,9,9"]; rankdir = LR
  node [prize=2, label="\N"];
  start [pos="1.5,-2!", prize=5]  // the start
  start:n -> { a; b [label="bee"] } -> "c" + "d" [weight=3];
  subgraph cluster_1 { node [prize=4]; e; }
  { rank=same; a; e; }
  e -> -1.5 [label=<<b>bold</b>>, blocked];
  /* "quoted \" end */ "q\"u" -> start;
})");
  EXPECT_THAT(map.labels, ElementsAre("start", "a", "b", "cd", "e", "-1.5", "q\"u"));
  EXPECT_THAT(map.prizes, ElementsAre(5, 2, 2, 2, 4, 2, 2));
  EXPECT_TRUE(map.graph.directed());
  EXPECT_EQ(map.graph.edge_count(), 6);
  EXPECT_THAT(map.graph.neighbours(0), ElementsAre(1, 2));
  EXPECT_EQ(map.graph.cost(1, 0), 3);
  const GraphMap places = read_graph("graph { a [pos=\"1,2\"]; b [pos=\"3,4,5\"]; a -- b }");
  EXPECT_THAT(places.places.points, ElementsAre(Point{1, 2}, Point{3, 4}));
}

TEST(Dot, RefusesWhatIsNoGraph) {
  const auto complaint = [](const std::string& rest) { return error_of([&] { read("graph {\n" + rest); }); };
  EXPECT_THAT(complaint(""), HasSubstr("file:2: not a node, an edge or an attribute"));
  EXPECT_THAT(complaint("}"), HasSubstr("no free node"));
  EXPECT_THAT(complaint("a } graph { b }"), HasSubstr("file:2: more than one graph"));
  EXPECT_THAT(complaint("a -> b }"), HasSubstr("file:2: the wrong sign of an edge: expected '--' in a graph"));
  EXPECT_THAT(complaint("a -- b [weight=-1] }"), HasSubstr("file:2: bad weight"));
  EXPECT_THAT(complaint("a -- b [weight=nan] }"), HasSubstr("bad weight"));
  EXPECT_THAT(complaint("\"a }"), HasSubstr("a text that does not end"));
  EXPECT_THAT(complaint("a [label=<b] }"), HasSubstr("a text that does not end"));
  EXPECT_THAT(complaint("a [= b] }"), HasSubstr("not an attribute"));
  EXPECT_THAT(complaint("a -- ; }"), HasSubstr("an edge to nowhere"));
  EXPECT_THAT(complaint(std::string(100'000, '{')), HasSubstr("too deep"));
  std::string many = "{ a";
  for (int i = 0; i < 2000; ++i) many += fmt::format(" {}", i);
  many += " }";
  EXPECT_THAT(complaint(many + "--" + many + "--" + many + "--" + many), HasSubstr("far more edges"));
}

TEST(MapFormats, TakeCostsByAnyName) {
  const auto cost = [](const std::string& text, const std::string& name) {
    const AnyMap map = format_of(text).read(text, "file", {.cost_attribute = name});
    return std::get<GraphMap>(map).graph.cost(0, 0);
  };
  const std::string node_link =
      R"({"nodes":[{"id":0},{"id":1}],"links":[{"source":0,"target":1,"length":4,"time":7}]})";
  EXPECT_EQ(cost(node_link, ""), 4);
  EXPECT_EQ(cost(node_link, "time"), 7);
  EXPECT_THAT(error_of([&] { cost(node_link, "tiem"); }), HasSubstr("no edge has this attribute"));
  const std::string dot = "graph { a -- b [distance=4, weight=3, time=7] }";
  EXPECT_EQ(cost(dot, ""), 3);
  EXPECT_EQ(cost(dot, "time"), 7);
  EXPECT_EQ(cost(dot, "distance"), 4);
  EXPECT_THAT(error_of([&] { cost(dot, "tiem"); }), HasSubstr("expected distance, weight, time, got 'tiem'"));
  EXPECT_EQ(cost("from,to,time,cost\na,b,7,4\n", "time"), 7);
  EXPECT_EQ(cost("a b {'time': 7, 'weight': 4}\n", "time"), 7);
  EXPECT_THAT(error_of([&] { cost("a b 7\n", "time"); }), HasSubstr("no edge has this attribute"));
}

TEST(MapFormats, SayWhenSomeNodesLieNowhere) {
  const std::string text = "graph [ node [ id 0 x 1 y 2 ] node [ id 1 ] edge [ source 0 target 1 ] ]";
  std::string note;
  const AnyMap map = format_of(text).read(text, "file", {.note = [&](const std::string& line) { note = line; }});
  EXPECT_TRUE(std::get<GraphMap>(map).places.points.empty());
  EXPECT_THAT(note, HasSubstr("only 1 of 2 nodes have coordinates"));
}

TEST(NodeLink, TakesAttributesByTheirUsualNames) {
  const GraphMap map =
      read_graph(R"({"graph":{"unit":"m","x":[{"unit":"k"}]},"nodes":[{"id":5,"name":"a","lon":1,"lat":2,"score":3},)"
                 R"({"id":6,"label":"b","lon":3,"lat":4}],"edges":[{"source":5,"target":6}]})");
  EXPECT_THAT(map.labels, ElementsAre("a", "b"));
  EXPECT_THAT(map.prizes, ElementsAre(3, 1));
  EXPECT_THAT(map.places.points, ElementsAre(Point{1, 2}, Point{3, 4}));
}

// Every format that grids are written in keeps their cells.
TEST(MapFormats, KeepGrids) {
  const GridMap map{.rows = 2, .cols = 3, .blocked = {false, true, false, true, true, false}};
  for (const MapFormat& format : map_formats()) {
    if (format.write_grid == nullptr) continue;
    const std::string text = format.write_grid(map);
    EXPECT_EQ(format_of(text).name, format.name);
    const GridMap again = read_grid(text);
    EXPECT_EQ(again.rows, 2);
    EXPECT_EQ(again.cols, 3);
    EXPECT_EQ(again.blocked, map.blocked) << format.name;
  }
}

// Every format that graphs are written in keeps all that it is given.
TEST(MapFormats, KeepGraphs) {
  for (const EdgeKind kind : {EdgeKind::kUndirected, EdgeKind::kDirected}) {
    const std::vector<Edge> edges = {{0, 1, 0.1}, {1, 2, 3}, {2, 0, 1e-9}};
    const GraphMap map{.graph = Graph::from_edges(3, edges, kind),
                       .blocked = {false, true, false},
                       .labels = {"<a>\t& \"b\"", "Süd\\N", "7"},
                       .prizes = {1, 0.25, 1e6},
                       .places = {.points = {{0.1, -2}, {1e-7, 3}, {4, 5}}, .unit = "m"}};
    for (const MapFormat& format : map_formats()) {
      if (format.write_graph == nullptr) continue;
      const std::string text = format.write_graph(map);
      EXPECT_EQ(format_of(text).name, format.name);
      const GraphMap again = read_graph(text);
      EXPECT_EQ(again.blocked, map.blocked) << text;
      EXPECT_EQ(again.labels, map.labels) << text;
      EXPECT_EQ(again.prizes, map.prizes) << text;
      EXPECT_EQ(again.places.points, map.places.points) << text;
      EXPECT_EQ(again.places.unit, map.places.unit) << text;
      EXPECT_EQ(again.graph.directed(), map.graph.directed());
      ASSERT_EQ(again.graph.edges().size(), map.graph.edges().size());
      for (std::size_t i = 0; i < map.graph.edges().size(); ++i) {
        EXPECT_EQ(again.graph.edges()[i].a, map.graph.edges()[i].a);
        EXPECT_EQ(again.graph.edges()[i].b, map.graph.edges()[i].b);
        EXPECT_EQ(again.graph.edges()[i].cost, map.graph.edges()[i].cost);
      }
    }
  }
}

// Names of two digits are no cells, and what stands after the last place is none.
TEST(MapFormats, TakesNoEdgesForCellsAndNoPlaceTooMany) {
  EXPECT_FALSE(is_cell_table("00 01\n00 10\n01 11\n10 11\n"));
  EXPECT_TRUE(is_cell_table("0 0 1\n0 1 0\n0 0 0\n"));
  EXPECT_TRUE(is_cell_table("001\n010\n000\n"));
  EXPECT_THAT(error_of([] { parse_chao("n 1\n0 0 0\n1 1 5\nm 1\ntmax 9\n", "file"); }),
              ::testing::HasSubstr("more places than n"));
}

}  // namespace
}  // namespace graphdrl
