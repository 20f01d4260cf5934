// checkpoint.safetensors: all that a training goes on from. Every preset has the same names for the same things:
//   online.*, target.*                          the networks' tensors, under PyTorch's names; target only where used
//   adam.exp_avg, adam.exp_avg_sq, adam.step    Adam's state, under PyTorch's names
//   random.state [4]                            the random numbers
//   replay.*                                    what is remembered to learn from
//   metrics                                     the lines of metrics.jsonl
// and, as metadata, `layout`, `preset`, `options` (config.json) and `progress` {done, samples, elapsed_s}. A recipe
// adds what else it needs.
#pragma once

#include <filesystem>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "graphdrl/base/random.h"
#include "graphdrl/nn/parameters.h"
#include "graphdrl/train/adam.h"
#include "graphdrl/train/run_directory.h"

namespace graphdrl {

// Grows with every change that makes a preset's older checkpoints unreadable, or that older programs cannot read.
// Since these there is a checksum, and the checkpoint holds the options and the metrics.
inline constexpr int kPaperLayout = 3;
inline constexpr int kExplorerLayout = 4;

class CheckpointWriter {
 public:
  explicit CheckpointWriter(const std::string& preset);

  // An array whose values stay the caller's until write().
  void add(TensorView view) { tensors_.push_back(std::move(view)); }
  // An array to keep until then.
  template <typename T>
  void add(const std::string& name, Shape shape, std::vector<T> values) {
    const auto kept = std::make_shared<std::vector<T>>(std::move(values));
    add(TensorView(name, std::move(shape), std::span<const T>(*kept)));
    kept_.push_back(kept);
  }
  // Likewise, of one dimension.
  template <typename T>
  void add(const std::string& name, std::vector<T> values) {
    const auto size = std::ssize(values);
    add(name, Shape{size}, std::move(values));
  }
  // Metadata.
  void add_json(const std::string& key, const nlohmann::ordered_json& json);

  void add(const TrainingProgress& progress);
  void add(const Rng& rng);
  void add(AdamState adam);
  // The tensors under their names, each after the prefix: "online." or "target.".
  void add(const std::string& prefix, ParameterBuffer parameters);

  // The file's content.
  std::string content() const { return format_safetensors(tensors_, metadata_); }

 private:
  std::vector<TensorView> tensors_;
  std::vector<std::shared_ptr<const void>> kept_;
  Metadata metadata_;
};

// A checkpoint, read. All that read from it throw Error, naming the file, where something is missing or cannot be.
class Checkpoint {
 public:
  // Throws Error also where the layout is another. The layout before this one is read, with a note: it has no checksum.
  static Checkpoint read(const std::filesystem::path& path);
  // Throws Error where the checkpoint is of another preset than the run's configuration.
  void require_preset(const std::string& preset) const;

  const std::string& source() const { return file_.source(); }
  template <typename T>
  std::vector<T> get(const std::string& name, const Shape& shape) const {
    return file_.get<T>(name, shape);
  }
  // Of one dimension, as long as it is.
  template <typename T>
  std::vector<T> get(const std::string& name) const {
    return file_.get<T>(name, {size_of(name)});
  }
  std::int64_t size_of(const std::string& name) const;
  // Metadata. Gives a discarded value for what is no JSON.
  bool has_json(const std::string& key) const { return file_.metadata().contains(key); }
  nlohmann::ordered_json json(const std::string& key) const;

  // Whether it holds the options and the metrics.
  bool holds_options() const;
  TrainingProgress progress() const;
  Rng rng() const;
  template <typename Parameters>
  Parameters parameters(const std::string& prefix) const {
    return Parameters(file_, prefix);
  }
  AdamState adam(std::size_t trainable_count) const;

  // The number under a key of metadata that is read. Throws Error where there is none, or, of an integer, one below 0.
  void read_number(const nlohmann::ordered_json& json, const char* key, std::int64_t& value) const;
  void read_number(const nlohmann::ordered_json& json, const char* key, double& value) const;

  [[noreturn]] void fail(const std::string& what, const std::string& expected = "") const;

 private:
  explicit Checkpoint(Safetensors file) : file_(std::move(file)) {}

  const std::string& metadata(const char* key) const;  // empty where there is none

  Safetensors file_;
};

}  // namespace graphdrl
