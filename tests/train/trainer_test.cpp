#include "graphdrl/train/trainer.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <set>

#include "graphdrl/base/parallel.h"
#include "train/training.h"

namespace graphdrl {
namespace {

using ::testing::HasSubstr;

// What every preset must do.
class AnyTraining : public ::testing::TestWithParam<TrainOptions> {};

TrainOptions with_double_dqn(TrainOptions options) {
  options.algorithm = "double_dqn";
  return options;
}

INSTANTIATE_TEST_SUITE_P(, AnyTraining,
                         ::testing::Values(short_paper(), with_double_dqn(short_paper()), short_explorer(),
                                           short_online()),
                         [](const auto& test) {
                           const TrainOptions& options = test.param;
                           return options.preset == kPaperPreset ? "paper_" + options.algorithm
                                                                 : "explorer_" + options.reveal;
                         });

TEST_P(AnyTraining, GivesTheSameBytesForAnyNumberOfThreads) {
  const TemporaryFolder folder;
  const Bytes once = train_in(folder / "1", GetParam());
  for (const int count : {2, 4}) {
    set_threads(count);
    EXPECT_TRUE(train_in(folder / std::to_string(count), GetParam()) == once) << count;
  }
  set_threads(1);
  TrainOptions other = GetParam();
  other.seed = 2;
  EXPECT_FALSE(train_in(folder / "other", other).policy == once.policy);
}

// Stops a training whenever it has asked so often, wherever that is, and resumes it each time. An explorer's round asks
// 31 times; if its 24 walks are not all drawn it begins anew.
TEST_P(AnyTraining, EndsWithTheSameBytesHoweverOftenItIsInterrupted) {
  const TemporaryFolder folder;
  const Bytes whole = train_in(folder / "whole", GetParam());
  const bool paper = GetParam().preset == kPaperPreset;
  for (const int questions : paper ? std::vector{1, 5} : std::vector{26, 40}) {
    const RunDirectory pieces(folder / ("pieces" + std::to_string(questions)));
    Trainer::start(GetParam(), pieces);
    int sessions = 1;
    while (!train(*Trainer::resume(pieces), [asked = 0, questions]() mutable { return asked++ == questions; })) {
      ++sessions;
    }
    EXPECT_GT(sessions, paper ? kShortPaperSteps / (questions + 1) : 3);
    EXPECT_TRUE(bytes_of(pieces) == whole) << questions;
  }
}

// A crash leaves an older checkpoint beside newer metrics.
TEST_P(AnyTraining, GoesOnFromAnOlderCheckpoint) {
  const TemporaryFolder folder;
  TrainOptions options = GetParam();
  options.episodes *= 4;  // more than one line of metrics
  const RunDirectory run(folder / "run");
  constexpr std::int64_t questions = 70;
  train(*Trainer::start(options, run), [&, asked = 0]() mutable { return asked++ == questions; });
  const std::string old_checkpoint = read_file(run.checkpoint());
  train(*Trainer::resume(run));
  const Bytes whole = bytes_of(run);
  write_file(run.checkpoint(), old_checkpoint);
  train(*Trainer::resume(run));
  EXPECT_TRUE(bytes_of(run) == whole);
}

// Learners whose losses are no numbers from a step on, unless they learn slowly enough.
class WildLearners final : public LearnerSource {
 public:
  explicit WildLearners(double fastest) : fastest_(fastest) {}
  std::unique_ptr<PaperLearner> make(const std::string& device, const PaperLearnerOptions& options,
                                     Rng& rng) const override {
    rates.push_back(options.learning_rate);
    auto learner = LearnerSource::make(device, options, rng);
    if (options.learning_rate <= fastest_) return learner;
    return std::make_unique<Wild>(std::move(learner));
  }

  mutable std::vector<double> rates;

 private:
  class Wild final : public PaperLearner {
   public:
    explicit Wild(std::unique_ptr<PaperLearner> tame) : tame_(std::move(tame)) {}
    void q_values(const GraphBatch& graphs, std::span<const float> features, std::span<float> q) override {
      tame_->q_values(graphs, features, q);
    }
    void learn(const PaperMinibatch& minibatch, Rng& rng) override {
      tame_->learn(minibatch, rng);
      ++steps_;
    }
    std::vector<double> take_losses() override {
      std::vector<double> losses = tame_->take_losses();
      if (!losses.empty() && steps_ > 15) losses.back() = NAN;
      return losses;
    }
    PaperState state() const override { return tame_->state(); }
    void set_state(const PaperState& state) override { tame_->set_state(state); }

   private:
    std::unique_ptr<PaperLearner> tame_;
    int steps_ = 0;
  };

