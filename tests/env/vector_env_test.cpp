#include "graphdrl/env/vector_env.h"

#include <gtest/gtest.h>

#include "support.h"

namespace graphdrl {
namespace {

// Random walks of many episodes, each with numbers of its own: the same one by one and side by side, on any number of
// threads.
TEST(VectorEnv, StepsEpisodesAsIfEachWereAlone) {
  const World world = grid_world("....\n.##.\n....\n");
  constexpr int kCount = 150;  // two blocks and a remainder
  constexpr int kSteps = 40;
  const EpisodeOptions options{.budget = 15};
  const auto walk_on = [&](Episode& episode, Rng& rng) {
    if (episode.done()) episode.reset(world.valid_nodes()[rng.below(static_cast<std::uint32_t>(world.valid_count()))]);
    episode.step(static_cast<int>(rng.below(4)));
  };
  std::vector<std::vector<NodeId>> expected;
  for (int i = 0; i < kCount; ++i) {
    Rng rng(static_cast<std::uint64_t>(i));
    Episode episode(world, options);
    episode.reset(0);
    for (int step = 0; step < kSteps; ++step) walk_on(episode, rng);
    expected.push_back(episode.walk());
  }
  for (const int threads : {1, 2, 3}) {
    set_threads(threads);
    VectorEnv env(world, options, kCount);
    std::vector<Rng> rngs;
    for (int i = 0; i < kCount; ++i) {
      rngs.emplace_back(static_cast<std::uint64_t>(i));
      env[i].reset(0);
    }
    for (int step = 0; step < kSteps; ++step) {
      env.for_each([&](int index, Episode& episode) { walk_on(episode, rngs[index]); });
    }
    for (int i = 0; i < kCount; ++i) ASSERT_EQ(env[i].walk(), expected[i]) << threads << " threads, episode " << i;
  }
  set_threads(1);
}

}  // namespace
}  // namespace graphdrl
