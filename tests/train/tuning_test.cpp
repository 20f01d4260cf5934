#include "graphdrl/train/tuning.h"

#include <gmock/gmock.h>

#include <atomic>
#include <nlohmann/json.hpp>
#include <set>

#include "graphdrl/base/parallel.h"
#include "graphdrl/env/load_worlds.h"
#include "graphdrl/eval/comparison.h"
#include "graphdrl/io/checksum.h"
#include "train/training.h"

namespace graphdrl {
namespace {

using ::testing::HasSubstr;

constexpr auto kOn = [] { return false; };
constexpr auto kUnheard = [](std::size_t, const SideBySideNews&) {};

TuneOptions small() {
  return {.rounds = parse_rounds("3x1,1x2"), .episodes = 2, .train_maps = 3, .validation_maps = 2};
}

TEST(ParseRounds, TakesEverFewerSettings) {
  const std::vector<TuneRound> rounds = parse_rounds("30x2,6x8");
  ASSERT_EQ(rounds.size(), 2u);
  EXPECT_EQ(rounds[1].settings, 6);
  EXPECT_EQ(rounds[1].seeds, 8);
  for (const char* const bad :
       {"", "3", "3x", "x2", "3x2,", "3x2,4x1", "0x2", "3x0", "-1x2", "3x2;1x1", "3 x 2", "99999x99"}) {
    EXPECT_THAT(error_of([&] { parse_rounds(bad); }), HasSubstr("--rounds")) << bad;
  }
}

TEST(Tuning, BeginsWithThePapersSettingAndMapsThatAreNotThePapers) {
  const TemporaryFolder folder;
  TuneOptions options = small();
  options.rounds = parse_rounds("40x1");
  options.train_maps = options.validation_maps = 40;
  const Tuning tuning = Tuning::start(options, folder / "tune");
  ASSERT_EQ(tuning.settings().size(), 40u);
  EXPECT_EQ(tuning.settings()[0], Setting::object());
  EXPECT_EQ(std::set<Setting>(tuning.settings().begin(), tuning.settings().end()).size(), 40u);
  std::set<std::vector<bool>> maps;
  for (const World& world :
       load_worlds({"paper", (folder / "tune/maps/train").string(), (folder / "tune/maps/validation").string()})) {
    maps.insert(world.map()->blocked);
  }
  EXPECT_EQ(maps.size(), 10u + 40u + 40u);
  EXPECT_EQ(error_of([&] { Tuning::start(options, folder / "tune"); }), "");  // the same again
  options.seed = 2;
  EXPECT_THAT(error_of([&] { Tuning::start(options, folder / "tune"); }), HasSubstr("--resume"));
  options.rounds = parse_rounds("2881x1");
  EXPECT_THAT(error_of([&] { Tuning::start(options, folder / "more"); }), HasSubstr("at most 2880"));
  EXPECT_FALSE(std::filesystem::exists(folder / "more"));
}

TEST(Tuning, ScoresAreMeansOverValidationMapsWhateverTheInterruptions) {
  const TemporaryFolder folder;
  Tuning whole = Tuning::start(small(), folder / "whole");
  ASSERT_TRUE(whole.run(kOn, kUnheard));

  set_threads(2);
  Tuning::start(small(), folder / "pieces");
  std::vector<RoundScores> scores;
  int sessions = 0;
  for (bool finished = false; !finished; ++sessions) {
    Tuning pieces = Tuning::resume(folder / "pieces");
    std::atomic<int> asked = 0;
    finished = pieces.run([&] { return asked++ > 80; }, kUnheard);
    scores = pieces.scores();
  }
  set_threads(1);
  EXPECT_GT(sessions, 2);

  ASSERT_EQ(whole.scores().size(), 2u);
  ASSERT_EQ(scores.size(), 2u);
  const std::vector<World> validation = load_worlds({(folder / "whole/maps/validation").string()});
  for (std::size_t round = 0; round < 2; ++round) {
    ASSERT_EQ(scores[round].size(), whole.scores()[round].size());
    for (std::size_t i = 0; i < scores[round].size(); ++i) {
      const SettingScore& score = whole.scores()[round][i];
      EXPECT_EQ(score.setting, scores[round][i].setting);
      EXPECT_EQ(score.by_seed, scores[round][i].by_seed);
      const std::string run = "round-" + std::to_string(round + 1) + "/setting-0" + std::to_string(score.setting) +
                              "/seed-" + std::to_string(score.by_seed.size());
      const Comparison alone =
          compare(validation, {.policies = {(folder / "whole" / run / "policy.safetensors").string()},
                               .budget = Budget::parse("25"),
                               .all_starts = true});
      EXPECT_EQ(score.by_seed.back(), *alone.overall[0].mean);
      if (i > 0) {
        EXPECT_LE(score.over_seeds.mean, whole.scores()[round][i - 1].over_seeds.mean);
      }
      if (score.setting == 0) {
        EXPECT_EQ(score.over_paper, 0);
      }
    }
  }
  // The second round has the best one, and the paper's: two where these are not the same.
  EXPECT_EQ(scores[1].size(), scores[0][0].setting == 0 ? 1u : 2u);
  // Seeds are fresh ones.
  const auto seed_of = [&](const char* run) { return read_config(RunDirectory(folder / "whole" / run).config()).seed; };
  EXPECT_NE(seed_of("round-1/setting-00/seed-1"), seed_of("round-2/setting-00/seed-1"));
  EXPECT_EQ(seed_of("round-1/setting-00/seed-1"), seed_of("round-1/setting-01/seed-1"));

  double settings = 0;
  for (const ValueEffect& effect : whole.effects())
    settings += effect.option == "reward" ? effect.over_settings.count : 0;
  EXPECT_EQ(settings, 3);
}

TEST(Tuning, RefusesFilesThatAreNone) {
  const TemporaryFolder folder;
  Tuning::start(small(), folder / "tune");
  const std::filesystem::path file = folder / "tune" / "tune.json";
  const std::string whole = read_file(file);
  for (const char* const text : {"", "[]", "{}", R"({"options": {}, "settings": []})"}) {
    write_file(file, text);
    EXPECT_THAT(error_of([&] { Tuning::resume(folder / "tune"); }), HasSubstr("tune.json")) << text;
  }
  std::string odd = whole;
  odd.replace(odd.find("\"learning_rate\": "), 16, "\"learning_speed\":");
  write_file(file, odd);
  EXPECT_THAT(error_of([&] { Tuning::resume(folder / "tune"); }), HasSubstr("the file is damaged"));
  auto older = nlohmann::ordered_json::parse(odd);  // of before there were checksums
  older.erase("layout");
  older.erase(kChecksumKey);
  write_file(file, older.dump());
  EXPECT_THAT(error_of([&] { Tuning::resume(folder / "tune"); }), HasSubstr("learning_speed"));
}

// A kill may come between the plan of a search and its maps.
TEST(Tuning, WritesMapsThatAreMissing) {
  const TemporaryFolder folder;
  Tuning::start(small(), folder / "tune");
  const std::filesystem::path maps = folder / "tune" / "maps";
  const std::string first = read_file(maps / "validation" / "map-000.txt");
  std::filesystem::remove_all(maps / "train");
  write_file(maps / "validation" / "map-000.txt", ".");
  EXPECT_EQ(error_of([&] { Tuning::resume(folder / "tune"); }), "");
  EXPECT_EQ(read_file(maps / "validation" / "map-000.txt"), first);
  EXPECT_TRUE(std::filesystem::exists(maps / "train" / "map-000.txt"));
}

}  // namespace
}  // namespace graphdrl
