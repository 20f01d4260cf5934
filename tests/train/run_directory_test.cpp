#include "graphdrl/train/run_directory.h"

#include <gmock/gmock.h>

#include "failing_disk.h"
#include "graphdrl/base/note.h"
#include "graphdrl/train/finished_runs.h"
#include "train/training.h"

namespace graphdrl {
namespace {

using ::testing::HasSubstr;

// What was noted while this lives.
class Notes {
 public:
  Notes() {
    listen_to_notes([this](const std::string& text) { text_ += text + '\n'; });
  }
  ~Notes() { listen_to_notes({}); }
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

// A finished run of the paper's preset, and what its files hold.
class FinishedRunFiles : public ::testing::Test {
 protected:
  FinishedRunFiles() : run_(folder_ / "run") {
    train(*Trainer::start(short_paper(), run_));
    for (const auto& entry : std::filesystem::directory_iterator(run_.path())) {
      if (entry.path().filename().string().starts_with("events")) continue;
      content_[entry.path().filename().string()] = read_file(entry.path());
    }
  }

  void put_back() const {
    for (const auto& [name, content] : content_) write_file(run_.path() / name, content);
  }
  std::string now(const std::string& name) const { return read_file(run_.path() / name); }

  const TemporaryFolder folder_;
  const RunDirectory run_;
  std::map<std::string, std::string> content_;
};

TEST_F(FinishedRunFiles, AreAllNamedByTheRecord) {
  const RunState state = state_of(run_);
  EXPECT_TRUE(state.finished());
  EXPECT_EQ(state.record->progress.done, 4);
  EXPECT_EQ(state.record->progress.samples, kShortPaperSteps);
  std::set<std::string> named;
  for (const auto& [name, sum] : state.record->files) named.insert(name);
  EXPECT_EQ(named,
            (std::set<std::string>{"checkpoint.safetensors", "config.json", "metrics.jsonl", "policy.safetensors"}));
}

// Every one and two of the files, missing and damaged: it is known, said, and mended or refused; never a wrong end.
TEST_F(FinishedRunFiles, AreMendedFromWhatIsLeft) {
  std::vector<std::string> names;
  for (const auto& [name, content] : content_) names.push_back(name);
  ASSERT_EQ(names.size(), 6);
  for (std::size_t one = 0; one < names.size(); ++one) {
    for (std::size_t other = 0; other <= one; ++other) {
      for (const bool damaged : {false, true}) {
        put_back();
        for (const std::string& name : {names[one], names[other]}) {
          std::string content = content_[name];
          content[content.size() / 2] = static_cast<char>(content[content.size() / 2] ^ 4);
          std::filesystem::remove(run_.path() / name);
          if (damaged) write_file(run_.path() / name, content);
        }
        const std::string lost = names[one] + ' ' + names[other] + (damaged ? " damaged" : " missing");
        const bool only_previous = one == 0 && other == 0;
        EXPECT_EQ(state_of(run_).finished(), only_previous) << lost;
        const Notes notes;
        const std::string error = error_of([&] { train(*Trainer::resume(run_)); });
        const bool has_checkpoint = one != 1 || other != 0;
        EXPECT_EQ(error.empty(), has_checkpoint) << lost << error;
        if (!has_checkpoint) continue;
        EXPECT_EQ(notes.text().empty(), only_previous) << lost << notes.text();
        for (const char* const name : {"config.json", "metrics.jsonl", "policy.safetensors"}) {
          EXPECT_TRUE(now(name) == content_[name]) << lost << name;
        }
        EXPECT_TRUE(state_of(run_).finished()) << lost;
      }
    }
  }
}

TEST_F(FinishedRunFiles, AreReadBackWhole) {
  const std::string path = run_.path().string();
  EXPECT_EQ(read_finished_runs({path}).size(), 1);
  std::filesystem::remove(run_.policy());
  EXPECT_THAT(error_of([&] { read_finished_runs({path}); }), HasSubstr("policy.safetensors is missing"));
  std::filesystem::remove(run_.record());
  EXPECT_THAT(error_of([&] { read_finished_runs({path}); }), HasSubstr("run.json is missing"));
}

TEST_F(FinishedRunFiles, ShowEveryFlippedBit) {
  Rng rng(3);
  for (const auto& [name, content] : content_) {
    if (name == "checkpoint.previous.safetensors") continue;
    for (int i = 0; i < 40; ++i) {
      std::string flipped = content;
      const std::size_t at = rng.below(static_cast<std::uint32_t>(content.size()));
      flipped[at] = static_cast<char>(flipped[at] ^ (1 << rng.below(8)));
      write_file(run_.path() / name, flipped);
      EXPECT_FALSE(state_of(run_).finished()) << name << ' ' << at;
    }
    write_file(run_.path() / name, content);
  }
}

TEST_F(FinishedRunFiles, AreNotWrittenAgain) {
  const auto time = std::filesystem::last_write_time(run_.record());
  EXPECT_TRUE(train(*Trainer::resume(run_)));
  EXPECT_EQ(std::filesystem::last_write_time(run_.record()), time);
  for (const auto& [name, content] : content_) {
    std::filesystem::remove(run_.path() / name);
  }
  write_file(run_.policy(), content_["policy.safetensors"]);  // a finished policy alone
  EXPECT_THAT(error_of([&] { Trainer::start(short_paper(), run_); }), HasSubstr("holds a run already"));
  EXPECT_THAT(error_of([&] { Trainer::resume(run_); }), HasSubstr("no checkpoint"));
  EXPECT_TRUE(read_file(run_.policy()) == content_["policy.safetensors"]);
}

// A kill right after the configuration was written.
TEST_F(FinishedRunFiles, BeginAnewFromTheConfigurationAlone) {
  for (const auto& [name, content] : content_) {
    if (name != "config.json") std::filesystem::remove(run_.path() / name);
  }
  const Notes notes;
  EXPECT_TRUE(train(*Trainer::resume(run_)));
  EXPECT_THAT(notes.text(), HasSubstr("begins anew"));
  EXPECT_TRUE(now("policy.safetensors") == content_["policy.safetensors"]);
  EXPECT_TRUE(now("metrics.jsonl") == content_["metrics.jsonl"]);
}

// What others do to a run's files while it is trained.
TEST(RunFiles, AreUndoneWhatOthersDoToThem) {
  const TemporaryFolder folder;
  const RunDirectory run(folder / "run");
  const Bytes whole = train_in(folder / "whole", short_paper());
  const auto trainer = Trainer::start(short_paper(), run);
  const std::string config = read_file(run.config());
  trainer->run([] { return false; },
               [&](const TrainingNews& news) {
                 if (news.progress.done != 3) return;
                 write_file(run.config(), "{}");
                 std::filesystem::remove(run.metrics());
               });
  EXPECT_TRUE(bytes_of(run) == whole);
  EXPECT_EQ(read_file(run.config()), config);
  EXPECT_TRUE(state_of(run).finished());
}

TEST(RunLock, IsMissedBeforeTheNextSave) {
  const TemporaryFolder folder;
  const RunDirectory run(folder / "run");
  const auto trainer = Trainer::start(short_paper(), run);
  std::filesystem::remove(run.lock());
  const RunLock another(run);
  EXPECT_THROW(train(*trainer), RunLocked);
  EXPECT_EQ(Checkpoint::read(run.checkpoint()).progress().done, 0);
}

TEST(RunLock, KeepsOthersOut) {
  const TemporaryFolder folder;
  const RunDirectory run(folder / "run");
  const auto trainer = Trainer::start(short_paper(), run);
  EXPECT_THAT(error_of([&] { Trainer::resume(run); }),
              HasSubstr("another training is at work on this run: process " + std::to_string(getpid())));
  break_locks(folder.path());  // of the living, it breaks none
  EXPECT_THROW(Trainer::resume(run), RunLocked);
  EXPECT_TRUE(train(*trainer));
}

TEST(RunLock, SaysWhateverCallFails) {
  const TemporaryFolder folder;
  const RunDirectory run(folder.path());
  bool failed = true;
  for (int call = 0; failed; ++call) {
    bool refused = false;
    {
      const FailingDisk disk(call, ENOSPC);
      try {
        const RunLock lock(run);
      } catch (const MachineError&) {
        refused = true;
      }
      failed = disk.has_failed();
    }
    EXPECT_EQ(refused, failed) << call;
    EXPECT_EQ(error_of([&] { RunLock{run}; }), "") << call;  // what is left of it keeps nobody out
  }
}

// A trainer of another host is known by the time of the file alone.
TEST(RunLock, TakesSilenceOfAnotherHostForDeath) {
  const TemporaryFolder folder;
  const RunDirectory run(folder.path());
  write_file(run.lock(), "process 1 on elsewhere\n");
  EXPECT_THAT(error_of([&] { RunLock{run}; }), HasSubstr("process 1 on elsewhere: expected to wait 60 s"));
  EXPECT_THAT(error_of([&] { RunLock{run}; }), HasSubstr("elsewhere"));  // to ask is no sign of life
  std::filesystem::last_write_time(run.lock(),
                                   std::filesystem::file_time_type::clock::now() - std::chrono::seconds(61));
  EXPECT_EQ(error_of([&] { RunLock{run}; }), "");
  EXPECT_FALSE(std::filesystem::exists(run.lock()));
  write_file(run.lock(), "process 1");  // killed as it wrote
  EXPECT_EQ(error_of([&] { RunLock{run}; }), "");
  write_file(run.lock(), "process 1 on elsewhere\n");
  break_locks(folder.path());
  EXPECT_EQ(error_of([&] { RunLock{run}; }), "");
}

}  // namespace
}  // namespace graphdrl
