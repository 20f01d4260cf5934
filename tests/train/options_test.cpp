#include "graphdrl/train/options.h"

#include <gmock/gmock.h>

#include <cmath>

#include "graphdrl/io/file.h"
#include "support.h"

namespace graphdrl {
namespace {

using ::testing::HasSubstr;

TEST(TrainOptions, HaveDefaultsForEachPreset) {
  const TrainOptions explorer = default_options(kExplorerPreset);
  const TrainOptions paper = default_options(kPaperPreset);
  EXPECT_EQ(explorer.batch_size, 64);
  EXPECT_EQ(paper.batch_size, 32);
  EXPECT_EQ(explorer.rounds, 240);
  EXPECT_EQ(paper.maps, std::vector<std::string>{"paper:a"});
  EXPECT_EQ(error_of([&] { validate(explorer); }), "");
  EXPECT_EQ(error_of([&] { validate(paper); }), "");
  EXPECT_THAT(error_of([] { default_options("best"); }), HasSubstr("--preset: bad value: expected explorer or paper"));
}

TEST(TrainOptions, AreChecked) {
  const auto error_for = [](const char* preset, auto change) {
    TrainOptions options = default_options(preset);
    change(options);
    return error_of([&] { validate(options); });
  };
  const auto paper = [&](auto change) { return error_for(kPaperPreset, change); };
  const auto explorer = [&](auto change) { return error_for(kExplorerPreset, change); };
  EXPECT_THAT(explorer([](TrainOptions& o) { o.reveal = "sight"; }), HasSubstr("expected all or edges"));
  EXPECT_THAT(explorer([](TrainOptions& o) {
                o.reveal = "edges";
                o.teacher_steps = 5;
              }),
              HasSubstr("--teacher-steps and --ranking go with --reveal all"));
  EXPECT_THAT(paper([](TrainOptions& o) { o.preset = "best"; }), HasSubstr("--preset"));
  EXPECT_THAT(paper([](TrainOptions& o) { o.reward = "gold"; }), HasSubstr("visit_penalty or coverage_gain"));
  EXPECT_THAT(paper([](TrainOptions& o) { o.episodes = 0; }), HasSubstr("--episodes"));
  EXPECT_THAT(paper([](TrainOptions& o) { o.discount = 1.5; }), HasSubstr("expected 0 to 1, got 1.5"));
  EXPECT_THAT(paper([](TrainOptions& o) { o.replay_capacity = 32; }), HasSubstr("--replay-capacity"));
  EXPECT_THAT(paper([](TrainOptions& o) { o.learning_rate = NAN; }), HasSubstr("--learning-rate"));
  EXPECT_THAT(paper([](TrainOptions& o) { o.budget = "-3"; }), HasSubstr("bad budget"));
  EXPECT_THAT(paper([](TrainOptions& o) { o.maps.clear(); }), HasSubstr("--maps"));
  EXPECT_THAT(paper([](TrainOptions& o) {
                o.reward = "coverage_gain";
                o.punish_blocked_by_visits = true;
              }),
              HasSubstr("--punish-blocked-by-visits"));
  EXPECT_THAT(explorer([](TrainOptions& o) { o.rounds = 0; }), HasSubstr("--rounds"));
  EXPECT_THAT(explorer([](TrainOptions& o) { o.replay_capacity = 63; }), HasSubstr("expected 64 to"));
  EXPECT_EQ(explorer([](TrainOptions& o) { o.replay_capacity = 64; }), "");
}

TEST(TrainOptions, SurviveTheConfigurationFile) {
  const TemporaryFolder folder;
  for (const char* const preset : {kExplorerPreset, kPaperPreset}) {
    TrainOptions options = default_options(preset);
    options.learning_rate = 0.1 + 0.2;
    options.seed = 1'234'567'890'123'456'789;
    write_file(folder / "c", config_text(options));
    write_file(folder / "again", config_text(read_config(folder / "c")));
    EXPECT_EQ(read_file(folder / "c"), read_file(folder / "again"));
    EXPECT_EQ(read_config(folder / "c").learning_rate, options.learning_rate);
    EXPECT_EQ(read_config(folder / "c").seed, options.seed);
  }
}

TEST(TrainOptions, OfABadConfigurationFileAreRefused) {
  const TemporaryFolder folder;
  write_file(folder / "good", config_text(default_options(kPaperPreset)));
  const std::string good = read_file(folder / "good");
  const auto error_with = [&](const std::string& text) {
    write_file(folder / "c", text);
    return error_of([&] { read_config(folder / "c"); });
  };
  const auto replaced = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    return text.replace(text.find(from), from.size(), to);
  };
  EXPECT_EQ(error_with(good), "");
  EXPECT_THAT(error_with("[]"), HasSubstr("not a run's configuration"));
  EXPECT_THAT(error_with(replaced("\"preset\": \"paper\"", "\"preset\": \"best\"")), HasSubstr("--preset"));
  EXPECT_THAT(error_with(replaced("\"seed\": 1,", "")), HasSubstr("missing key 'seed'"));
  EXPECT_THAT(error_with(replaced("\"seed\": 1,", "\"seed\": 1, \"speed\": 9,")),
              HasSubstr("no option of the preset paper: got 'speed'"));
  EXPECT_THAT(error_with(replaced("\"seed\": 1,", "\"seed\": 1, \"rounds\": 9,")),
              HasSubstr("no option of the preset paper: got 'rounds'"));
  EXPECT_THAT(error_with(replaced("\"seed\": 1,", "\"seed\": [[2]],")),
              HasSubstr("seed: value of the wrong type: got '[[2]]'"));
  EXPECT_THAT(error_with(replaced("\"episodes\": 10000", "\"episodes\": 0")), HasSubstr("--episodes"));
  EXPECT_THAT(error_with(replaced("\"float32\"", "\"tf32\"")),
              HasSubstr("--precision: the cpu multiplies only in float32"));
  EXPECT_EQ(error_with(replaced(",\n  \"precision\": \"float32\"", "")), "") << "runs of version 0.1.0 lack it";
  // Printing a value nested so deeply would take more stack than there is.
  const std::string deep(1'000'000, '[');
  EXPECT_THAT(error_with(deep), HasSubstr("nested too deeply"));
  EXPECT_THAT(error_with(replaced("\"seed\": 1,", "\"seed\": " + deep + std::string(deep.size(), ']') + ",")),
              HasSubstr("nested too deeply"));
}

}  // namespace
}  // namespace graphdrl
