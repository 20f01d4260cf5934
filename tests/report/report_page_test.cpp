#include "graphdrl/report/report_page.h"

#include <gmock/gmock.h>

#include "explored.h"
#include "graphdrl/base/error.h"
#include "graphdrl/io/file.h"
#include "graphdrl/report/layout.h"
#include "support.h"

namespace graphdrl {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

nlohmann::json data_of(const ReportPage& page) {
  return nlohmann::json::parse(page.data());
}

Answer report_on(const World& world, std::vector<NodeId> walk, double budget) {
  const Task task(world, walk.front(), budget);
  return {.world = world, .task = task, .policy = "mine", .plan = plan_of_walk(task, std::move(walk))};
}

TEST(ReportPage, HoldsWhatNobodyMayBreakOutOf) {
  ReportPage page("</title> & {{data}}");
  const World world("</script><script>", Graph::from_edges(2, std::vector<Edge>{{0, 1}}), std::vector<bool>(2),
                    {"a\xff", "{{script}}"});
  page.add_plan(report_on(world, {0, 1}, 1));
  const std::string html = page.html();
  EXPECT_THAT(html, HasSubstr("<title>&lt;/title&gt; &amp; {{data}}</title>"));
  EXPECT_THAT(html, HasSubstr("\"name\":\"\\u003c/script>\\u003cscript>\""));
  EXPECT_THAT(html, HasSubstr("\"labels\":[\"a\xef\xbf\xbd\",\"{{script}}\"]"));
  EXPECT_THAT(html, Not(HasSubstr("{{nonce}}")));
  EXPECT_NE(html, page.html()) << "every page has a secret of its own";
}

TEST(ReportPage, ShowsPlansOfOneWorldTogether) {
  const World grid = grid_world("..\n#.\n");
  ReportPage page("Two");
  page.add_plan(report_on(grid, {0, 0, 1, 3}, 4));
  page.add_plan(report_on(grid, {3, 1}, 4));
  const nlohmann::json replays = data_of(page)["replays"];
  ASSERT_EQ(replays.size(), 1U);
  EXPECT_EQ(replays[0]["world"]["blocked"], "BA==");  // node 2
  EXPECT_EQ(replays[0]["world"]["valid"], 3);
  EXPECT_THAT(replays[0]["plans"][0]["walk"], ElementsAre(0, 0, 1, 3));
  EXPECT_EQ(replays[0]["plans"][1]["visited"], 2);
  EXPECT_FALSE(replays[0]["plans"][0].contains("upper_bound")) << "none was given";
}

TEST(ReportPage, LaysAWorldOutOnceForAllPagesMadeOfOne) {
  const World path("w", Graph::from_edges(3, std::vector<Edge>{{0, 1}, {1, 2}}), std::vector<bool>(3));
  const World star("w", Graph::from_edges(3, std::vector<Edge>{{0, 1}, {0, 2}}), std::vector<bool>(3));
  ReportPage first("W");
  first.add_plan(report_on(path, {0, 1}, 1));
  ReportPage next = first.emptied();
  EXPECT_TRUE(data_of(next)["replays"].empty());
  next.add_plan(report_on(star, {0, 1}, 1));
  EXPECT_EQ(data_of(next), data_of(first)) << "known by its name";
}

TEST(ReportPage, LaysOutWhatHasNoPlacesAsPicturesDo) {
  const std::vector<Edge> edges = {{0, 1}, {1, 2}, {2, 3}};
  const World world("path", Graph::from_edges(4, edges), std::vector<bool>(4));
  ReportPage page("Path");
  page.add_plan(report_on(world, {0, 1}, 1));
  const nlohmann::json shown = data_of(page)["replays"][0]["world"];
  EXPECT_EQ(shown["laid_out"], true);
  const std::vector<Point> places = lay_out(world.graph());
  for (std::size_t i = 0; i < places.size(); ++i) {
    EXPECT_EQ((Point{shown["x"][i], shown["y"][i]}), places[i]);
  }
}

TEST(ReportPage, KnowsEdgesPlacesAndCosts) {
  const std::vector<Edge> edges = {{0, 1, 2.5}, {1, 2, 1}};
  const World world("map", Graph::from_edges(3, edges), std::vector<bool>(3), {}, {1, 2, 5}, {},
                    {.points = {{0, 0}, {0, 2}, {-1, 2}}, .unit = "m"});
  Answer answer = report_on(world, {0, 1, 2}, 4);
  answer.plan.bound = 6;
  ReportPage page("Graph");
  page.add_plan(answer);
  const nlohmann::json replay = data_of(page)["replays"][0];
  EXPECT_THAT(replay["world"]["edges"], ElementsAre(0, 1, 1, 2));
  EXPECT_THAT(replay["world"]["x"], ElementsAre(0, 0, -1));
  EXPECT_THAT(replay["plans"][0]["costs"], ElementsAre(0, 2.5, 3.5));
  EXPECT_DOUBLE_EQ(replay["plans"][0]["upper_bound"].get<double>(), 75);
}

TEST(ReportPage, KnowsWhatAWalkHasSeen) {
  const World grid = grid_world("..\n#.\n");
  ReportPage page("Seen");
  page.add_plan(explored(grid, "edges", {0, 1}));
  page.add_plan(report_on(grid, {0, 1}, 4));
  const nlohmann::json plans = data_of(page)["replays"][0]["plans"];
  EXPECT_EQ(plans[0]["reveal"], "edges");
  EXPECT_THAT(plans[0]["seen_nodes"], ElementsAre(0, 1, 3));
  EXPECT_THAT(plans[0]["seen_after_step"], ElementsAre(2, 3));
  EXPECT_FALSE(plans[1].contains("seen_nodes")) << "the map was known";
}

TEST(ReportPage, LeavesOutALineThatIsStillBeingWritten) {
  const TemporaryFolder folder;
  write_file(folder / "metrics.jsonl", "{\"episode\": 1, \"loss\": 2}\n\n{\"episode\": 2");
  ReportPage page("Run");
  page.add_run("one", folder.path());
  EXPECT_EQ(data_of(page)["runs"][0]["lines"].dump(), "[{\"episode\":1,\"loss\":2}]");
  write_file(folder / "metrics.jsonl", "{\"episode\": 1}\nnull\n");
  EXPECT_THROW(page.add_run("two", folder.path()), Error);
}

TEST(MoveScores, AreOfTheMovesThatArePossible) {
  const World world = grid_world("..\n#.\n");
  const MoveScores scores = scores_along(report_on(world, {0, 1, 3}, 4), "explorer");
  EXPECT_TRUE(scores.lower_is_better);
  ASSERT_EQ(scores.steps.size(), 3U);
  ASSERT_EQ(scores.steps[0].size(), 1U) << "node 3 is behind node 1";
  EXPECT_EQ(scores.steps[0][0].node, 1);
  EXPECT_EQ(scores.steps[1][0].node, 3);
  EXPECT_TRUE(scores.steps[2].empty()) << "all is visited";
}

}  // namespace
}  // namespace graphdrl
