#include "graphdrl/train/lessons.h"

#include <gtest/gtest.h>

#include <cmath>

#include "graphdrl/planners/exact.h"
#include "support.h"

namespace graphdrl {
namespace {

TEST(Lessons, OfSmallWorldsAreWorthWhatExactSearchSays) {
  // A beam this wide drops nothing here.
  const LessonOptions options{.worlds = {{"obstacles", 4}, {"tree", 10, true}, {"erdos-renyi", 9, false, true}},
                              .teacher_width = 5000,
                              .lead = 0.5};
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
        const double gain = *exact_prize(rest_of(after));
        EXPECT_FLOAT_EQ(lesson.shortfall[i], static_cast<float>(batch.ceiling[0] - 1 - gain));
        ++checked;
      }
    }
  }
  EXPECT_GT(checked, 300);
}

}  // namespace
}  // namespace graphdrl
