// What a power cut leaves of trainings: all that was saved, and from there they end in the bytes of those left alone.
#include <gmock/gmock.h>

#include <algorithm>
#include <functional>
#include <map>
#include <ostream>

#include "graphdrl/train/seed_runs.h"
#include "graphdrl/train/tuning.h"
#include "logged_disk.h"
#include "train/training.h"

namespace graphdrl {
namespace {

namespace fs = std::filesystem;

constexpr auto kNoStop = [] { return false; };

// A kind of trainings in one folder, with one thread. Each calls `saved` when nothing is being saved.
struct Kind {
  std::string name;
  std::string begun;  // the file that the first saved() promises
  std::function<void(const fs::path&, const std::function<void()>& saved)> start;
  std::function<void(const fs::path&)> resume;
  std::size_t every;  // cuts are made after every such event
};

void PrintTo(const Kind& kind, std::ostream* out) {
  *out << kind.name;
}

TrainOptions saved_each_episode() {
  TrainOptions options = short_paper();
  options.checkpoint_every = 1;
  options.episodes = 3;
  return options;
}

Kind single_training() {
  return {.name = "paper",
          .begun = "config.json",
          .start =
              [](const fs::path& folder, const std::function<void()>& saved) {
                const auto trainer = Trainer::start(saved_each_episode(), RunDirectory(folder));
                saved();
                EXPECT_TRUE(trainer->run(kNoStop, [&](const TrainingNews&) { saved(); }));
              },
          .resume = [](const fs::path& folder) { EXPECT_TRUE(train(*Trainer::resume(RunDirectory(folder)))); },
          .every = 1};
}

Kind many_seeds() {
  const auto finish = [](SeedRuns runs, const std::function<void()>& saved) {
    EXPECT_TRUE(runs.trainings().run(kNoStop, [&](const SideBySideNews&) { saved(); }));
  };
  return {.name = "seeds",
          .begun = "seeds.json",
          .start =
              [=](const fs::path& folder, const std::function<void()>& saved) {
                SeedRuns runs = SeedRuns::start(saved_each_episode(), {1, 2}, folder);
                saved();
                finish(std::move(runs), saved);
              },
          .resume = [=](const fs::path& folder) { finish(SeedRuns::resume(folder), [] {}); },
          .every = 7};
}

Kind tuning() {
  const auto finish = [](Tuning tuning, const std::function<void()>& saved) {
    EXPECT_TRUE(tuning.run(kNoStop, [&](std::size_t, const SideBySideNews&) { saved(); }));
  };
  return {.name = "tune",
          .begun = "tune.json",
          .start =
              [=](const fs::path& folder, const std::function<void()>& saved) {
                const TuneOptions options{
                    .rounds = parse_rounds("2x1,1x1"), .episodes = 1, .train_maps = 2, .validation_maps = 1};
                Tuning tuning = Tuning::start(options, folder);
                saved();
                finish(std::move(tuning), saved);
              },
          .resume = [=](const fs::path& folder) { finish(Tuning::resume(folder), [] {}); },
          .every = 7};
}

// The runs in a folder and below it, with how much of each is done as run.json says.
std::map<fs::path, std::int64_t> runs_in(const fs::path& folder) {
  std::map<fs::path, std::int64_t> runs;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.path().filename() != "run.json") continue;
    const RunState state = state_of(RunDirectory(entry.path().parent_path()));
    EXPECT_TRUE(state.record);
    if (state.record) runs[entry.path().parent_path()] = state.record->progress.done;
  }
  return runs;
}

// By the paths within the folder.
std::map<std::string, Bytes> bytes_in(const fs::path& folder) {
  std::map<std::string, Bytes> bytes;
  for (const auto& [run, done] : runs_in(folder)) bytes[run.lexically_relative(folder)] = bytes_of(RunDirectory(run));
  return bytes;
}

class PowerCut : public ::testing::TestWithParam<Kind> {};

INSTANTIATE_TEST_SUITE_P(, PowerCut, ::testing::Values(single_training(), many_seeds(), tuning()),
                         [](const auto& test) { return test.param.name; });

// Cuts at evenly spread events; every eighth or so of what they leave is trained to its end, which takes longer.
TEST_P(PowerCut, TakesNothingThatWasSaved) {
  struct Saved {
    std::size_t events;
    std::map<fs::path, std::int64_t> runs;
  };
  const TemporaryFolder folder;
  GetParam().start(folder / "whole", [] {});
  const std::map<std::string, Bytes> whole = bytes_in(folder / "whole");
  const fs::path cut = folder / "cut";
  fs::create_directory(cut);
  std::vector<Saved> saves;
  const LoggedDisk disk;
  const auto saved = [&] { saves.push_back({disk.events(), runs_in(cut)}); };
  GetParam().start(cut / "run", saved);
  saved();
  EXPECT_EQ(saves.back().runs.size(), whole.size());
  const UnsyncedDisk from_now_on;

  Rng rng(1);
  int resumed = 0;
  for (std::size_t back = 0; back <= disk.events(); back += GetParam().every) {
    const std::size_t events = disk.events() - back;
    const bool is_last = back == 0;
    for (int variant = 0; variant < 2; ++variant) {
      disk.cut(events, cut, rng);
      const auto promised =
          std::find_if(saves.rbegin(), saves.rend(), [&](const Saved& s) { return s.events <= events; });
      const bool has_begun = fs::exists(cut / "run" / GetParam().begun);
      if (promised != saves.rend()) {
        EXPECT_TRUE(has_begun) << events;
        for (const auto& [run, done] : promised->runs) {
          EXPECT_GE(Trainer::resume(RunDirectory(run))->progress().done, done) << events << ' ' << run;
          EXPECT_TRUE(!is_last || state_of(RunDirectory(run)).finished()) << run;
        }
      }
      if (!has_begun || (rng.below(8) != 0 && !is_last)) continue;
      ++resumed;
      GetParam().resume(cut / "run");
      EXPECT_TRUE(bytes_in(cut / "run") == whole) << events;
    }
  }
  EXPECT_GT(resumed, 5);
}

}  // namespace
}  // namespace graphdrl
