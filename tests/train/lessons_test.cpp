#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "graphdrl/planners/exact.h"
#include "graphdrl/train/explorer_replay.h"
#include "train/training.h"

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

TEST(ExplorerReplay, GivesBackTheLessonsOfACheckpointOrNone) {
  const TemporaryFolder folder;
  const LessonOptions options{.worlds = {{"obstacles", 4}, {"tree", 10}}, .teacher_steps = 1};
  Rng rng(1);
  const std::vector<Lesson> lessons = draw_lessons(options, ExplorerParameters(rng), 5);
  ASSERT_GT(lessons.size(), 1u);
  ExplorerReplay replay(lessons.size());
  for (const Lesson& lesson : lessons) replay.push(lesson);
  CheckpointWriter writer(kExplorerPreset);
  replay.save(writer);
  writer.add(TrainingProgress{});
  write_file(folder / "c", writer.content());
  const auto same_bits = [](float one, float other) {  // a label may be not a number
    return std::bit_cast<std::uint32_t>(one) == std::bit_cast<std::uint32_t>(other);
  };
  ExplorerReplay restored(lessons.size());
  restored.restore(Checkpoint::read(folder / "c"), options);
  ASSERT_EQ(restored.size(), lessons.size());
  for (std::size_t i = 0; i < lessons.size(); ++i) {
    const Lesson& back = restored.lesson(i);
    EXPECT_EQ(back.at->seed, 5u);
    EXPECT_EQ(back.at, restored.lesson(0).at) << "one world";
    EXPECT_EQ(back.visited.count(), lessons[i].visited.count());
    EXPECT_EQ(back.position, lessons[i].position);
    EXPECT_EQ(back.spendable, lessons[i].spendable);
    EXPECT_EQ(back.scope, lessons[i].scope);
    EXPECT_TRUE(std::ranges::equal(back.shortfall, lessons[i].shortfall, same_bits));
  }
  const auto refused = [&](const char* name, std::size_t index, std::int64_t value) {
    write_file(folder / "bad", with_element(read_file(folder / "c"), name, index, value));
    return error_of([&] { restored.restore(Checkpoint::read(folder / "bad"), options); });
  };
  const std::size_t last = lessons.size() - 1;
  const std::int64_t labels = std::ssize(lessons[last].shortfall);
  EXPECT_EQ(refused("replay.label_count", last, labels), "");
  EXPECT_NE(refused("replay.label_count", last, labels - 1), "") << "more labels than first visits";
}

}  // namespace
}  // namespace graphdrl