  double fastest_;
};

TEST(Trainer, StopsWhereALossIsNotFinite) {
  const TemporaryFolder folder;
  const RunDirectory run(folder / "run");
  const WildLearners learners(0);
  const auto trainer = Trainer::start(short_paper(), run, learners);
  // Eight transitions fill a batch; the sixteenth learning step is the first one that goes wrong.
  EXPECT_THAT(error_of([&] { train(*trainer); }),
              HasSubstr("the loss is nan at step 24; all weights are finite; the last good checkpoint: " +
                        run.checkpoint().string() + ", of episode 2"));
  EXPECT_EQ(Checkpoint::read(run.checkpoint()).progress().done, 2);
}

// The program that has the device locks the run itself.
TEST(Trainer, AsksForItsDeviceBeforeItLocks) {
  class Prepared final : public LearnerSource {
   public:
    explicit Prepared(const RunDirectory& run) : run_(run) {}
    void prepare(const std::string& device) const override {
      EXPECT_FALSE(std::filesystem::exists(run_.lock()));
      devices.push_back(device);
    }
    mutable std::vector<std::string> devices;

   private:
    const RunDirectory& run_;
  };
  const TemporaryFolder folder;
  const RunDirectory run(folder / "run");
  Trainer::start(short_paper(), run);
  const Prepared learners(run);
  Trainer::resume(run, learners);
  std::filesystem::remove(run.checkpoint());  // the configuration says it too
  std::filesystem::remove(run.policy());
  std::filesystem::remove(run.record());
  Trainer::resume(run, learners);
  EXPECT_EQ(learners.devices, (std::vector<std::string>{"cpu", "cpu"}));
}

TEST(Trainer, GoesBackAndLearnsMoreSlowly) {
  const TemporaryFolder folder;
  TrainOptions options = short_paper();
  options.on_nan = kRollback;
  const RunDirectory run(folder / "run");
  const WildLearners learners(options.learning_rate / 4);
  EXPECT_TRUE(train(*Trainer::start(options, run, learners)));
  const std::vector<double> halved = {1e-3, 5e-4, 2.5e-4};
  EXPECT_EQ(learners.rates, halved);
  EXPECT_TRUE(state_of(run).finished());
  // What was resumed after that learns as slowly.
  const WildLearners again(0);
  Trainer::resume(run, again);
  EXPECT_EQ(again.rates, std::vector<double>{2.5e-4});

  const RunDirectory other(folder / "other");
  EXPECT_THAT(error_of([&] { train(*Trainer::start(options, other, WildLearners(0))); }),
              HasSubstr("it was halved 3 times"));
}

TEST_P(AnyTraining, LeavesTheSameKindOfDirectory) {
  const TemporaryFolder folder;
  const RunDirectory run(folder / "run");
  train(*Trainer::start(GetParam(), run));
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(run.path())) {
    const std::string name = entry.path().filename().string();
    names.insert(name.substr(0, name.find(".tfevents.")));
  }
  EXPECT_EQ(names, (std::set<std::string>{"checkpoint.previous.safetensors", "checkpoint.safetensors", "config.json",
                                          "events.out", "metrics.jsonl", "policy.safetensors", "run.json"}));
  const Safetensors file = Safetensors::read(run.checkpoint());
  for (const char* const name : {"adam.exp_avg", "adam.exp_avg_sq", "adam.step", "random.state", "replay.next"}) {
    EXPECT_EQ(error_of([&] { file.shape_of(name); }), "");
  }
  EXPECT_EQ(file.metadata().at("preset"), GetParam().preset);
  EXPECT_EQ(file.metadata().at("layout"), GetParam().preset == kPaperPreset ? "3" : "4");
  EXPECT_THAT(file.metadata().at("progress"), HasSubstr("\"samples\""));
}

TEST_P(AnyTraining, RefusesADirectoryThatHoldsARunAndNone) {
  const TemporaryFolder folder;
  const RunDirectory run(folder / "run");
  train(*Trainer::start(GetParam(), run), [asked = 0]() mutable { return asked++ == 1; });
  EXPECT_THAT(error_of([&] { Trainer::start(GetParam(), run); }), HasSubstr("holds a run already"));
  EXPECT_EQ(error_of([&] { Trainer::resume(run); }), "");
  EXPECT_NE(error_of([&] { Trainer::resume(RunDirectory(folder / "nothing")); }), "");
  EXPECT_FALSE(std::filesystem::exists(folder / "nothing"));
  write_file(folder / "file", "");
  EXPECT_NE(error_of([&] { Trainer::start(GetParam(), RunDirectory(folder / "file/run")); }), "");
}

TEST_P(AnyTraining, RefusesAdamsStateThatNoTrainingHas) {
  const TemporaryFolder folder;
  const RunDirectory run(folder / "run");
  Trainer::start(GetParam(), run);
  const std::string whole = read_file(run.checkpoint());
  const auto error_with = [&](const std::string& content) {
    write_file(run.checkpoint(), with_checksum(content));
    return error_of([&] { Trainer::resume(run); });
  };
  constexpr float kInfinite = std::numeric_limits<float>::infinity();
  for (const float value : {NAN, kInfinite, -kInfinite}) {
    EXPECT_THAT(error_with(with_element(whole, "adam.exp_avg", 7, value)), HasSubstr("Adam's state is damaged"));
  }
  for (const float value : {NAN, kInfinite, -1e-9f}) {
    EXPECT_THAT(error_with(with_element(whole, "adam.exp_avg_sq", 7, value)), HasSubstr("Adam's state is damaged"));
  }
  EXPECT_THAT(error_with(with_element<std::int64_t>(whole, "adam.step", 0, -1)), HasSubstr("Adam's state is damaged"));
  EXPECT_EQ(error_with(with_element(whole, "adam.exp_avg", 7, -1.0f)), "");
}

}  // namespace
}  // namespace graphdrl
