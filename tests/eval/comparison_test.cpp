#include "graphdrl/eval/comparison.h"

#include <gmock/gmock.h>

#include "graphdrl/base/parallel.h"
#include "graphdrl/env/load_worlds.h"
#include "graphdrl/nn/paper_network.h"
#include "graphdrl/planners/registry.h"
#include "support.h"

namespace graphdrl {
namespace {

using ::testing::HasSubstr;

std::vector<World> paper_worlds() {
  return load_worlds({"paper"});
}

// The figures were computed independently, with the same tie rules.
TEST(Compare, FindsTheKnownCoveragesOfThePapersMaps) {
  const Comparison result = compare(paper_worlds(), {.policies = {"nearest", "exact"}, .all_starts = true});
  ASSERT_EQ(result.rows.size(), 20u);
  const std::vector<double> nearest = {95.3, 100, 100, 100, 100, 100, 95.8, 97.7, 100, 99.8};
  for (int map = 0; map < 10; ++map) {
    EXPECT_NEAR(result.rows[map].coverage->mean, nearest[map], 0.051) << result.rows[map].map;
    EXPECT_EQ(result.rows[map].episodes, result.rows[map].valid_nodes);
    EXPECT_EQ(result.rows[10 + map].coverage->mean, 100);
    EXPECT_EQ(*result.rows[map].optimum, 100);
  }
  EXPECT_NEAR(*result.overall[0].mean, 98.9, 0.1);
  EXPECT_NEAR(*result.overall[0].ratio_to_optimum, 0.989, 0.001);
  EXPECT_EQ(result.overall[1].maps, 10);
}

TEST(Compare, StandsBesideThePaperUnderItsBudgetOnly) {
  EXPECT_EQ(paper_result("paper:a", 25)->mean, 89.8);
  EXPECT_EQ(paper_result("paper:j", 25)->best, 95.5);
  EXPECT_FALSE(paper_result("paper:a", 24));
  EXPECT_FALSE(paper_result("a", 25));
  EXPECT_FALSE(paper_result("paper:k", 25));
}

TEST(Compare, IsTheSameForTheSameSeedAndStartsEveryPolicyAlike) {
  const ComparisonOptions options{.policies = {"nearest", "random", "nearest"}, .episodes = 7, .seed = 3};
  const std::vector<World> worlds = paper_worlds();
  const Comparison once = compare(worlds, options);
  const Comparison again = compare(worlds, options);
  EXPECT_EQ(format_comparison(once), format_comparison(again));
  for (std::size_t map = 0; map < worlds.size(); ++map) {
    EXPECT_EQ(once.rows[map].coverage->mean, once.rows[20 + map].coverage->mean);
    EXPECT_EQ(once.rows[map].episodes, 7);
  }
}

TEST(Compare, GivesAMapTheSameFiguresWhateverPoliciesStandBeside) {
  std::vector<World> worlds = paper_worlds();
  const Comparison alone = compare(worlds, {.policies = {"random"}});
  const Comparison among = compare(worlds, {.policies = {"random-walk", "nearest", "random"}});
  for (std::size_t map = 0; map < worlds.size(); ++map) {
    EXPECT_EQ(alone.rows[map].coverage->mean, among.rows[20 + map].coverage->mean);
  }
}

TEST(Compare, IsTheSameForAnyNumberOfThreads) {
  const ComparisonOptions options{.policies = {"random", "nearest", "guided:4", "exact"}, .episodes = 9};
  const std::string one = format_comparison(compare(paper_worlds(), options));
  for (const int count : {2, 3}) {
    set_threads(count);
    EXPECT_EQ(format_comparison(compare(paper_worlds(), options)), one) << count << " threads";
  }
  set_threads(1);
}

TEST(Compare, NamesPoliciesOfOneStemByTheirPaths) {
  const TemporaryFolder folder;
  std::vector<std::string> files;
  for (const char* name : {"one", "two"}) {
    std::filesystem::create_directory(folder / name);
    files.push_back((folder / name / "policy.safetensors").string());
    write_policy_file(files.back(), PaperParameters());
  }
  const Comparison both = compare(paper_worlds(), {.policies = files, .episodes = 1});
  EXPECT_EQ(both.overall[0].policy, files[0]);
  EXPECT_EQ(both.overall[1].policy, files[1]);
  EXPECT_EQ(compare(paper_worlds(), {.policies = {files[0]}, .episodes = 1}).overall[0].policy, "policy");
}

// The first policy takes away the file of the second one.
TEST(Compare, ReadsAPolicyFileOnce) {
  const TemporaryFolder folder;
  const std::string file = (folder / "policy.safetensors").string();
  write_policy_file(file, PaperParameters());
  const auto thief = [&] {
    std::filesystem::remove(file);
    return make_policy("random", 1);
  };
  const Comparison both =
      compare(paper_worlds(), {.policies = {"thief", file}, .episodes = 1, .own_policies = {{"thief", thief}}});
  EXPECT_FALSE(std::filesystem::exists(file));
  EXPECT_EQ(both.overall[1].maps, 10);
}

TEST(Compare, LeavesOutWhatIsOutOfReach) {
  std::vector<World> worlds;
  worlds.emplace_back("long", GridMap{.rows = 1, .cols = 5'000, .blocked = std::vector<bool>(5'000)});
  worlds.push_back(grid_world("...\n"));
  const Comparison result = compare(worlds, {.policies = {"exact", "nearest"}, .budget = Budget::parse("1.0x")});
  EXPECT_FALSE(result.rows[0].coverage);
  EXPECT_FALSE(result.rows[0].optimum);
  EXPECT_EQ(result.overall[0].maps, 1);
  EXPECT_TRUE(result.overall[0].ratio_to_optimum);
  EXPECT_FALSE(result.overall[1].ratio_to_optimum);
  EXPECT_EQ(result.rows[2].budget, 5'000);
  EXPECT_THAT(format_comparison(result), HasSubstr("optimum –: not computed for maps of more than 25 valid nodes"));
  EXPECT_THAT(format_comparison(result), HasSubstr("mean –: the policy's search is out of reach on that map"));
}

// A start without a prize, and a budget that pays for no move.
TEST(Compare, ReachesTheOptimumWhereThatIsNothing) {
  const std::vector<Edge> edges = {{0, 1, 2}};
  const World world("poor", Graph::from_edges(2, edges), std::vector<bool>(2), {}, {0, 5}, {.budget = 1, .start = 0});
  const Comparison result = compare({world}, {.policies = {"nearest"}, .episodes = 1});
  EXPECT_EQ(result.rows[0].optimum, 0);
  EXPECT_EQ(result.overall[0].mean, 0);
  EXPECT_EQ(result.overall[0].ratio_to_optimum, 1);
}

TEST(Compare, SaysWhatIsMeasuredUnderWhichConditions) {
  const std::vector<Edge> edges = {{0, 1}};
  const auto pair = [&](double budget) {
    return World("pair", Graph::from_edges(2, edges), std::vector<bool>(2), {}, {1, 5},
                 {.budget = budget, .start = 0, .end = 0});
  };
  const std::vector<std::string> nearest = {"nearest"};
  const World grid = grid_world("...\n");
  const auto first_line = [](const std::vector<World>& worlds, const ComparisonOptions& options) {
    const std::string text = format_comparison(compare(worlds, options));
    return text.substr(0, text.find('\n'));
  };
  EXPECT_EQ(first_line({grid}, {.policies = nearest}),
            "Coverage of the valid nodes in %, budget 25, 30 episodes per map, random starts (seed 1)");
  EXPECT_EQ(
      first_line({pair(2), pair(3)}, {.policies = nearest, .episodes = 1}),
      "Coverage of the sum of prizes in %, budget the maps' own, 1 episode per map, the maps' own starts, walks end "
      "at the maps' own ends");
  EXPECT_EQ(
      first_line({pair(2), grid}, {.policies = nearest, .episodes = 2, .seed = 7}),
      "Coverage of the valid nodes, or of the sum of prizes where a map has them, in %, budget the maps' own, else "
      "25, 2 episodes per map, the maps' own starts, else random ones (seed 7), walks end at the maps' own ends, "
      "else anywhere");
  EXPECT_EQ(first_line({pair(2)},
                       {.policies = nearest, .budget = Budget::parse("2x"), .end = "anywhere", .all_starts = true}),
            "Coverage of the sum of prizes in %, budget 2x, every start once, walks end anywhere");
  EXPECT_THAT(first_line({grid}, {.policies = nearest, .end = "start"}),
              HasSubstr("(seed 1), walks end where they start"));
  EXPECT_THAT(first_line({grid}, {.policies = nearest, .end = "0,1"}), HasSubstr("(seed 1), walks end at '0,1'"));
}

TEST(Compare, StandsBesideThePaperWhereWalksEndAnywhere) {
  const std::vector<World> worlds = load_worlds({"paper:a"});
  EXPECT_TRUE(compare(worlds, {.policies = {"nearest"}}).rows[0].paper);
  EXPECT_FALSE(compare(worlds, {.policies = {"nearest"}, .end = "start"}).rows[0].paper);
}

TEST(Compare, EndsWhenTheClockPasses) {
  const World world = grid_world("....\n....\n");
  const Comparison comparison = compare({world}, {.policies = {"random-walk"}, .episodes = 3}, Clock(0));
  ASSERT_TRUE(comparison.rows[0].coverage);
  EXPECT_EQ(comparison.rows[0].coverage->best, 12.5) << "the starts alone";
}

TEST(Compare, RefusesBadOptions) {
  EXPECT_THAT(error_of([] { compare(paper_worlds(), {.policies = {"nearest"}, .episodes = 0}); }),
              HasSubstr("expected at least 1, got 0"));
  EXPECT_THAT(error_of([] { compare(paper_worlds(), {.policies = {"what"}}); }), HasSubstr("no such policy"));
}

}  // namespace
}  // namespace graphdrl
