// What a power cut leaves of a training. A double of the file layer writes down what happens to files; then a folder is
// made as the disk may have it after a cut at any moment: what was not synced is there, or in part, or not at all.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/stat.h>

#include <fstream>
#include <map>
#include <optional>

#include "graphdrl/io/file_system.h"
#include "graphdrl/train/seed_runs.h"
#include "train/training.h"

namespace graphdrl {
namespace {

namespace fs = std::filesystem;

class LoggedDisk final : public FileSystem {
 public:
  LoggedDisk() { set_file_system(this); }
  ~LoggedDisk() override { set_file_system(nullptr); }

  int open(const char* path, int flags, mode_t mode) override {
    const bool is_new = !fs::exists(path);
    const int descriptor = FileSystem::open(path, flags, mode);
    if (descriptor < 0) return descriptor;
    if ((flags & O_DIRECTORY) != 0) {
      folders_[descriptor] = path;
      return descriptor;
    }
    if (is_new) {
      names_[path] = files_++;
      log_.push_back({.kind = Kind::kName, .path = path, .file = names_[path]});
    }
    open_[descriptor] = names_.at(path);
    return descriptor;
  }
  ssize_t write(int descriptor, const void* data, std::size_t size) override {
    log_.push_back({.kind = Kind::kWrite,
                    .file = open_.at(descriptor),
                    .data = std::string(static_cast<const char*>(data), size)});
    return FileSystem::write(descriptor, data, size);
  }
  int fsync(int descriptor) override {
    const auto folder = folders_.find(descriptor);
    if (folder == folders_.end()) {
      log_.push_back({.kind = Kind::kSync, .file = open_.at(descriptor)});
    } else {
      log_.push_back({.kind = Kind::kSyncFolder, .path = folder->second});
    }
    return 0;
  }
  int close(int descriptor) override {
    open_.erase(descriptor);
    folders_.erase(descriptor);
    return FileSystem::close(descriptor);
  }
  int rename(const char* from, const char* to) override {
    if (!names_.contains(from)) return FileSystem::rename(from, to);
    log_.push_back({.kind = Kind::kRename, .path = to, .from = from, .file = names_[from]});
    names_[to] = names_[from];
    names_.erase(from);
    return FileSystem::rename(from, to);
  }
  int unlink(const char* path) override {
    log_.push_back({.kind = Kind::kUnlink, .path = path});
    names_.erase(path);
    return FileSystem::unlink(path);
  }
  int mkdir(const char* path, mode_t mode) override {
    log_.push_back({.kind = Kind::kFolder, .path = path});
    return FileSystem::mkdir(path, mode);
  }

  std::size_t events() const { return log_.size(); }

  // Makes `root` anew, as a cut after so many events may leave it.
  void cut(std::size_t events, const fs::path& root, Rng& rng) const {
    std::map<int, std::string> synced;
    std::map<int, std::string> written;
    std::map<std::string, std::optional<int>> names;  // of folders, no file
    std::vector<const Event*> unsynced;               // changes of folders, in order
    const auto apply = [&](const Event& event) {
      if (event.kind == Kind::kRename) names.erase(event.from);
      if (event.kind == Kind::kUnlink) {
        names.erase(event.path);
      } else {
        names[event.path] = event.kind == Kind::kFolder ? std::nullopt : std::optional(event.file);
      }
    };
    for (std::size_t i = 0; i < events; ++i) {
      const Event& event = log_[i];
      if (event.kind == Kind::kWrite) {
        written[event.file] += event.data;
      } else if (event.kind == Kind::kSync) {
        synced[event.file] = written[event.file];
      } else if (event.kind == Kind::kSyncFolder) {
        std::erase_if(unsynced, [&](const Event* change) {
          const fs::path folder = fs::path(change->path).parent_path();
          if (folder != fs::path(event.path)) return false;
          apply(*change);
          return true;
        });
      } else {
        unsynced.push_back(&event);
      }
    }
    for (const Event* const change : unsynced) {  // each may have reached the disk, or not
      if (rng.below(2) == 0) apply(*change);
    }
    fs::remove_all(root);
    fs::create_directories(root.parent_path());
    for (const auto& [path, file] : names) {
      if (!file) {
        fs::create_directories(path);
      } else if (fs::is_directory(fs::path(path).parent_path())) {
        const std::string& all = written[*file];
        const auto unsynced_size = static_cast<std::uint32_t>(all.size() - synced[*file].size());
        std::string content = all.substr(0, all.size() - rng.below(unsynced_size + 1));
        // Blocks that were not written yet.
        if (unsynced_size > 0 && rng.below(2) == 0) content.resize(content.size() + rng.below(4), '\0');
        std::ofstream(path, std::ios::binary) << content;
      }
    }
  }

 private:
  enum class Kind { kName, kWrite, kSync, kSyncFolder, kRename, kUnlink, kFolder };
  struct Event {
    Kind kind;
    std::string path = {};
    std::string from = {};
    int file = 0;
    std::string data = {};
  };

  std::vector<Event> log_;
  std::map<std::string, int> names_;
  std::map<int, int> open_;
  std::map<int, std::string> folders_;
  int files_ = 0;
};

// A training whose saves are known: after each, how many events there had been, and how far it was.
struct SavedAt {
  std::size_t events;
  std::int64_t done;
};

TEST(PowerCut, TakesNothingThatWasSaved) {
  TrainOptions options = short_paper();
  options.checkpoint_every = 1;
  options.episodes = 3;
  const TemporaryFolder folder;
  const Bytes whole = train_in(folder / "whole", options);
  const RunDirectory run(folder / "cut/run");
  std::vector<SavedAt> saved;
  const auto disk = std::make_unique<LoggedDisk>();
  {
    const auto trainer = Trainer::start(options, run);
    saved.push_back({disk->events(), 0});
    // News come before the save of their unit.
    EXPECT_TRUE(trainer->run([] { return false; },
                             [&](const TrainingNews& news) {
                               saved.push_back({disk->events(), news.progress.done - 1});
                             }));
    saved.push_back({disk->events(), trainer->progress().done});
  }
  set_file_system(nullptr);
  Rng rng(1);
  int resumed = 0;
  for (std::size_t events = 0; events <= disk->events(); ++events) {
    for (int variant = 0; variant < 2; ++variant) {
      disk->cut(events, run.path(), rng);
      std::int64_t done = -1;
      for (const SavedAt& save : saved) {
        if (save.events <= events) done = save.done;
      }
      if (done < 0 && !run.holds_a_run()) continue;
      const auto trainer = Trainer::resume(run);
      EXPECT_GE(trainer->progress().done, done) << events;
      if (rng.below(8) != 0 && events != disk->events()) continue;  // to train takes longer
      ++resumed;
      EXPECT_TRUE(train(*trainer));
      EXPECT_TRUE(bytes_of(run) == whole) << events;
    }
  }
  EXPECT_GT(resumed, 5);
}

}  // namespace
}  // namespace graphdrl
