// What a training leaves behind: config.json, metrics.jsonl, TensorBoard event files, policy.safetensors,
// checkpoint.safetensors, the checkpoint before it, and run.json, which says what counts.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace graphdrl {

// Where a training stands.
struct TrainingProgress {
  std::int64_t done = 0;     // episodes or rounds
  std::int64_t samples = 0;  // steps or states, of all of them
  double elapsed_s = 0;      // of all sessions
};

class RunDirectory {
 public:
  explicit RunDirectory(std::filesystem::path path) : path_(std::move(path)) {}

  // Whether any file of a run is there.
  bool holds_a_run() const;
  // Throws Error where the folder holds a run already.
  void require_new() const;

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path config() const { return path_ / "config.json"; }
  std::filesystem::path metrics() const { return path_ / "metrics.jsonl"; }
  std::filesystem::path policy() const { return path_ / "policy.safetensors"; }
  std::filesystem::path checkpoint() const { return path_ / "checkpoint.safetensors"; }
  std::filesystem::path previous_checkpoint() const { return path_ / "checkpoint.previous.safetensors"; }
  std::filesystem::path record() const { return path_ / "run.json"; }
  std::filesystem::path lock() const { return path_ / "run.lock"; }

 private:
  std::filesystem::path path_;
};

struct FileSum {
  std::uint64_t bytes = 0;
  std::string sum;  // checksum()

  static FileSum of(std::string_view content);
  friend bool operator==(const FileSum&, const FileSum&) = default;
};

// run.json: where a run stands. It is written last, and names the other files with their sizes and checksums: a run is
// finished where it says so and they are as it says, and nowhere else.
struct RunRecord {
  bool finished = false;
  TrainingProgress progress;
  std::map<std::string, FileSum> files;  // by their names

  void add(const std::filesystem::path& file, std::string_view content);
};
// Throws Error.
void write_record(const RunDirectory& run, const RunRecord& record);

// A run as it is found.
struct RunState {
  std::optional<RunRecord> record;
  std::vector<std::string> faults;  // "policy.safetensors is missing"

  bool finished() const { return record && record->finished && faults.empty(); }
  bool is_whole(const std::filesystem::path& file) const;  // there, and as the record says
};
// Reads run.json and every file that it names. Where run.json is missing or damaged, that is the one fault. Throws
// MachineError where a file cannot be read just now, nothing for what is missing or damaged.
RunState state_of(const RunDirectory& run);

}  // namespace graphdrl
