#include "graphdrl/train/explorer_trainer.h"

#include <gtest/gtest.h>

#include <cmath>

#include "graphdrl/base/parallel.h"
#include "graphdrl/io/file.h"
#include "graphdrl/planners/exact.h"
#include "support.h"

namespace graphdrl {
namespace {

// Small enough to train in a second.
ExplorerOptions quick_options() {
  ExplorerOptions options;
  options.rounds = 4;
  options.largest = 5;
  options.walks = 24;
  options.updates = 6;
  options.batch_size = 8;
  options.replay_capacity = 50;  // less than four rounds draw
  options.teacher_width = 4;
  options.checkpoint_every = 1;
  return options;
}

void run(ExplorerTrainer& trainer, std::int64_t rounds) {
  ProgressDisplay display(stderr, "round", 0);
  std::int64_t asked = 0;
  trainer.run([&] { return ++asked >= rounds; }, display);
}

std::string train(const ExplorerOptions& options, const std::filesystem::path& path) {
  const auto trainer = ExplorerTrainer::start(options, RunDirectory(path));
  run(*trainer, options.rounds);
  return read_file(RunDirectory(path).policy());
}

TEST(ExplorerTrainer, EndsWithTheSameBytesInterruptedOrNotAndOnAnyNumberOfThreads) {
  const TemporaryFolder folder;
  for (const char* const teacher : {"search", "double_dqn"}) {
    ExplorerOptions options = quick_options();
    options.teacher = teacher;
    const std::string once = train(options, folder / (std::string(teacher) + "1"));
    set_threads(3);
    EXPECT_EQ(train(options, folder / (std::string(teacher) + "3")), once) << "threads";
    set_threads(1);
    const RunDirectory parts(folder / (std::string(teacher) + "parts"));
    run(*ExplorerTrainer::start(options, parts), 1);
    EXPECT_NE(read_file(parts.policy()), once);
    run(*ExplorerTrainer::resume(parts), 2);
    const auto rest = ExplorerTrainer::resume(parts);
    EXPECT_EQ(rest->progress().round, 3);
    run(*rest, 9);
    EXPECT_EQ(read_file(parts.policy()), once) << "resumed";
    options.seed = 2;
    EXPECT_NE(train(options, folder / (std::string(teacher) + "seed2")), once);
  }
}

TEST(ExplorerTrainer, RefusesDamagedCheckpoints) {
  const TemporaryFolder folder;
  const RunDirectory run_directory(folder / "run");
  run(*ExplorerTrainer::start(quick_options(), run_directory), 1);
  const std::string whole = read_file(run_directory.checkpoint());
  Rng rng(1);
  const auto resume = [&](const std::string& content) {
    write_file(run_directory.checkpoint(), content);
    ExplorerTrainer::resume(run_directory);
  };
  for (int i = 0; i < 20; ++i) {
    EXPECT_THROW(resume(whole.substr(0, rng.below(static_cast<std::uint32_t>(whole.size())))), Error);
  }
  for (int i = 0; i < 60; ++i) {
    std::string damaged = whole;
    damaged[rng.below(static_cast<std::uint32_t>(damaged.size()))] ^= static_cast<char>(1 + rng.below(255));
    try {
      resume(damaged);  // a changed weight is a weight like any other
    } catch (const Error&) {
    }
  }
  // One value of each kind that a lesson holds, set to what no lesson can have.
  const Safetensors file = Safetensors::parse(whole, "whole");
  const std::size_t data = whole.size() - file.entries().back().end;
  for (const std::string name : {"memory.position", "memory.scope", "memory.label_count", "memory.choice"}) {
    for (const Safetensors::Entry& entry : file.entries()) {
      if (entry.name != name) continue;
      std::string damaged = whole;
      for (int byte = 0; byte < 8; ++byte) damaged[data + entry.begin + byte] = '\x7f';
      EXPECT_THROW(resume(damaged), Error) << name;
    }
  }
}

TEST(Lessons, OfSmallWorldsAreWorthWhatExactSearchSays) {
  // A beam this wide drops nothing here.
  const LessonOptions options{.worlds = {{"obstacles", 4}, {"tree", 10, true}, {"erdos-renyi", 9, false, true}},
                              .teacher_width = 5000,
                              .lead = 0.5};
  Rng rng(1);
  const ExplorerParameters parameters(rng);
  int checked = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    for (const Lesson& lesson : draw_lessons(options, parameters, seed)) {
      ExplorerBatch batch;
      const auto found = lesson.append_to(batch);
      const std::vector<FirstVisit> visits(found.begin(), found.end());
      ASSERT_EQ(visits.size(), lesson.shortfall.size());
      for (std::size_t i = 0; i < visits.size(); ++i) {
        if (std::isnan(lesson.shortfall[i])) continue;
        Lesson after = lesson;
        visit(after, visits[i]);
        SearchStart start{.world = &after.at->world,
                          .position = after.position,
                          .visited = {},
                          .budget_left = std::max(0.0, after.spendable)};
        for (NodeId node = 0; node < after.at->world.graph().node_count(); ++node) {
          start.visited.push_back((after.visited[node / 64] >> (node % 64) & 1) != 0);
        }
        EXPECT_FLOAT_EQ(lesson.shortfall[i], static_cast<float>(batch.ceiling[0] - 1 - *exact_gain(start)));
        ++checked;
      }
    }
  }
  EXPECT_GT(checked, 300);
}

// Two states, of three and of two first visits.
ExplorerBatch two_states(const Graph& graph) {
  ExplorerBatch batch;
  batch.graphs.add(graph);
  batch.graphs.add(graph);
  batch.state = {0, 0, 0, 1, 1};
  batch.target = {0, 1, 2, 3, 4};
  return batch;
}

TEST(ExplorerLoss, HasTheGradientItSays) {
  const Graph graph = Graph::grid(1, 3);
  const ExplorerBatch batch = two_states(graph);
  const std::vector<float> label = {1, 2.5, kUnlabelled, -3, 4};
  std::vector<float> shortfall = {0.5, 3, 9, 2, 1};
  std::vector<float> grad(5);
  explorer_loss(batch, label, shortfall, 0.7, grad);
  std::vector<float> unused(5);
  for (std::size_t i = 0; i < shortfall.size(); ++i) {
    const float kept = shortfall[i];
    shortfall[i] = kept + 1e-3f;
    const double above = explorer_loss(batch, label, shortfall, 0.7, unused);
    shortfall[i] = kept - 1e-3f;
    const double slope = (above - explorer_loss(batch, label, shortfall, 0.7, unused)) / 2e-3;
    shortfall[i] = kept;
    EXPECT_NEAR(grad[i], slope, 1e-3) << i;
  }
  EXPECT_EQ(grad[2], 0);
}

TEST(ExplorerLoss, RanksByCrossEntropy) {
  const Graph graph = Graph::grid(1, 3);
  const ExplorerBatch batch = two_states(graph);
  std::vector<float> grad(5);
  const std::vector<float> label = {0, 0.5, kUnlabelled, kUnlabelled, kUnlabelled};
  const std::vector<float> shortfall = {0.5, 0, 0, 0, 0};
  // Odds of 1 and 1/e at a temperature of half a node, the wrong way round; a mean over two states.
  const double best = 1 / (1 + std::exp(-1));
  const double expected = -(best * std::log(1 - best) + (1 - best) * std::log(best)) / 2;
  const double without = explorer_loss(batch, label, shortfall, 0, grad);
  EXPECT_NEAR(explorer_loss(batch, label, shortfall, 1, grad) - without, expected, 1e-6);
}

TEST(ExplorerLoss, IsWorkedOutByHand) {
  const Graph graph = Graph::grid(1, 3);
  const ExplorerBatch batch = two_states(graph);
  std::vector<float> grad(5);
  // State 0: errors 1 and 1 at labels 4 and 5: values ½·½ (weighed half, four short), deviations 0. State 1: right.
  const std::vector<float> label = {4, 5, kUnlabelled, 0, 1};
  const std::vector<float> shortfall = {5, 6, 0, 0, 1};
  EXPECT_NEAR(explorer_loss(batch, label, shortfall, 0, grad), 0.25 / 2, 1e-6);
}

}  // namespace
}  // namespace graphdrl
