#include "graphdrl/base/clock.h"

#include <gmock/gmock.h>

#include <cmath>

#include "support.h"

namespace graphdrl {
namespace {

TEST(Clock, WithoutADeadlineNeverPasses) {
  const Clock clock;
  EXPECT_FALSE(clock.has_deadline());
  EXPECT_FALSE(clock.passed());
  EXPECT_TRUE(std::isinf(clock.seconds_left()));
  EXPECT_FALSE(clock.share(0.5).has_deadline());
  EXPECT_FALSE(clock.sooner(5).has_deadline());
  EXPECT_LE(clock.at_most(100).seconds_left(), 100);
}

TEST(Clock, SharesWhatIsLeft) {
  const Clock clock(1000);
  EXPECT_FALSE(clock.passed());
  EXPECT_NEAR(clock.share(0.25).seconds_left(), 250, 1);
  EXPECT_NEAR(clock.sooner(400).seconds_left(), 600, 1);
  EXPECT_NEAR(clock.at_most(10).seconds_left(), 10, 1);
  EXPECT_NEAR(clock.at_most(10'000).seconds_left(), 1000, 1);
  EXPECT_TRUE(Clock(0).passed());
  EXPECT_TRUE(clock.sooner(2000).passed());
}

TEST(Clock, StopsAndGoesOn) {
  std::atomic<bool> stop = false;
  const Clock clock(std::nullopt, &stop);
  const Clock part = clock.share(0.5).at_most(1000);
  stop = true;
  EXPECT_TRUE(clock.passed());
  EXPECT_TRUE(part.stopped());
  stop = false;
  EXPECT_FALSE(clock.passed());
  EXPECT_FALSE(part.passed());
}

TEST(Clock, TellsItsListener) {
  std::vector<int> told;
  const ProgressListener listener = [&](const Progress& progress) { told.push_back(progress.visited); };
  Ticker ticker(Clock(1000, nullptr, &listener), /*every=*/10);
  for (int i = 1; i <= 25; ++i) EXPECT_FALSE(ticker.tick(i));
  EXPECT_THAT(told, ::testing::ElementsAre(10, 20));
  Clock().tell({.visited = 1});  // nobody listens
}

TEST(Clock, RefusesBadTimeLimits) {
  for (const double seconds : {-1.0, 2e6, std::nan("")}) {
    EXPECT_THAT(error_of([&] { Clock{seconds}; }), ::testing::HasSubstr("bad time limit")) << seconds;
  }
}

}  // namespace
}  // namespace graphdrl
