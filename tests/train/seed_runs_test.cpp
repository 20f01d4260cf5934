#include "graphdrl/train/seed_runs.h"

#include <gmock/gmock.h>

#include <atomic>

#include "graphdrl/base/parallel.h"
#include "train/training.h"

namespace graphdrl {
namespace {

using ::testing::HasSubstr;
using Seeds = std::vector<std::uint64_t>;

constexpr auto kNever = [] { return false; };
constexpr auto kSilent = [](const SideBySideNews&) {};

TEST(ParseSeeds, TakesNumbersAndRanges) {
  EXPECT_EQ(parse_seeds("3"), Seeds{3});
  EXPECT_EQ(parse_seeds("1-4"), (Seeds{1, 2, 3, 4}));
  EXPECT_EQ(parse_seeds("9,1-3,2,18446744073709551615"), (Seeds{1, 2, 3, 9, 18446744073709551615u}));
  for (const char* const bad : {"", ",", "1,", ",1", "1-", "-1", "4-1", "1--2", "1 2", "a", "1-2-3", "0x1", "1.5",
                                "18446744073709551616", "0-18446744073709551615", "1-10001"}) {
    EXPECT_THAT(error_of([&] { parse_seeds(bad); }), HasSubstr("--seeds")) << bad;
  }
}

// The run of a seed alone.
Bytes alone(const std::filesystem::path& path, TrainOptions options, std::uint64_t seed) {
  options.seed = seed;
  return train_in(path, options);
}

class SeedRunsThread : public ::testing::TestWithParam<TrainOptions> {
 protected:
  ~SeedRunsThread() override { set_threads(1); }
};

INSTANTIATE_TEST_SUITE_P(, SeedRunsThread, ::testing::Values(short_paper(), short_explorer()),
                         [](const auto& test) { return test.param.preset; });

TEST_P(SeedRunsThread, EndWithTheBytesOfRunsAlone) {
  const TemporaryFolder folder;
  const Seeds seeds = {1, 7};
  std::vector<Bytes> single;
  for (const std::uint64_t seed : seeds) {
    single.push_back(alone(folder / ("alone" + std::to_string(seed)), GetParam(), seed));
  }
  EXPECT_FALSE(single[0] == single[1]);
  for (const int count : {1, 2}) {
    set_threads(count);
    SeedRuns runs = SeedRuns::start(GetParam(), seeds, folder / ("all" + std::to_string(count)));
    std::int64_t done = 0;
    int seeds_done = 0;
    EXPECT_TRUE(runs.trainings().run(kNever, [&](const SideBySideNews& news) {
      EXPECT_EQ(news.units_done, ++done);
      EXPECT_GE(news.runs_done, seeds_done);
      seeds_done = news.runs_done;
    }));
    EXPECT_EQ(done, 2 * runs.trainings().units().count);
    EXPECT_EQ(seeds_done, 2);
    for (std::size_t i = 0; i < seeds.size(); ++i) {
      EXPECT_TRUE(bytes_of(runs.trainings().runs()[i].directory) == single[i])
          << count << " threads, seed " << seeds[i];
      EXPECT_EQ(read_config(runs.trainings().runs()[i].directory.config()).seed, seeds[i]);
    }
  }
}

TEST_P(SeedRunsThread, GoOnWhereTheyWereStopped) {
  const TemporaryFolder folder;
  const Bytes second = alone(folder / "alone", GetParam(), 2);
  set_threads(2);
  SeedRuns::start(GetParam(), {1, 2}, folder / "all");
  int sessions = 0;
  const int questions = GetParam().preset == kPaperPreset ? kShortPaperSteps / 2 : 70;
  // Stopped after so many questions, on whatever thread.
  for (bool finished = false; !finished; ++sessions) {
    std::atomic<int> asked = 0;
    SeedRuns runs = SeedRuns::resume(folder / "all");
    finished = runs.trainings().run([&] { return asked++ > questions; }, kSilent);
  }
  EXPECT_GT(sessions, GetParam().preset == kPaperPreset ? 2 : 1);
  EXPECT_TRUE(bytes_of(RunDirectory(folder / "all" / "seed-2")) == second);
}

// A kill while runs were begun: one is missing, one has its configuration alone.
TEST(SeedRuns, BeginWhatIsMissing) {
  const TemporaryFolder folder;
  SeedRuns::start(short_paper(), {1, 2, 3}, folder / "all");
  TrainOptions options = short_paper();
  for (const std::uint64_t seed : {1, 3}) {
    options.seed = seed;
    Trainer::start(options, SeedRuns::run_directory_in(folder / "all", seed));
  }
  for (const char* const file : {"checkpoint.safetensors", "policy.safetensors", "run.json"}) {
    std::filesystem::remove(folder / "all" / "seed-3" / file);
  }
  SeedRuns runs = SeedRuns::resume(folder / "all");
  EXPECT_TRUE(runs.trainings().run(kNever, kSilent));
  for (const std::uint64_t seed : {2, 3}) {
    EXPECT_TRUE(bytes_of(SeedRuns::run_directory_in(folder / "all", seed)) ==
                alone(folder / std::to_string(seed), short_paper(), seed));
  }
}

// A device that works for trainings together: here each by itself.
class Together final : public LearnerSource {
 public:
  std::vector<std::unique_ptr<LearnerSource>> make_together(const std::string& /*device*/,
                                                            int trainings) const override {
    groups.push_back(trainings);
    std::vector<std::unique_ptr<LearnerSource>> sources;
    for (int i = 0; i < trainings; ++i) sources.push_back(std::make_unique<LearnerSource>());
    return sources;
  }

