#include "graphdrl/train/lesson_arrays.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
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
  ExplorerScratch scratch;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    for (const Lesson& lesson : draw_lessons(options, parameters, seed)) {
      ExplorerBatch batch;
      const auto found = lesson.append_to(batch, scratch);
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

TEST(LessonArrays, GiveBackTheLessonsOrNone) {
  const LessonOptions options{.worlds = {{"obstacles", 4}, {"tree", 10}}, .teacher_steps = 1};
  Rng rng(1);
  const std::vector<Lesson> lessons = draw_lessons(options, ExplorerParameters(rng), 5);
  ASSERT_GT(lessons.size(), 1u);
  LessonArrays arrays;
  for (const Lesson& lesson : lessons) arrays.add(lesson);
  const auto same_bits = [](float one, float other) {  // a label may be not a number
    return std::bit_cast<std::uint32_t>(one) == std::bit_cast<std::uint32_t>(other);
  };
  const std::vector<Lesson> back = arrays.lessons(options).value();
  ASSERT_EQ(back.size(), lessons.size());
  for (std::size_t i = 0; i < back.size(); ++i) {
    EXPECT_EQ(back[i].at->seed, 5u);
    EXPECT_EQ(back[i].at, back[0].at) << "one world";
    EXPECT_EQ(back[i].visited.count(), lessons[i].visited.count());
    EXPECT_EQ(back[i].position, lessons[i].position);
    EXPECT_EQ(back[i].spendable, lessons[i].spendable);
    EXPECT_EQ(back[i].scope, lessons[i].scope);
    EXPECT_TRUE(std::ranges::equal(back[i].shortfall, lessons[i].shortfall, same_bits));
  }
  arrays.label.push_back(0);
  EXPECT_FALSE(arrays.lessons(options)) << "more labels than first visits";
}

}  // namespace
}  // namespace graphdrl
