#include "graphdrl/train/lessons.h"

#include <gtest/gtest.h>

#include <cmath>

#include "graphdrl/planners/exact.h"
#include "support.h"

namespace graphdrl {
namespace {

TEST(Lessons, OfSmallWorldsAreWorthWhatExactSearchSays) {
  // Searches this long find the best walks here.
  const LessonOptions options{
      .worlds = {{"obstacles", 4}, {"tree", 10}, {"erdos-renyi", 9, false, true}}, .teacher_steps = 1000, .lead = 0.5};
  Rng rng(1);
  const ExplorerParameters parameters(rng);
  int checked = 0;
  ExplorerEncoder encoder;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    for (const Lesson& lesson : draw_lessons(options, parameters, seed)) {
      ExplorerBatch batch;
      const auto found = lesson.append_to(batch, encoder);
      const std::vector<FirstVisit> visits(found.begin(), found.end());
      ASSERT_EQ(visits.size(), lesson.shortfall.size());
      for (std::size_t i = 0; i < visits.size(); ++i) {
        if (std::isnan(lesson.shortfall[i])) continue;
        Lesson after = lesson;
        visit(after, visits[i]);
        // All edges cost 1. A walk may cost no more than is left, and no less than one edge a node.
        const double most = 1 + *exact_prize(rest_of(after));
        const double least = batch.ceiling[0] - most;
        EXPECT_GE(lesson.shortfall[i], least - 1e-4);
        EXPECT_LE(lesson.shortfall[i], least + kWorthOfCost * (lesson.spendable - most) + 1e-4);
        ++checked;
      }
    }
  }
  EXPECT_GT(checked, 300);
}

}  // namespace
}  // namespace graphdrl
