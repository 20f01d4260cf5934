#include "graphdrl/io/task_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <charconv>
#include <limits>
#include <mutex>
#include <new>
#include <nlohmann/json.hpp>
#include <system_error>

#include "graphdrl/base/bytes.h"
#include "graphdrl/base/note.h"
#include "graphdrl/base/parallel.h"
#include "graphdrl/io/checked_json.h"
#include "graphdrl/io/file.h"

namespace graphdrl {
namespace {

constexpr int kMostShares = 1'000'000;
constexpr const char* kTimesKey = "times";
constexpr const char* kErrorKey = "error";

constexpr int kMachine = -1;  // instead of a task: what the machine refused comes first

// What went wrong.
class Failures {
 public:
  // The exception under way, of a task.
  void offer(int task) {
    const std::lock_guard lock(mutex_);
    if (failure_ && task_ < task) return;
    failure_ = std::current_exception();
    task_ = task;
  }
  void say(const std::string& text) {
    const std::lock_guard lock(mutex_);
    said_.put_text(text);
  }

  // Notes what was said on any rank. Collective.
  void tell(Ranks& ranks) const {
    for (const std::string& of_rank : ranks.gather(said_.bytes())) {
      for (ByteReader heard(of_rank); !heard.at_end();) {
        const std::string text = heard.get_text();
        if (ranks.is_first()) note(text);
      }
    }
  }
  // Throws the first in the order of tasks on its rank, RankLost on the others. Collective.
  void rethrow_first(Ranks& ranks) const {
    constexpr int kNone = std::numeric_limits<int>::max();
    ByteWriter own;
    own.put(failure_ ? task_ : kNone);
    std::vector<int> tasks;
    for (const std::string& of_rank : ranks.gather(own.bytes())) tasks.push_back(ByteReader(of_rank).get<int>());
    const auto first = std::ranges::min_element(tasks);
    if (*first == kNone) return;
    if (first - tasks.begin() == ranks.rank()) std::rethrow_exception(failure_);
    throw RankLost("a task of another rank failed");
  }

 private:
  std::mutex mutex_;
  std::exception_ptr failure_;
  int task_ = 0;
  ByteWriter said_;
};

}  // namespace

TaskShare parse_task_share(const std::string& text) {
  TaskShare share;
  const char* const end = text.data() + text.size();
  const auto [slash, error] = std::from_chars(text.data(), end, share.index);
  std::from_chars_result rest{slash, std::errc::invalid_argument};
  if (error == std::errc() && slash != end && *slash == '/') rest = std::from_chars(slash + 1, end, share.count);
  if (rest.ec != std::errc() || rest.ptr != end || share.index < 1 || share.index > share.count ||
      share.count > kMostShares) {
    throw Error({.what = "bad share of the tasks",
                 .expected = "I/N, as 3/20 for the third of twenty",
                 .got = in_quotes(text),
                 .where = "--task"});
  }
  --share.index;
  return share;
}

std::filesystem::path TaskFolder::file_of(const std::string& name) const {
  return path_ / "failed" / (name + ".json");
}

std::optional<TaskFailure> TaskFolder::failure_of(const std::string& name) const {
  const std::filesystem::path file = file_of(name);
  std::error_code error;
  if (path_.empty() || !std::filesystem::exists(file, error)) return std::nullopt;
  const nlohmann::ordered_json json = read_checked_json(file);
  try {
    return TaskFailure{.times = json.at(kTimesKey), .what = json.at(kErrorKey)};
  } catch (const nlohmann::json::exception&) {
    throw Error({.what = "does not say how often a task failed", .where = file.string()});
  }
}

bool TaskFolder::is_left_out(const std::string& name) const {
  return failure_of(name).value_or(TaskFailure()).times >= kMostFailures;
}

int TaskFolder::left_out_count() const {
  int count = 0;
  std::error_code error;
  const std::filesystem::path failed = path_ / "failed";
  if (path_.empty() || !std::filesystem::exists(failed, error)) return 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(failed, error)) {
    if (entry.path().extension() != ".json") continue;
    count += is_left_out(entry.path().lexically_relative(failed).replace_extension().string());
  }
  return count;
}

// Gives what is to be said.
std::string TaskFolder::remember(const std::string& name, const std::exception& error) const {
  const TaskFailure failure{.times = failure_of(name).value_or(TaskFailure()).times + 1, .what = error.what()};
  prepare_folder(file_of(name).parent_path());
  write_checked_json(file_of(name), {{kTimesKey, failure.times}, {kErrorKey, failure.what}});
  return fmt::format("{} failed, {} of {} times: {}", name, failure.times, kMostFailures, failure.what);
}

void TaskFolder::forget(const std::string& name) const {
  std::error_code none;
  if (!path_.empty()) std::filesystem::remove(file_of(name), none);
}

