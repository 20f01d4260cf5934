#include "graphdrl/train/side_by_side.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <system_error>
#include <thread>

#include "graphdrl/base/bytes.h"
#include "graphdrl/base/error.h"

namespace graphdrl {

namespace {

// But for the maps: a folder may have been moved, and the checkpoint holds them.
void require_same_options(const PlannedRun& run, TrainOptions found) {
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
    const auto [kind, is_new] = known.try_emplace(
        config_json(options).dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace), kinds.size());
    if (is_new) kinds.emplace_back();
    kinds[kind->second].push_back(run);
  }
  return kinds;
}

// Each run on a thread of its own, with a source of its own, which goes with its thread.
void run_together(const std::vector<int>& runs, std::vector<std::unique_ptr<LearnerSource>> sources,
                  const std::function<bool(int run, const LearnerSource&)>& train) {
  std::vector<std::exception_ptr> failures(runs.size());
  std::vector<std::thread> threads;
  threads.reserve(runs.size());
  for (std::size_t i = 0; i < runs.size(); ++i) {
    try {
      threads.emplace_back([&, i, source = std::move(sources[i])] {
        try {
          train(runs[i], *source);
        } catch (...) {
          failures[i] = std::current_exception();
        }
      });
    } catch (const std::system_error&) {  // too many threads
      failures[i] = std::current_exception();
    }
  }
  for (std::thread& thread : threads) thread.join();
  for (const std::exception_ptr& failure : failures) {
    if (failure) std::rethrow_exception(failure);
  }
}

}  // namespace

SideBySide::SideBySide(std::vector<PlannedRun> runs, std::filesystem::path folder)
    : runs_(std::move(runs)),
      folder_(std::move(folder)),
      progress_(runs_.size()),
      finished_(runs_.size()),
      units_(units_of(runs_.front().options)) {
  for (std::size_t i = 0; i < runs_.size(); ++i) {
    const RunState state = state_of(runs_[i].directory);
    if (state.record) progress_[i] = state.record->progress;
    finished_[i] = state.finished();
    if (state.finished()) require_same_options(runs_[i], read_config(runs_[i].directory.config()));
  }
}

std::int64_t SideBySide::sum(std::int64_t TrainingProgress::*member) const {
  std::int64_t all = 0;
  for (const TrainingProgress& progress : progress_) all += progress.*member;
  return all;
}

bool SideBySide::run(const std::function<bool()>& stop, const std::function<void(const SideBySideNews&)>& tell,
                     const LearnerSource& learners, const TaskWorkers& workers) {
  const auto start = std::chrono::steady_clock::now();
  const auto trained = [&](const TrainingProgress& progress) { return progress.done == units_.count; };
  const std::int64_t samples_before = sum(&TrainingProgress::samples);
  std::mutex mutex;
  const auto train_one = [&](int run, const LearnerSource& source) {
    TrainingProgress& progress = progress_[static_cast<std::size_t>(run)];
    if (finished_[run] || stop()) return finished_[run] != 0;
    finished_[run] = train(run, source, stop, [&](const TrainingProgress& now) {
      const std::lock_guard lock(mutex);
      progress = now;
      const double session_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
      const std::int64_t samples = sum(&TrainingProgress::samples) - samples_before;
      tell({.runs_done = static_cast<int>(std::count_if(progress_.begin(), progress_.end(), trained)),
            .units_done = sum(&TrainingProgress::done),
            .units = units_.count * std::ssize(runs_),
            .samples_per_s = static_cast<double>(samples) / std::max(session_s, 1e-9)});
    });
    return finished_[run] != 0;
  };
  for (std::vector<int> alike : runs_alike(runs_)) {
    std::erase_if(alike, [&](int run) { return !workers.share.has(run) || is_left_out(run); });
    if (alike.empty()) continue;
    auto sources = learners.make_together(runs_[alike.front()].options.device, static_cast<int>(alike.size()));
    if (!sources.empty()) run_together(alike, std::move(sources), train_one);
  }
  std::vector<TaskFolder::Task> tasks;
  for (std::size_t run = 0; run < runs_.size(); ++run) {
    tasks.push_back({.name = name_of(run), .done = finished_[run] != 0});
  }
  const bool done = folder_.run(tasks, workers, stop, [&](int run) { return train_one(run, learners); });
  hear_of_others(workers.ranks);
  return done;
}

std::string SideBySide::name_of(std::size_t run) const {
  return runs_[run].directory.path().lexically_relative(folder_.path()).string();
}

// Where the runs stand that other ranks have trained.
void SideBySide::hear_of_others(Ranks& ranks) {
  if (ranks.alone()) return;
  ByteWriter own;
  own.put_all<TrainingProgress>(progress_);
  own.put_all<char>(finished_);
  for (const std::string& of_rank : ranks.gather(own.bytes())) {
    ByteReader heard(of_rank);
    const auto progress = heard.get_all<TrainingProgress>();
    const auto finished = heard.get_all<char>();
    for (std::size_t run = 0; run < runs_.size(); ++run) {
      if (progress[run].samples > progress_[run].samples) progress_[run] = progress[run];
      if (finished[run] != 0) finished_[run] = 1;
    }
  }
}

// Begins a run or goes on with it.
bool SideBySide::train(int run, const LearnerSource& learners, const std::function<bool()>& stop,
                       const std::function<void(const TrainingProgress&)>& tell) const {
  const PlannedRun& planned = runs_[static_cast<std::size_t>(run)];
  try {
    const auto trainer = planned.directory.holds_a_run() ? Trainer::resume(planned.directory, learners)
                                                         : Trainer::start(planned.options, planned.directory, learners);
    require_same_options(planned, trainer->options());
    return trainer->run(stop, [&](const TrainingNews& news) { tell(news.progress); });
  } catch (const Error&) {
    throw;
  } catch (const std::bad_alloc&) {  // of the machine, as the next
    throw;
  } catch (const std::system_error&) {
    throw;
  } catch (const std::exception& error) {
    throw std::runtime_error(fmt::format("{}: {}", planned.directory.path().string(), error.what()));
  }
}

}  // namespace graphdrl
