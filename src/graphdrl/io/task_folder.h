// Many tasks, each of which leaves a result of its own in a folder: whatever dies, the same command does what is
// missing.
#pragma once

#include <filesystem>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "graphdrl/base/error.h"
#include "graphdrl/base/ranks.h"

namespace graphdrl {

// One of several processes that know nothing of each other: every count-th task is its own.
struct TaskShare {
  int index = 0;  // from 0
  int count = 1;

  bool has(int task) const { return task % count == index; }
  bool all() const { return index == 0 && count == 1; }
  static TaskShare none() { return {.index = 1, .count = 1}; }  // nothing leaves 1 when divided by 1
  bool is_none() const { return index == count; }
};

// Who does tasks together.
struct TaskWorkers {
  Ranks& ranks = one_rank();
  TaskShare share = {};
};

// "3/20": the third of twenty, index 2. Throws Error, naming --task, on anything else.
TaskShare parse_task_share(const std::string& text);

// A task that failed.
struct TaskFailure {
  int times = 0;
  std::string what;  // the last time
};

// FOLDER/failed/NAME.json remembers tasks that failed. Tasks that failed three times are left out until it is removed.
// An empty path remembers nothing.
class TaskFolder {
 public:
  static constexpr int kMostFailures = 3;

  explicit TaskFolder(std::filesystem::path path) : path_(std::move(path)) {}

  const std::filesystem::path& path() const { return path_; }
  // Nothing where the task has not failed. Throws Error where that cannot be read.
  std::optional<TaskFailure> failure_of(const std::string& name) const;
  bool is_left_out(const std::string& name) const;
  int left_out_count() const;

  struct Task {
    std::string name;
    bool done;  // by anybody, before
  };
  // Does the tasks of a share that are not done, on all threads of all ranks, until `stop` says so; gives false then.
  // work(task) gives false, too, where `stop` ended it. Those left out are noted. Where a task throws, it is noted and
  // remembered, and the others go on; then this throws what the first one threw. What the machine refuses ends all
  // tasks, and is nobody's failure; nor is Busy. Collective.
  bool run(const std::vector<Task>& tasks, const TaskWorkers& workers, const std::function<bool()>& stop,
           const std::function<bool(int task)>& work) const;

 private:
  std::filesystem::path file_of(const std::string& name) const;
  std::string remember(const std::string& name, const std::exception& error) const;
  void forget(const std::string& name) const;

  std::filesystem::path path_;
};

// Makes a folder that of one origin, such as options and checksums of files: notes it in a file there. `require_free`
// is called first where the file is not there yet. Throws Error where it names another origin, and unless all ranks see
// it. Collective: the first rank writes.
void claim_folder(
    const std::filesystem::path& file, const nlohmann::ordered_json& origin, Ranks& ranks,
    const std::function<void()>& require_free = [] {});

// Computes what tasks give on all threads of all ranks, and gives it on all of them, by task. Where there is a folder
// each result is kept, as FOLDER/NAME.json, and computed once; what was left out is null.
// Nothing where tasks of other shares are lacking. Throws as TaskFolder::run(). Collective.
std::optional<std::vector<nlohmann::ordered_json>> results_of(
    const std::vector<std::string>& names, const TaskFolder* folder, const TaskWorkers& workers,
    const std::function<nlohmann::ordered_json(int task)>& compute);

}  // namespace graphdrl
