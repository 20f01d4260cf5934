#include "graphdrl/eval/seed_distribution.h"

#include <gmock/gmock.h>

#include "graphdrl/env/load_worlds.h"
#include "graphdrl/nn/paper_network.h"
#include "support.h"

namespace graphdrl {
namespace {

using ::testing::HasSubstr;

// Networks that nobody trained, by their seeds.
std::vector<std::string> policies_in(const TemporaryFolder& folder, int count) {
  std::vector<std::string> files;
  for (int seed = 0; seed < count; ++seed) {
    Rng rng(static_cast<std::uint64_t>(seed));
    files.push_back((folder / ("seed" + std::to_string(seed) + ".safetensors")).string());
    write_policy_file(files.back(), PaperParameters(rng));
  }
  return files;
}

TEST(SeedDistribution, HoldsEachSeedsMeanOverAllStarts) {
  const TemporaryFolder folder;
  const std::vector<std::string> files = policies_in(folder, 3);
  const std::vector<World> worlds = load_worlds({"paper:a", "paper:b", "paper:d"});
  const SeedDistribution distribution = distribution_over_seeds(files, worlds, {"paper:a"}, Budget::parse("25"));
  ASSERT_EQ(distribution.rows.size(), 5u);
  EXPECT_EQ(distribution.budget, 25);

  const Comparison each = compare(worlds, {.policies = files, .all_starts = true});
  for (std::size_t map = 0; map < 3; ++map) {
    const SeedRow& row = distribution.rows[map];
    EXPECT_EQ(row.name, worlds[map].name());
    for (std::size_t seed = 0; seed < 3; ++seed) {
      EXPECT_EQ(row.means[seed], each.rows[seed * 3 + map].coverage->mean);
    }
    EXPECT_EQ(row.paper, paper_result(row.name, 25)->mean);
    EXPECT_EQ(row.optimum, 100);
  }
  EXPECT_NEAR(distribution.rows[0].nearest, 95.3, 0.05);

  // b and d, which nobody was trained on: means of the two, seed by seed.
  const SeedRow& unseen = distribution.rows[3];
  EXPECT_EQ(unseen.name, "unseen");
  for (std::size_t seed = 0; seed < 3; ++seed) {
    EXPECT_NEAR(unseen.means[seed], (distribution.rows[1].means[seed] + distribution.rows[2].means[seed]) / 2, 1e-12);
  }
  EXPECT_NEAR(*unseen.paper, (61.9 + 55.2) / 2, 1e-12);
  EXPECT_NEAR(*unseen.paper_z, (*unseen.paper - unseen.over_seeds.mean) / *unseen.over_seeds.std, 1e-12);
  EXPECT_EQ(distribution.rows[4].name, "all");
}

TEST(SeedDistribution, HasNoSpreadOfOneSeedAndNoPaperElsewhere) {
  const TemporaryFolder folder;
  const auto files = policies_in(folder, 1);
  const SeedDistribution distribution =
      distribution_over_seeds(files, {grid_world("..\n..\n")}, {"test"}, Budget::parse("4"));
  ASSERT_EQ(distribution.rows.size(), 1u);
  const SeedRow& row = distribution.rows[0];
  EXPECT_FALSE(row.over_seeds.std);
  EXPECT_FALSE(row.paper);
  EXPECT_FALSE(row.paper_z);
  EXPECT_EQ(row.lowest, row.over_seeds.best);
  EXPECT_THAT(format_distribution(distribution), HasSubstr("–"));
  EXPECT_THAT(markdown_distribution(distribution), HasSubstr("| test |"));
}

}  // namespace
}  // namespace graphdrl
