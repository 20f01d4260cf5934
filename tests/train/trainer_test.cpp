#include "graphdrl/train/trainer.h"

#include <gmock/gmock.h>

#include "graphdrl/base/parallel.h"
#include "graphdrl/io/file.h"
#include "support.h"

namespace graphdrl {
namespace {

using ::testing::HasSubstr;

// A stream that shows nothing.
struct Silence {
  std::FILE* file = std::fopen("/dev/null", "w");
  ~Silence() { std::fclose(file); }
};

TrainOptions short_training() {
  TrainOptions options;
  options.maps = {"paper:a", "paper:h"};
  options.episodes = 6;
  options.budget = "12";
  options.batch_size = 8;
  options.replay_capacity = 40;  // wraps around
  options.checkpoint_every = 2;
  return options;
}

void train(Trainer& trainer) {
  const Silence silence;
  ProgressDisplay display(silence.file, "episode", 0);
  EXPECT_TRUE(trainer.run([] { return false; }, display));
}

struct Bytes {
  std::string policy;
  std::string metrics;
};

Bytes bytes_of(const RunDirectory& run) {
  return {read_file(run.policy()), read_file(run.metrics())};
}

TEST(Trainer, GivesTheSameBytesForAnyNumberOfThreads) {
  const TemporaryFolder folder;
  std::vector<Bytes> results;
  for (const int count : {1, 2, 4, 1}) {
    set_threads(count);
    const RunDirectory run(folder / ("run" + std::to_string(results.size())));
    train(*Trainer::start(short_training(), run));
    results.push_back(bytes_of(run));
  }
  set_threads(1);
  for (const Bytes& result : results) {
    EXPECT_TRUE(result.policy == results[0].policy);
    EXPECT_EQ(result.metrics, results[0].metrics);
  }
  TrainOptions other = short_training();
  other.seed = 2;
  const RunDirectory run(folder / "other");
  train(*Trainer::start(other, run));
  EXPECT_FALSE(bytes_of(run).policy == results[0].policy);
}

// Stops a training after every so many steps, wherever that is, and resumes it each time.
TEST(Trainer, EndsWithTheSameBytesHoweverOftenItIsInterrupted) {
  const TemporaryFolder folder;
  TrainOptions options = short_training();
  options.algorithm = "double_dqn";
  const RunDirectory whole(folder / "whole");
  train(*Trainer::start(options, whole));

  const RunDirectory pieces(folder / "pieces");
  const Silence silence;
  Trainer::start(options, pieces);
  bool finished = false;
  int sessions = 0;
  for (; !finished; ++sessions) {
    const auto trainer = Trainer::resume(pieces);
    ProgressDisplay display(silence.file, "episode", 0);
    finished = trainer->run([steps = 0]() mutable { return steps++ == 5; }, display);
  }
  EXPECT_GT(sessions, 10);
  EXPECT_TRUE(bytes_of(pieces).policy == bytes_of(whole).policy);
  EXPECT_EQ(bytes_of(pieces).metrics, bytes_of(whole).metrics);
}

TEST(Trainer, RefusesADirectoryThatHoldsARunAndDamagedOnes) {
  const TemporaryFolder folder;
  const RunDirectory run(folder / "run");
  TrainOptions options = short_training();
  Trainer::start(options, run);
  EXPECT_THAT(error_of([&] { Trainer::start(options, run); }), HasSubstr("holds a run already"));
  EXPECT_EQ(error_of([&] { Trainer::resume(run); }), "");

  const std::string checkpoint = read_file(run.checkpoint());
  write_file(run.checkpoint(), checkpoint.substr(0, checkpoint.size() / 2));
  EXPECT_THAT(error_of([&] { Trainer::resume(run); }), HasSubstr("checkpoint.safetensors"));
  write_file(run.checkpoint(), checkpoint);
  Rng rng(9);
  for (int i = 0; i < 60; ++i) {  // damage is an Error, or a run that can go on
    std::string damaged = checkpoint;
    const std::size_t header = i % 2 == 0 ? 4'000 : damaged.size();
    for (int n = 0; n < 4; ++n)
      damaged[rng.below(static_cast<std::uint32_t>(header))] = static_cast<char>(rng.below(256));
    write_file(run.checkpoint(), damaged);
    error_of([&] { Trainer::resume(run); });
  }
  write_file(run.checkpoint(), checkpoint);
  const std::string config = read_file(run.config());
  write_file(run.config(), "{}");
  EXPECT_THAT(error_of([&] { Trainer::resume(run); }), HasSubstr("missing key 'preset'"));
  write_file(run.config(), config.substr(0, config.size() / 2));
  EXPECT_THAT(error_of([&] { Trainer::resume(run); }), HasSubstr("config.json"));
  EXPECT_NE(error_of([&] { Trainer::resume(RunDirectory(folder / "nothing")); }), "");

  write_file(folder / "file", "");
  EXPECT_NE(error_of([&] { Trainer::start(options, RunDirectory(folder / "file/run")); }), "");
}

// A crash leaves an older checkpoint beside newer metrics.
TEST(Trainer, GoesOnFromAnOlderCheckpoint) {
  const TemporaryFolder folder;
  TrainOptions options = short_training();
  options.episodes = 24;
  const RunDirectory run(folder / "run");
  const auto trainer = Trainer::start(options, run);
  const Silence silence;
  ProgressDisplay display(silence.file, "episode", 0);
  trainer->run([steps = 0]() mutable { return steps++ == 70; }, display);
  const std::string old_checkpoint = read_file(run.checkpoint());
  train(*Trainer::resume(run));
  const Bytes whole = bytes_of(run);
  write_file(run.checkpoint(), old_checkpoint);
  train(*Trainer::resume(run));
  EXPECT_TRUE(bytes_of(run).policy == whole.policy);
  EXPECT_EQ(bytes_of(run).metrics, whole.metrics);
}

TEST(Trainer, RemembersItsMaps) {
  const TemporaryFolder folder;
  TrainOptions options = short_training();
  write_file(folder / "map.txt", "....\n.#..\n");
  options.maps = {(folder / "map.txt").string()};
  options.start = "1,2";
  const RunDirectory run(folder / "run");
  Trainer::start(options, run);
  write_file(folder / "map.txt", "gone");
  train(*Trainer::resume(run));
}

TEST(TrainOptions, AreChecked) {
  const auto error_for = [](auto change) {
    TrainOptions options;
    change(options);
    return error_of([&] { validate(options); });
  };
  EXPECT_EQ(error_for([](TrainOptions&) {}), "");
  EXPECT_THAT(error_for([](TrainOptions& o) { o.preset = "best"; }), HasSubstr("--preset"));
  EXPECT_THAT(error_for([](TrainOptions& o) { o.reward = "gold"; }), HasSubstr("visit_penalty or coverage_gain"));
  EXPECT_THAT(error_for([](TrainOptions& o) { o.episodes = 0; }), HasSubstr("--episodes"));
  EXPECT_THAT(error_for([](TrainOptions& o) { o.discount = 1.5; }), HasSubstr("expected 0 to 1, got 1.5"));
  EXPECT_THAT(error_for([](TrainOptions& o) { o.replay_capacity = 32; }), HasSubstr("--replay-capacity"));
  EXPECT_THAT(error_for([](TrainOptions& o) { o.learning_rate = NAN; }), HasSubstr("--learning-rate"));
  EXPECT_THAT(error_for([](TrainOptions& o) { o.budget = "-3"; }), HasSubstr("bad budget"));
  EXPECT_THAT(error_for([](TrainOptions& o) {
                o.reward = "coverage_gain";
                o.punish_blocked_by_visits = true;
              }),
              HasSubstr("--punish-blocked-by-visits"));
}

TEST(TrainOptions, SurviveTheConfigurationFile) {
  const TemporaryFolder folder;
  TrainOptions options = short_training();
  options.end_at_full_coverage = true;
  options.learning_rate = 0.1 + 0.2;
  write_config(folder / "c", options);
  write_config(folder / "again", read_config(folder / "c"));
  EXPECT_EQ(read_file(folder / "c"), read_file(folder / "again"));
  EXPECT_EQ(read_config(folder / "c").learning_rate, options.learning_rate);
}

}  // namespace
}  // namespace graphdrl
