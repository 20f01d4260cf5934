#include "graphdrl/train/side_by_side.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <mutex>

#include "graphdrl/base/error.h"
#include "graphdrl/base/parallel.h"

namespace graphdrl {

SideBySide::SideBySide(std::vector<PlannedRun> runs, MakePaperLearner make_learner)
    : runs_(std::move(runs)), make_learner_(std::move(make_learner)) {
  for (const PlannedRun& run : runs_) {
    const bool there = std::filesystem::exists(run.directory.checkpoint());
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
  const auto train = [&](int i) {
    const auto index = static_cast<std::size_t>(i);
    if (trained(progress_[index]) || stop()) return;
    const RunDirectory& directory = runs_[index].directory;
    try {
      Trainer::resume(directory, make_learner_)->run(stop, [&](const TrainingNews& news) {
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
  // Another device has one training at a time.
  const std::string& device = runs_.front().options.device;
  const int count = static_cast<int>(runs_.size());
  if (device.empty() || device == "cpu") {
    parallel_for(count, train);
  } else {
    for (int i = 0; i < count; ++i) train(i);
  }
  return std::all_of(progress_.begin(), progress_.end(), trained);
}

}  // namespace graphdrl
