#include "graphdrl/train/checkpoint.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "graphdrl/base/error.h"
#include "graphdrl/io/json.h"

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

}  // namespace

CheckpointWriter::CheckpointWriter(const std::string& preset)
    : metadata_{{kLayoutKey, std::to_string(kCheckpointLayout)}, {kPresetKey, preset}} {}

void CheckpointWriter::add_json(const std::string& key, const Json& json) {
  metadata_[key] = json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

void CheckpointWriter::add(const TrainingProgress& progress) {
  add_json(kProgressKey, {{"done", progress.done}, {"samples", progress.samples}, {"elapsed_s", progress.elapsed_s}});
}

void CheckpointWriter::add(const Rng& rng) {
  add(kRandomState, std::vector<std::uint64_t>(rng.state().begin(), rng.state().end()));
}

void CheckpointWriter::add_views(const AdamState& adam) {
  add(TensorView(kFirstMoment, {std::ssize(adam.exp_avg)}, std::span(adam.exp_avg)));
  add(TensorView(kSecondMoment, {std::ssize(adam.exp_avg_sq)}, std::span(adam.exp_avg_sq)));
  add(kAdamSteps, std::vector<std::int64_t>{adam.steps});
}

Checkpoint Checkpoint::read(const std::filesystem::path& path, const std::string& preset) {
  Checkpoint checkpoint(Safetensors::read(path));
  const Metadata& metadata = checkpoint.file_.metadata();
  const auto value = [&](const char* key) {
    const auto found = metadata.find(key);
    return found == metadata.end() ? std::string() : found->second;
  };
  if (!metadata.contains(kProgressKey)) checkpoint.fail("not a checkpoint");
  if (const std::string layout = value(kLayoutKey); layout != std::to_string(kCheckpointLayout)) {
    throw Error({.what = "a checkpoint of another version of graphdrl, which cannot be gone on with: begin anew",
                 .expected = fmt::format("layout {}", kCheckpointLayout),
                 .got = layout.empty() ? "an older one" : in_quotes(layout),
                 .where = path.string()});
  }
  if (const std::string found = value(kPresetKey); found != preset) {
    throw Error({.what = "a checkpoint of another preset than config.json's",
                 .expected = preset,
                 .got = in_quotes(found),
                 .where = path.string()});
  }
  return checkpoint;
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
  return nlohmann::ordered_json::parse(text->second, nullptr, /*allow_exceptions=*/false);
}

template <typename T>
void read_number(const Json& json, const char* key, const Checkpoint& checkpoint, T& value) {
  const bool good =
      json.is_object() && json.contains(key) &&
      (std::is_integral_v<T> ? json[key].is_number_unsigned() && json[key].template get<std::uint64_t>() <= INT64_MAX
                             : json[key].is_number());
  if (!good) checkpoint.fail("not a checkpoint: no number '" + std::string(key) + "'");
  json[key].get_to(value);
}
template void read_number(const Json&, const char*, const Checkpoint&, std::int64_t&);
template void read_number(const Json&, const char*, const Checkpoint&, double&);

TrainingProgress Checkpoint::progress() const {
  const Json found = json(kProgressKey);
  TrainingProgress progress;
  read_number(found, "done", *this, progress.done);
  read_number(found, "samples", *this, progress.samples);
  read_number(found, "elapsed_s", *this, progress.elapsed_s);
  return progress;
}

Rng Checkpoint::rng() const {
  const auto words = get<std::uint64_t>(kRandomState, {4});
  Rng::State state{};
  std::copy(words.begin(), words.end(), state.begin());
  if (state == Rng::State{}) fail("the random state is damaged");
  return Rng(state);
}

AdamState Checkpoint::adam(std::size_t count) const {
  const Shape shape = {static_cast<std::int64_t>(count)};
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
