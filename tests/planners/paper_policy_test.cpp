#include "graphdrl/planners/paper_policy.h"

#include <gmock/gmock.h>

#include "graphdrl/eval/rollout.h"
#include "graphdrl/io/file.h"
#include "graphdrl/planners/registry.h"
#include "support.h"

namespace graphdrl {
namespace {

using ::testing::HasSubstr;

TEST(Argmax, TakesTheLowestOfEquals) {
  EXPECT_EQ(argmax(std::vector<float>{1, 3, 3, 2}), 1);
  EXPECT_EQ(argmax(std::vector<float>{-1}), 0);
}

TEST(PaperPolicy, TakesTheDirectionOfTheHighestQValueEvenWhereItIsBlocked) {
  // All weights 0: the Q-values are the last layer's biases.
  PaperParameters parameters;
  parameters.tensor("fc2.bias")[1] = 0.5f;  // up
  PaperPolicy policy(std::move(parameters));
  const World world = grid_world("..\n..\n");
  const std::vector<NodeId> starts = {0, 3};
  const auto results = roll_out(Episode(world, {.budget = 2}), starts, policy);
  EXPECT_EQ(results[0].walk, (std::vector<NodeId>{0, 0, 0}));
  EXPECT_EQ(results[1].walk, (std::vector<NodeId>{3, 1, 1}));
  EXPECT_EQ(results[1].prize, 2);
}

TEST(PaperPolicy, SeesTheWallThatItsParametersSay) {
  const World world = grid_world("..\n..\n");
  const NodeId last = 3;  // row 1 and column 1: the border, but neither 0 nor 9
  for (const PaperWall wall : {PaperWall::kBorder, PaperWall::kZeroOrNine}) {
    Rng rng(5);
    PaperParameters parameters(rng);
    parameters.set_wall(wall);
    PaperNetwork network;
    network.set_parameters(parameters);
    Episode episode(world, {.budget = 2});
    episode.reset(0);

    std::vector<float> x(static_cast<std::size_t>(world.node_count()) * kPaperFeatureCount);
    PaperFeatureEncoder(world, PaperWall::kBorder).begin(0, x);
    x[last * kPaperFeatureCount + static_cast<int>(PaperFeature::kWall)] = wall == PaperWall::kBorder ? 1.0f : 0.0f;
    GraphBatch batch;
    batch.add(world.graph());
    std::array<float, kActionCount> expected{};
    network.q_values(batch, x, expected);

    std::array<float, kActionCount> q{};
    const Observation now = episode.observation();
    PaperPolicy(parameters).q_values({&now, 1}, q);
    EXPECT_EQ(q, expected);
  }
}

TEST(Registry, MakesPoliciesByNameAndFile) {
  const TemporaryFolder folder;
  Rng rng(1);
  write_policy_file(folder / "mine.safetensors", PaperParameters(rng));
  for (const char* name :
       {"random", "random-walk", "dfs", "nearest", "exact", "search", "search:7", "tour", "tour:8"}) {
    EXPECT_NE(make_policy(name, 1), nullptr);
    EXPECT_EQ(parse_policy(name).label, name);
  }
  const std::string file = (folder / "mine.safetensors").string();
  EXPECT_NE(make_policy(file, 1), nullptr);
  EXPECT_EQ(parse_policy(file).label, "mine");
  EXPECT_THAT(error_of([] { make_policy("best", 1); }),
              HasSubstr("expected search[:ITERATIONS], beam[:W], guided[:W[:FILE]], dfs, exact, explorer, frontier, "
                        "nearest, open, pocket, random, random-walk, tour[:M] or a policy file, got 'best'"));
  for (const char* const name : {"search:0", "search:", "search:x", "search:-1", "search:1.5"}) {
    EXPECT_THAT(error_of([&] { make_policy(name, 1); }), HasSubstr("search:N with N from 1 to ")) << name;
  }
  for (const char* const name : {"tour:0", "tour:", "tour:1.5", "tour:1000001"}) {
    EXPECT_THAT(error_of([&] { make_policy(name, 1); }), HasSubstr("tour:M with M from 1 to 1000000")) << name;
  }
}

}  // namespace
}  // namespace graphdrl
