// What a training leaves behind: config.json, metrics.jsonl, TensorBoard event files, policy.safetensors and
// checkpoint.safetensors.
#pragma once

#include <filesystem>

namespace graphdrl {

class RunDirectory {
 public:
  explicit RunDirectory(std::filesystem::path path) : path_(std::move(path)) {}

  // Throws Error where the folder holds a run already, or cannot be written.
  void create() const;
  // Throws Error where the folder holds a run already.
  void require_new() const;

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path config() const { return path_ / "config.json"; }
  std::filesystem::path metrics() const { return path_ / "metrics.jsonl"; }
  std::filesystem::path policy() const { return path_ / "policy.safetensors"; }
  std::filesystem::path checkpoint() const { return path_ / "checkpoint.safetensors"; }

 private:
  std::filesystem::path path_;
};

}  // namespace graphdrl
