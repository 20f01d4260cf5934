#include "graphdrl/train/side_by_side.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <system_error>
#include <thread>

#include "graphdrl/base/error.h"
#include "graphdrl/base/parallel.h"

namespace graphdrl {

namespace {

// But for the maps: a folder may have been moved, and the checkpoint holds them.
void require_same_options(const PlannedRun& run) {
  TrainOptions found = read_config(run.directory.config());
  found.maps = run.options.maps;
  if (config_json(found) == config_json(run.options)) return;
  throw Error({.what = "the folder holds a run of other options", .where = run.directory.path().string()});
}

// The runs that differ in their seeds alone, in the order of the first of each kind.
std::vector<std::vector<int>> runs_alike(const std::vector<PlannedRun>& runs) {
  std::vector<std::vector<int>> kinds;
  std::map<std::string, std::size_t> known;
  for (int run = 0; run < std::ssize(runs); ++run) {
    TrainOptions options = runs[run].options;
    options.seed = 0;
    const auto [kind, is_new] = known.try_emplace(config_json(options).dump(), kinds.size());
    if (is_new) kinds.emplace_back();
    kinds[kind->second].push_back(run);
  }
  return kinds;
}

}  // namespace

SideBySide::SideBySide(std::vector<PlannedRun> runs, MakePaperLearner make_learner, MakePaperLearnerGroup make_group)
    : runs_(std::move(runs)), make_learner_(std::move(make_learner)), make_group_(std::move(make_group)) {
  for (const PlannedRun& run : runs_) {
    const bool there = std::filesystem::exists(run.directory.checkpoint());
    if (there) require_same_options(run);
    const auto trainer = there ? Trainer::resume(run.directory, make_learner_)
                               : Trainer::start(run.options, run.directory, make_learner_);
    progress_.push_back(trainer->progress());
    units_ = trainer->units();
  }
}

std::int64_t SideBySide::sum(std::int64_t TrainingProgress::*member) const {
  std::int64_t all = 0;
  for (const TrainingProgress& progress : progress_) all += progress.*member;
  return all;
}

bool SideBySide::run(const std::function<bool()>& stop, const std::function<void(const SideBySideNews&)>& tell) {
  const auto start = std::chrono::steady_clock::now();
  const auto trained = [&](const TrainingProgress& progress) { return progress.done == units_.count; };
  const std::int64_t samples_before = sum(&TrainingProgress::samples);
  std::mutex mutex;
  const Train train = [&](int i, const MakePaperLearner& make_learner) {
    const auto index = static_cast<std::size_t>(i);
    if (trained(progress_[index]) || stop()) return;
    const RunDirectory& directory = runs_[index].directory;
    try {
      Trainer::resume(directory, make_learner)->run(stop, [&](const TrainingNews& news) {
        const std::lock_guard lock(mutex);
        progress_[index] = news.progress;
        const double session_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        const std::int64_t samples = sum(&TrainingProgress::samples) - samples_before;
        tell({.runs_done = static_cast<int>(std::count_if(progress_.begin(), progress_.end(), trained)),
              .units_done = sum(&TrainingProgress::done),
              .units = units_.count * std::ssize(runs_),
              .samples_per_s = static_cast<double>(samples) / std::max(session_s, 1e-9)});
      });
    } catch (const Error&) {
      throw;
    } catch (const std::exception& error) {
      throw std::runtime_error(fmt::format("{}: {}", directory.path().string(), error.what()));
    }
  };
  if (make_group_) {
    for (const std::vector<int>& alike : runs_alike(runs_)) run_together(alike, train);
  } else {
    parallel_for(static_cast<int>(runs_.size()), [&](int i) { train(i, make_learner_); });
  }
  return std::all_of(progress_.begin(), progress_.end(), trained);
}

// Each on a thread of its own, their learners as one.
void SideBySide::run_together(const std::vector<int>& runs, const Train& train) const {
  const int count = static_cast<int>(runs.size());
  const auto group = make_group_(runs_[runs.front()].options.device, count);
  std::vector<std::exception_ptr> failures(runs.size());
  std::vector<std::thread> threads;
  threads.reserve(runs.size());
  const auto fail = [&](int i) {
    failures[static_cast<std::size_t>(i)] = std::current_exception();
    group->leave(i);
  };
  for (int i = 0; i < count; ++i) {
    const auto train_one = [&, i] {
      try {
        train(runs[i], group->learner_of(i));
      } catch (...) {
        return fail(i);
      }
      group->leave(i);
    };
    try {
      threads.emplace_back(train_one);
    } catch (const std::system_error&) {  // too many threads
      fail(i);
    }
  }
  for (std::thread& thread : threads) thread.join();
  for (const std::exception_ptr& failure : failures) {
    if (failure) std::rethrow_exception(failure);
  }
}

}  // namespace graphdrl
