// checkpoint.safetensors: all that a training goes on from. Every preset has the same names for the same things:
//   online.*, target.*                          the two networks' tensors, under PyTorch's names
//   adam.exp_avg, adam.exp_avg_sq, adam.step    Adam's state, under PyTorch's names
//   random.state [4]                            the random numbers
//   replay.*                                    what is remembered to learn from
// and, as metadata, `layout`, `preset` and `progress` {done, samples, elapsed_s}. A recipe adds what else it needs.
#pragma once

#include <filesystem>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "graphdrl/base/random.h"
#include "graphdrl/io/safetensors.h"
#include "graphdrl/train/adam.h"

namespace graphdrl {

// Grows with every change that makes older checkpoints unreadable. The layouts before 2 had no number.
inline constexpr int kCheckpointLayout = 2;

// Where a training stands.
struct TrainingProgress {
  std::int64_t done = 0;     // episodes or rounds
  std::int64_t samples = 0;  // steps or states, of all of them
  double elapsed_s = 0;      // of all sessions
};

// All that a recipe learns.
template <typename Parameters>
struct LearnedState {
  Parameters online;
  Parameters target;
  AdamState adam;
};

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
  template <typename Parameters>
  void add(LearnedState<Parameters> state) {
    const auto kept = std::make_shared<const LearnedState<Parameters>>(std::move(state));
    for (TensorView& view : kept->online.views("online.")) add(std::move(view));
    for (TensorView& view : kept->target.views("target.")) add(std::move(view));
    add_views(kept->adam);
    kept_.push_back(kept);
  }

  void write(const std::filesystem::path& path) const { write_safetensors(path, tensors_, metadata_); }

 private:
  void add_views(const AdamState& adam);

  std::vector<TensorView> tensors_;
  std::vector<std::shared_ptr<const void>> kept_;
  Metadata metadata_;
};

// A checkpoint, read. All that read from it throw Error, naming the file, where something is missing or cannot be.
class Checkpoint {
 public:
  // Throws Error also where the layout or the preset is another.
  static Checkpoint read(const std::filesystem::path& path, const std::string& preset);

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
  nlohmann::ordered_json json(const std::string& key) const;

  TrainingProgress progress() const;
  Rng rng() const;
  template <typename Parameters>
  LearnedState<Parameters> learned(std::size_t trainable_count) const {
    return {.online = Parameters::from_file(file_, "online."),
            .target = Parameters::from_file(file_, "target."),
            .adam = adam(trainable_count)};
  }

  [[noreturn]] void fail(const std::string& what, const std::string& expected = "") const;

 private:
  explicit Checkpoint(Safetensors file) : file_(std::move(file)) {}

  AdamState adam(std::size_t count) const;

  Safetensors file_;
};

// The number under a key. Throws Error where there is none, or one below 0 that counts things.
template <typename T>  // std::int64_t or double
void read_number(const nlohmann::ordered_json& json, const char* key, const Checkpoint& checkpoint, T& value);

}  // namespace graphdrl