bool TaskFolder::run(const std::vector<Task>& tasks, const TaskWorkers& workers, const std::function<bool()>& stop,
                     const std::function<bool(int task)>& work) const {
  Ranks& ranks = workers.ranks;
  std::vector<int> to_do;
  for (int task = 0; task < std::ssize(tasks); ++task) {
    const bool own = workers.share.has(task);
    if (tasks[task].done || !(own || workers.share.is_none())) continue;
    const std::optional<TaskFailure> failure = failure_of(tasks[task].name);
    if (failure && failure->times >= kMostFailures) {
      if (!ranks.is_first()) continue;
      note(fmt::format("{} failed {} times and is left out: {}; to try it again: remove {}", tasks[task].name,
                       failure->times, failure->what, file_of(tasks[task].name).string()));
    } else if (own) {
      to_do.push_back(task);
    }
  }
  ByteWriter same;
  same.put_all<int>(to_do);
  ranks.require_same("files in " + path_.string(), same.bytes());
  Failures failures;
  std::atomic<bool> stopped = false;
  {
    const auto queue = ranks.hand_out(static_cast<int>(to_do.size()));
    const auto end_all = [&] {
      failures.offer(kMachine);
      queue->close();
    };
    parallel_for(threads(), [&](int) {
      while (const auto next = queue->next()) {
        const int task = to_do[*next];
        try {
          if (!stop() && work(task)) {
            forget(tasks[task].name);
            continue;
          }
          stopped = true;
          queue->close();
        } catch (const MachineError&) {
          end_all();
        } catch (const std::bad_alloc&) {
          end_all();
        } catch (const std::system_error&) {
          end_all();
        } catch (const Busy&) {
          failures.offer(task);
        } catch (const std::exception& error) {
          failures.offer(task);
          if (!path_.empty()) failures.say(remember(tasks[task].name, error));
        }
      }
    });
  }
  failures.tell(ranks);
  failures.rethrow_first(ranks);
  return !ranks.any(stopped);
}

void claim_folder(const std::filesystem::path& file, const nlohmann::ordered_json& origin, Ranks& ranks,
                  const std::function<void()>& require_free) {
  const std::filesystem::path folder = file.parent_path();
  const auto is_claimed = [&] {
    std::error_code error;
    return std::filesystem::exists(file, error);
  };
  ranks.on_first([&] {
    if (!is_claimed()) {
      try {
        require_free();
        prepare_folder(folder);
        return write_checked_json(file, origin);
      } catch (const MachineError&) {
        throw;
      } catch (const Error&) {
        if (!is_claimed()) throw;  // else another process has begun in the meantime
      }
    }
    if (read_checked_json(file) == origin) return;
    throw Error({.what = "the folder holds results of other options or files",
                 .expected = "a new folder, or the command that it was begun with (train and tune: or --resume)",
                 .where = folder.string()});
  });
  ranks.require_same("files in " + folder.string(), is_claimed() ? "seen" : "");
}

std::optional<std::vector<nlohmann::ordered_json>> results_of(
    const std::vector<std::string>& names, const TaskFolder* folder, const TaskWorkers& workers,
    const std::function<nlohmann::ordered_json(int task)>& compute) {
  using Result = nlohmann::ordered_json;
  constexpr const char* kResultKey = "result";
  std::vector<Result> results(names.size());
  const TaskFolder nowhere("");
  const auto file_of = [&](std::size_t task) { return folder->path() / (names[task] + ".json"); };
  std::vector<TaskFolder::Task> tasks;
  for (std::size_t task = 0; task < names.size(); ++task) {
    std::error_code error;
    tasks.push_back({.name = names[task], .done = folder != nullptr && std::filesystem::exists(file_of(task), error)});
  }
  if (folder != nullptr) prepare_folder(folder->path());
  std::mutex mutex;
  ByteWriter own;
  const auto never = [] { return false; };
  (folder == nullptr ? nowhere : *folder).run(tasks, workers, never, [&](int task) {
    const Result result = compute(task);
    if (folder != nullptr) write_checked_json(file_of(task), {{kResultKey, result}});
    const std::lock_guard lock(mutex);
    own.put(task);
    own.put_text(result.dump());
    return true;
  });
  std::vector<char> is_here(names.size());
  for (const std::string& of_rank : workers.ranks.gather(own.bytes())) {
    for (ByteReader heard(of_rank); !heard.at_end();) {
      const int task = heard.get<int>();
      results[task] = Result::parse(heard.get_text());
      is_here[task] = 1;
    }
  }
  for (std::size_t task = 0; task < tasks.size(); ++task) {
    if (is_here[task] != 0) continue;
    std::error_code error;
    if (std::filesystem::exists(file_of(task), error)) {
      results[task] = read_checked_json(file_of(task))[kResultKey];
    } else if (!folder->is_left_out(names[task])) {
      return std::nullopt;
    }
  }
  return results;
}

}  // namespace graphdrl
