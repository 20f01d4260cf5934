#include "graphdrl/train/checkpoint.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "graphdrl/base/error.h"
#include "graphdrl/base/note.h"
#include "graphdrl/io/json.h"
#include "graphdrl/train/options.h"

namespace graphdrl {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kLayoutKey = "layout";
constexpr const char* kPresetKey = "preset";
constexpr const char* kProgressKey = "progress";
constexpr const char* kRandomState = "random.state";
constexpr const char* kFirstMoment = "adam.exp_avg";
constexpr const char* kSecondMoment = "adam.exp_avg_sq";
constexpr const char* kAdamSteps = "adam.step";

int layout_of(const std::string& preset) {
  return preset == kExplorerPreset ? kExplorerLayout : kPaperLayout;
}

[[noreturn]] void refuse_number(const Checkpoint& checkpoint, const char* key) {
  checkpoint.fail("not a checkpoint: no number " + in_quotes(key));
}

}  // namespace

CheckpointWriter::CheckpointWriter(const std::string& preset)
    : metadata_{{kLayoutKey, std::to_string(layout_of(preset))}, {kPresetKey, preset}} {}

void CheckpointWriter::add_json(const std::string& key, const Json& json) {
  metadata_[key] = json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

void CheckpointWriter::add(const TrainingProgress& progress) {
  add_json(kProgressKey, {{"done", progress.done}, {"samples", progress.samples}, {"elapsed_s", progress.elapsed_s}});
}

void CheckpointWriter::add(const Rng& rng) {
  add(kRandomState, std::vector<std::uint64_t>(rng.state().begin(), rng.state().end()));
}

void CheckpointWriter::add(AdamState adam) {
  add(kFirstMoment, std::move(adam.exp_avg));
  add(kSecondMoment, std::move(adam.exp_avg_sq));
  add(kAdamSteps, std::vector<std::int64_t>{adam.steps});
}

void CheckpointWriter::add(const std::string& prefix, ParameterBuffer parameters) {
  const auto kept = std::make_shared<const ParameterBuffer>(std::move(parameters));
  for (TensorView& view : kept->views(prefix)) add(std::move(view));
  kept_.push_back(kept);
}

Checkpoint Checkpoint::read(const std::filesystem::path& path) {
  Checkpoint checkpoint(Safetensors::read(path));
  if (checkpoint.metadata(kProgressKey).empty()) checkpoint.fail("not a checkpoint");
  const int expected = layout_of(checkpoint.metadata(kPresetKey));
  const std::string& layout = checkpoint.metadata(kLayoutKey);
  if (layout == std::to_string(expected)) {
    checkpoint.file_.require_checksum();
  } else if (layout == std::to_string(expected - 1)) {
    note(path.string() + ": no checksum: whether the checkpoint is undamaged cannot be told");
  } else {
    throw Error({.what = "a checkpoint of another version of graphdrl, which cannot be gone on with: begin anew",
                 .expected = fmt::format("layout {}", expected),
                 .got = layout.empty() ? "an older one" : in_quotes(layout),
                 .where = path.string()});
  }
  return checkpoint;
}

void Checkpoint::require_preset(const std::string& preset) const {
  if (const std::string& found = metadata(kPresetKey); found != preset) {
    throw Error({.what = "a checkpoint of another preset than config.json's",
                 .expected = preset,
                 .got = in_quotes(found),
                 .where = source()});
  }
}

const std::string& Checkpoint::metadata(const char* key) const {
  static const std::string none;
  const auto found = file_.metadata().find(key);
  return found == file_.metadata().end() ? none : found->second;
}

void Checkpoint::fail(const std::string& what, const std::string& expected) const {
  throw Error({.what = what, .expected = expected, .where = source()});
}

std::int64_t Checkpoint::size_of(const std::string& name) const {
  const Shape& shape = file_.shape_of(name);
  if (shape.size() != 1) fail("tensor " + in_quotes(name) + " has the wrong shape", "one dimension");
  return shape[0];
}

Json Checkpoint::json(const std::string& key) const {
  const auto text = file_.metadata().find(key);
  if (text == file_.metadata().end()) fail("not a whole checkpoint", in_quotes(key) + " in its metadata");
  require_shallow_json(text->second, source());
  return Json::parse(text->second, nullptr, /*allow_exceptions=*/false);
}

void Checkpoint::read_number(const Json& json, const char* key, std::int64_t& value) const {
  const auto found = json.find(key);
  if (found == json.end() || !found->is_number_unsigned() || found->get<std::uint64_t>() > INT64_MAX) {
    refuse_number(*this, key);
  }
  found->get_to(value);
}

void Checkpoint::read_number(const Json& json, const char* key, double& value) const {
  const auto found = json.find(key);
  if (found == json.end() || !found->is_number()) refuse_number(*this, key);
  found->get_to(value);
}

bool Checkpoint::holds_options() const {
  return file_.has_checksum();
}

TrainingProgress Checkpoint::progress() const {
  const Json found = json(kProgressKey);
  TrainingProgress progress;
  read_number(found, "done", progress.done);
  read_number(found, "samples", progress.samples);
  read_number(found, "elapsed_s", progress.elapsed_s);
  return progress;
}

Rng Checkpoint::rng() const {
  const auto words = get<std::uint64_t>(kRandomState, {4});
  Rng::State state{};
  std::copy(words.begin(), words.end(), state.begin());
  if (state == Rng::State{}) fail("the random state is damaged");
  return Rng(state);
}

AdamState Checkpoint::adam(std::size_t trainable_count) const {
  const Shape shape = {static_cast<std::int64_t>(trainable_count)};
  AdamState state;
  state.exp_avg = get<float>(kFirstMoment, shape);
  state.exp_avg_sq = get<float>(kSecondMoment, shape);
  state.steps = get<std::int64_t>(kAdamSteps, {1}).front();
  const bool first_good =
      std::all_of(state.exp_avg.begin(), state.exp_avg.end(), [](float value) { return std::isfinite(value); });
  const bool second_good = std::all_of(state.exp_avg_sq.begin(), state.exp_avg_sq.end(),
                                       [](float value) { return std::isfinite(value) && value >= 0; });
  if (!first_good || !second_good || state.steps < 0) fail("Adam's state is damaged");
  return state;
}

}  // namespace graphdrl
