// A double of the file layer for tests of power cuts. It writes down what happens to files; then a folder is made as
// the disk may have it after a cut at any moment: what was not synced is there, or in part, or not at all.
#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "graphdrl/base/random.h"
#include "graphdrl/io/file_system.h"

namespace graphdrl {

// In the place of the machine's file layer while it lives, or until another one is. It leaves out syncs, which take
// long.
class UnsyncedDisk : public FileSystem {
 public:
  UnsyncedDisk() { set_file_system(this); }
  ~UnsyncedDisk() override { set_file_system(nullptr); }

  int fsync(int /*descriptor*/) override { return 0; }
};

// Of one thread.
class LoggedDisk final : public UnsyncedDisk {
 public:
  int open(const char* path, int flags, mode_t mode) override {
    const bool is_new = !std::filesystem::exists(path);
    const int descriptor = FileSystem::open(path, flags, mode);
    if (descriptor < 0) return descriptor;
    if ((flags & O_DIRECTORY) != 0) {
      folders_[descriptor] = path;
      return descriptor;
    }
    if (is_new) {
      names_[path] = static_cast<int>(contents_.size());
      contents_.emplace_back();
      log_.push_back({.kind = Kind::kName, .path = path, .file = names_[path]});
    }
    open_[descriptor] = names_.at(path);
    return descriptor;
  }
  ssize_t write(int descriptor, const void* data, std::size_t size) override {
    const int file = open_.at(descriptor);
    contents_[file].append(static_cast<const char*>(data), size);
    log_.push_back({.kind = Kind::kWrite, .file = file, .size = contents_[file].size()});
    return FileSystem::write(descriptor, data, size);
  }
  int ftruncate(int descriptor, off_t size) override {
    EXPECT_EQ(static_cast<std::size_t>(size), contents_[open_.at(descriptor)].size()) << "no cut knows shorter files";
    return FileSystem::ftruncate(descriptor, size);
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

  // Makes `root` anew, as a cut after so many events may leave it. REQUIRES: all files and folders of the events lie
  // below it.
  void cut(std::size_t events, const std::filesystem::path& root, Rng& rng) const {
    std::vector<std::size_t> synced(contents_.size());  // bytes
    std::vector<std::size_t> written(contents_.size());
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
        written[event.file] = event.size;
      } else if (event.kind == Kind::kSync) {
        synced[event.file] = written[event.file];
      } else if (event.kind == Kind::kSyncFolder) {
        std::erase_if(unsynced, [&](const Event* change) {
          const std::filesystem::path folder = std::filesystem::path(change->path).parent_path();
          if (folder != std::filesystem::path(event.path)) return false;
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
    std::filesystem::remove_all(root);
    std::filesystem::create_directory(root);
    for (const auto& [path, file] : names) {  // folders before what is in them
      if (!std::filesystem::is_directory(std::filesystem::path(path).parent_path())) continue;
      if (!file) {
        std::filesystem::create_directory(path);
      } else {
        const auto unsynced_size = static_cast<std::uint32_t>(written[*file] - synced[*file]);
        std::string content = contents_[*file].substr(0, written[*file] - rng.below(unsynced_size + 1));
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
    std::size_t size = 0;  // of the file, after a write
  };

  std::vector<Event> log_;
  std::vector<std::string> contents_;  // by file
  std::map<std::string, int> names_;
  std::map<int, int> open_;
  std::map<int, std::string> folders_;
};

}  // namespace graphdrl