  mutable std::vector<int> groups;
};

TEST(SideBySideThread, TrainTogetherWhatDiffersInSeedsAlone) {
  const TemporaryFolder folder;
  std::vector<PlannedRun> runs;
  for (const std::uint64_t seed : {1, 2, 3}) {
    runs.push_back({short_paper(), RunDirectory(folder / std::to_string(seed))});
    runs.back().options.seed = seed;
  }
  runs[1].options.batch_size = 4;
  const Together learners;
  EXPECT_TRUE(SideBySide(runs, folder.path()).run(kNever, kSilent, learners));
  EXPECT_EQ(learners.groups, (std::vector<int>{2, 1}));
  for (const PlannedRun& run : runs) {
    EXPECT_TRUE(bytes_of(run.directory) == train_in(folder / "alone" / run.directory.path().filename(), run.options));
  }
}

TEST(SeedRuns, TakeNoOtherRunForTheirs) {
  const TemporaryFolder folder;
  TrainOptions other = short_paper();
  other.seed = 2;
  other.discount = 0.5;
  Trainer::start(other, SeedRuns::run_directory_in(folder / "all", 2));
  EXPECT_THAT(error_of([&] {
                SeedRuns::start(short_paper(), {1, 2}, folder / "all");
              }),
              HasSubstr("holds a run already"));
  EXPECT_FALSE(SeedRuns::are_in(folder / "all"));
  SeedRuns::start(short_paper(), {1, 3}, folder / "all");
  Trainer::start(other, SeedRuns::run_directory_in(folder / "all", 3));
  EXPECT_THAT(error_of([&] { SeedRuns::resume(folder / "all").trainings().run(kNever, kSilent); }),
              HasSubstr("of other options"));
  EXPECT_TRUE(train(*Trainer::resume(SeedRuns::run_directory_in(folder / "all", 3))));
  EXPECT_THAT(error_of([&] { SeedRuns::resume(folder / "all"); }), HasSubstr("of other options"));
}

// With one thread, too, one run that cannot go on keeps no other from it.
TEST(SeedRuns, GoOnBesideOneThatIsLocked) {
  const TemporaryFolder folder;
  SeedRuns runs = SeedRuns::start(short_paper(), {1, 2}, folder / "all");
  std::filesystem::create_directory(folder / "all/seed-1");
  const RunLock held(SeedRuns::run_directory_in(folder / "all", 1));
  EXPECT_THROW(runs.trainings().run(kNever, kSilent), RunLocked);
  EXPECT_TRUE(state_of(SeedRuns::run_directory_in(folder / "all", 2)).finished());
  EXPECT_FALSE(state_of(SeedRuns::run_directory_in(folder / "all", 1)).finished());
}

TEST(SeedRuns, ShareNoFolderWithASingleRun) {
  const TemporaryFolder folder;
  Trainer::start(short_paper(), RunDirectory(folder / "one"));
  EXPECT_THAT(error_of([&] {
                SeedRuns::start(short_paper(), {1, 2}, folder / "one");
              }),
              HasSubstr("holds a run already"));
}

TEST(SeedRuns, RefuseFoldersThatAreNone) {
  const TemporaryFolder folder;
  EXPECT_FALSE(SeedRuns::are_in(folder / "all"));
  TrainOptions bad = short_paper();
  bad.maps = {"no-such-map"};
  EXPECT_THAT(error_of([&] { SeedRuns::start(bad, {1, 2}, folder / "all"); }), HasSubstr("no such map"));
  EXPECT_FALSE(std::filesystem::exists(folder / "all"));
  SeedRuns::start(short_paper(), {1, 2}, folder / "all");
  EXPECT_TRUE(SeedRuns::are_in(folder / "all"));
  EXPECT_EQ(error_of([&] { SeedRuns::start(short_paper(), {1, 2}, folder / "all"); }), "");
  EXPECT_THAT(error_of([&] { SeedRuns::start(short_paper(), {1, 3}, folder / "all"); }), HasSubstr("--resume"));
  const std::filesystem::path file = folder / "all" / "seeds.json";
  const std::string whole = read_file(file);
  for (const char* const text : {"", "[]", "{}", R"({"seeds": []})", R"({"seeds": [-1]})", R"({"seeds": [1, 1]})",
                                 R"({"seeds": [1], "speed": 3})", R"({"seeds": "1-2"})"}) {
    write_file(file, text);
    EXPECT_THAT(error_of([&] { SeedRuns::resume(folder / "all"); }), HasSubstr("seeds.json")) << text;
  }
  write_file(file, whole);
  EXPECT_EQ(error_of([&] { SeedRuns::resume(folder / "all"); }), "");
}

}  // namespace
}  // namespace graphdrl
