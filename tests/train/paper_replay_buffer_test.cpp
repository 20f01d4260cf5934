#include "graphdrl/train/paper_replay_buffer.h"

#include <gtest/gtest.h>

#include <deque>

#include "graphdrl/io/file.h"
#include "support.h"

namespace graphdrl {
namespace {

struct Stored {
  Transition transition;
  std::vector<std::uint16_t> visits;
};

bool same(const Transition& a, const Transition& b) {
  return a.world == b.world && a.position == b.position && a.action == b.action && a.next_position == b.next_position &&
         a.reward == b.reward && a.terminal == b.terminal;
}

Stored random_stored(Rng& rng, std::size_t nodes) {
  Stored stored{.transition = {.world = static_cast<std::int32_t>(rng.below(3)),
                               .position = static_cast<NodeId>(rng.below(9)),
                               .action = static_cast<std::int32_t>(rng.below(4)),
                               .next_position = static_cast<NodeId>(rng.below(9)),
                               .reward = static_cast<float>(rng.uniform()),
                               .terminal = rng.below(2) == 1},
                .visits = {}};
  for (std::size_t i = 0; i < nodes; ++i) stored.visits.push_back(static_cast<std::uint16_t>(rng.below(65'536)));
  return stored;
}

void save(const PaperReplayBuffer& buffer, const std::filesystem::path& path) {
  CheckpointWriter writer("paper");
  buffer.save(writer);
  writer.add(TrainingProgress{});
  write_file(path, writer.content());
}

TEST(PaperReplayBuffer, IsADequeOfItsCapacityAndSurvivesACheckpoint) {
  const TemporaryFolder folder;
  Rng rng(1);
  constexpr std::size_t kCapacity = 7;
  constexpr std::size_t kNodes = 5;
  PaperReplayBuffer buffer(kCapacity, kNodes);
  std::deque<Stored> twin;
  for (int i = 0; i < 60; ++i) {
    Stored stored = random_stored(rng, 1 + rng.below(kNodes));
    buffer.push(stored.transition, std::vector<std::uint32_t>(stored.visits.begin(), stored.visits.end()));
    stored.visits.resize(kNodes);
    twin.push_back(stored);
    if (twin.size() > kCapacity) twin.pop_front();

    ASSERT_EQ(buffer.size(), twin.size());
    for (const Stored& expected : twin) {  // the ring holds the same transitions, in some order
      bool found = false;
      for (std::size_t k = 0; k < buffer.size() && !found; ++k) {
        const auto visits = buffer.visits(k);
        found = same(buffer.transition(k), expected.transition) &&
                std::equal(visits.begin(), visits.end(), expected.visits.begin(), expected.visits.end());
      }
      ASSERT_TRUE(found);
    }
    save(buffer, folder / "c");
    PaperReplayBuffer restored(kCapacity, kNodes);
    restored.restore(Checkpoint::read(folder / "c"), [](const Transition&) { return true; });
    buffer = restored;  // and all goes on from there
  }
}

TEST(PaperReplayBuffer, RefusesACheckpointThatDoesNotFit) {
  const TemporaryFolder folder;
  PaperReplayBuffer buffer(4, 3);
  for (int i = 0; i < 4; ++i) buffer.push({}, std::vector<std::uint32_t>{1, 2, 3});
  save(buffer, folder / "c");
  const Checkpoint file = Checkpoint::read(folder / "c");
  const auto any = [](const Transition&) { return true; };
  EXPECT_NE(error_of([&] { PaperReplayBuffer(3, 3).restore(file, any); }), "");
  EXPECT_NE(error_of([&] { PaperReplayBuffer(4, 2).restore(file, any); }), "");
  EXPECT_EQ(error_of([&] { PaperReplayBuffer(4, 3).restore(file, any); }), "");
  EXPECT_NE(error_of([&] { PaperReplayBuffer(4, 3).restore(file, [](const Transition&) { return false; }); }), "");
}

}  // namespace
}  // namespace graphdrl
