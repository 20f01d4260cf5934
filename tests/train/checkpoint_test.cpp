#include "graphdrl/train/checkpoint.h"

#include <gmock/gmock.h>

#include "graphdrl/base/note.h"
#include "graphdrl/nn/paper_network.h"
#include "train/training.h"

namespace graphdrl {
namespace {

using ::testing::HasSubstr;

// The error of reading a checkpoint with this metadata.
std::string error_with(const Metadata& metadata) {
  const TemporaryFolder folder;
  write_safetensors(folder / "c", {}, metadata);
  return error_of([&] {
    const Checkpoint checkpoint = Checkpoint::read(folder / "c");
    checkpoint.require_preset(kPaperPreset);
    checkpoint.progress();
  });
}

constexpr const char* kProgress = R"({"done": 3, "samples": 40, "elapsed_s": 1.5})";

TEST(Checkpoint, OfAnotherVersionOrPresetIsRefusedInOneLine) {
  const std::string layout = std::to_string(kPaperLayout);
  EXPECT_EQ(error_with({{"layout", layout}, {"preset", "paper"}, {"progress", kProgress}}), "");
  EXPECT_THAT(error_with({{"progress", R"({"episode": 3})"}}),
              HasSubstr("begin anew: expected layout 3, got an older one"));
  EXPECT_THAT(error_with({{"layout", "99"}, {"preset", "paper"}, {"progress", kProgress}}), HasSubstr("got '99'"));
  // An explorer's of before, which has more arrays.
  EXPECT_THAT(error_with({{"layout", "2"}, {"preset", "explorer"}, {"progress", kProgress}}),
              HasSubstr("begin anew: expected layout 4, got '2'"));
  EXPECT_THAT(error_with({{"layout", "4"}, {"preset", "explorer"}, {"progress", kProgress}}),
              HasSubstr("another preset than config.json's: expected paper, got 'explorer'"));
  EXPECT_THAT(error_with({}), HasSubstr("not a checkpoint"));
}

// Since its layout there is a checksum: a file without one is damaged, or older, which is said.
TEST(Checkpoint, WithoutAChecksumIsDamagedOrOlder) {
  const TemporaryFolder folder;
  std::vector<std::string> notes;
  listen_to_notes([&](const std::string& text) { notes.push_back(text); });
  const auto error_of_layout = [&](const std::string& layout) {
    const std::string header =
        nlohmann::json{{"__metadata__", {{"layout", layout}, {"preset", "paper"}, {"progress", kProgress}}}}.dump();
    const std::uint64_t length = header.size();
    write_file(folder / "c", std::string(reinterpret_cast<const char*>(&length), sizeof length) + header);
    return error_of([&] { Checkpoint::read(folder / "c"); });
  };
  EXPECT_THAT(error_of_layout("3"), HasSubstr("its checksum is missing"));
  EXPECT_TRUE(notes.empty());
  EXPECT_EQ(error_of_layout("2"), "");
  listen_to_notes({});
  ASSERT_EQ(notes.size(), 1);
  EXPECT_THAT(notes[0], HasSubstr("no checksum"));
}

TEST(Checkpoint, WithBadProgressIsRefused) {
  const auto error_of_progress = [](const std::string& progress) {
    return error_with({{"layout", std::to_string(kPaperLayout)}, {"preset", "paper"}, {"progress", progress}});
  };
  EXPECT_THAT(error_of_progress("{"), HasSubstr("no number 'done'"));
  EXPECT_THAT(error_of_progress(R"({"done": -3, "samples": 40, "elapsed_s": 1.5})"), HasSubstr("no number 'done'"));
  EXPECT_THAT(error_of_progress(R"({"done": 3, "samples": 18446744073709551615, "elapsed_s": 1.5})"),
              HasSubstr("no number 'samples'"));
  EXPECT_THAT(error_of_progress(R"({"done": 3, "samples": 40})"), HasSubstr("no number 'elapsed_s'"));
  EXPECT_THAT(error_of_progress(std::string(1'000'000, '[')), HasSubstr("nested too deeply"));
}

// What is written is what is read.
TEST(Checkpoint, HoldsWhatWasWritten) {
  const TemporaryFolder folder;
  Rng rng(5);
  const PaperParameters online(rng);
  const PaperParameters target(rng);
  const std::size_t count = PaperParameters::trainable_count();
  AdamState adam(count);
  adam.exp_avg[3] = -2;
  adam.exp_avg_sq[4] = 3;
  adam.steps = 17;
  CheckpointWriter writer(kPaperPreset);
  writer.add(TrainingProgress{.done = 3, .samples = 40, .elapsed_s = 1.5});
  writer.add(rng);
  writer.add("online.", online);
  writer.add("target.", target);
  writer.add(adam);
  write_file(folder / "c", writer.content());

  const Checkpoint read = Checkpoint::read(folder / "c");
  EXPECT_EQ(read.progress().done, 3);
  EXPECT_EQ(read.progress().samples, 40);
  EXPECT_EQ(read.progress().elapsed_s, 1.5);
  EXPECT_EQ(read.rng().state(), rng.state());
  EXPECT_TRUE(std::ranges::equal(read.parameters<PaperParameters>("online.").values(), online.values()));
  EXPECT_TRUE(std::ranges::equal(read.parameters<PaperParameters>("target.").values(), target.values()));
  const AdamState learned = read.adam(count);
  EXPECT_EQ(learned.exp_avg, adam.exp_avg);
  EXPECT_EQ(learned.exp_avg_sq, adam.exp_avg_sq);
  EXPECT_EQ(learned.steps, 17);
  EXPECT_THAT(error_of([&] { read.adam(count - 1); }), HasSubstr("wrong shape"));
}

}  // namespace
}  // namespace graphdrl
