#include "graphdrl/nn/parameters.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "graphdrl/base/error.h"
#include "graphdrl/base/note.h"
#include "graphdrl/io/json.h"

namespace graphdrl {
namespace {

constexpr const char* kDescriptionKey = "network";
constexpr const char* kLayoutKey = "layout";
constexpr const char* kLayout = "2";  // since it there is a checksum; files before it have no layout

}  // namespace

void add_tensor(std::vector<TensorSpec>& specs, std::string name, Shape shape, float bound, bool trainable) {
  std::size_t size = 1;
  for (const std::int64_t extent : shape) size *= static_cast<std::size_t>(extent);
  const std::size_t offset = specs.empty() ? 0 : specs.back().offset + specs.back().size;
  specs.push_back({std::move(name), std::move(shape), trainable, bound, offset, size});
}

void add_conv(std::vector<TensorSpec>& specs, const std::string& name, const GatedGraphConvShape& shape) {
  const float bound = 1.0f / std::sqrt(static_cast<float>(shape.width));
  add_tensor(specs, name + ".weight", {shape.steps, shape.width, shape.width}, bound);
  add_tensor(specs, name + ".rnn.weight_ih", {3 * shape.width, shape.width}, bound);
  add_tensor(specs, name + ".rnn.weight_hh", {3 * shape.width, shape.width}, bound);
  add_tensor(specs, name + ".rnn.bias_ih", {3 * shape.width}, bound);
  add_tensor(specs, name + ".rnn.bias_hh", {3 * shape.width}, bound);
}

void add_linear(std::vector<TensorSpec>& specs, const std::string& name, const LinearShape& shape) {
  const float bound = 1.0f / std::sqrt(static_cast<float>(shape.inputs));
  add_tensor(specs, name + ".weight", {shape.outputs, shape.inputs}, bound);
  add_tensor(specs, name + ".bias", {shape.outputs}, bound);
}

ParameterBuffer::ParameterBuffer(const std::vector<TensorSpec>& specs)
    : specs_(&specs), values_(specs.back().offset + specs.back().size) {}

ParameterBuffer::ParameterBuffer(const std::vector<TensorSpec>& specs, const Safetensors& file,
                                 const std::string& prefix)
    : ParameterBuffer(specs) {
  for (const TensorSpec& spec : specs) {
    set(spec, file.get<float>(prefix + spec.name, spec.shape), file.source(), prefix);
  }
}

void ParameterBuffer::set(const TensorSpec& spec, std::span<const float> values, const std::string& source,
                          const std::string& prefix) {
  const bool variance = spec.name.ends_with("running_var");
  for (const float value : values) {
    if (std::isfinite(value) && !(variance && value < 0)) continue;
    throw Error({.what = "tensor " + in_quotes(prefix + spec.name) + " holds a value that no network can have",
                 .got = fmt::format("{}", value),
                 .where = source});
  }
  std::copy(values.begin(), values.end(), values_.begin() + static_cast<std::ptrdiff_t>(spec.offset));
}

void ParameterBuffer::draw(Rng& rng) {
  for (const TensorSpec& spec : *specs_) {
    float* const values = values_.data() + spec.offset;
    if (spec.bound == 0) {
      std::fill_n(values, spec.size, 0.0f);
      continue;
    }
    for (std::size_t i = 0; i < spec.size; ++i) values[i] = spec.bound * static_cast<float>(2 * rng.uniform() - 1);
  }
}

std::size_t ParameterBuffer::offset_of(const std::string& name) const {
  return std::ranges::find(*specs_, name, &TensorSpec::name)->offset;
}

GatedGraphConvTensors<float> ParameterBuffer::conv(const std::string& name) {
  return {.weight = tensor(name + ".weight"),
          .w_ih = tensor(name + ".rnn.weight_ih"),
          .w_hh = tensor(name + ".rnn.weight_hh"),
          .b_ih = tensor(name + ".rnn.bias_ih"),
          .b_hh = tensor(name + ".rnn.bias_hh")};
}

GatedGraphConvTensors<const float> ParameterBuffer::conv(const std::string& name) const {
  const auto views = const_cast<ParameterBuffer*>(this)->conv(name);
  return {.weight = views.weight, .w_ih = views.w_ih, .w_hh = views.w_hh, .b_ih = views.b_ih, .b_hh = views.b_hh};
}

LinearTensors<float> ParameterBuffer::linear(const std::string& name) {
  return {.weight = tensor(name + ".weight"), .bias = tensor(name + ".bias")};
}

LinearTensors<const float> ParameterBuffer::linear(const std::string& name) const {
  return {.weight = tensor(name + ".weight"), .bias = tensor(name + ".bias")};
}

std::string ParameterBuffer::first_not_finite() const {
  const auto found = std::find_if_not(values_.begin(), values_.end(), [](float value) { return std::isfinite(value); });
  const auto index = static_cast<std::size_t>(found - values_.begin());
  for (const TensorSpec& spec : *specs_) {
    if (index < spec.offset + spec.size) return spec.name;
  }
  return "";
}

std::vector<TensorView> ParameterBuffer::views(const std::string& prefix) const {
  std::vector<TensorView> views;
  for (const TensorSpec& spec : *specs_) {
    views.emplace_back(prefix + spec.name, spec.shape, std::span(values_).subspan(spec.offset, spec.size));
  }
  return views;
}

std::size_t trainable_count(const std::vector<TensorSpec>& specs) {
  std::size_t count = 0;
  for (const TensorSpec& spec : specs) count += spec.trainable ? spec.size : 0;
  return count;
}

void write_policy_file(const std::filesystem::path& path, const ParameterBuffer& parameters,
                       const nlohmann::json& description) {
  write_safetensors(path, parameters.views(), {{kDescriptionKey, description.dump()}, {kLayoutKey, kLayout}});
}

nlohmann::json policy_description(const Safetensors& file) {
  const auto text = file.metadata().find(kDescriptionKey);
  if (text == file.metadata().end()) {
    throw Error({.what = "not a policy file", .expected = "a network's description", .where = file.source()});
  }
  if (const auto layout = file.metadata().find(kLayoutKey); layout != file.metadata().end()) {
    if (layout->second != kLayout) {
      throw Error({.what = "a policy file of another version of graphdrl",
                   .expected = std::string("layout ") + kLayout,
                   .got = in_quotes(layout->second),
                   .where = file.source()});
    }
    file.require_checksum();
  }
  return parse_json(text->second, file.source(), "a network's description in the metadata");
}

void require_description(const Safetensors& file, const nlohmann::json& expected,
                         const std::vector<TensorSpec>& specs) {
  const auto found = policy_description(file);
  if (!file.has_checksum()) note(file.source() + ": no checksum: whether the policy is undamaged cannot be told");
  for (const auto& [key, value] : expected.items()) {
    if (found.is_object() && found.contains(key) && found[key] == value) continue;
    const std::string got = found.is_object() && found.contains(key) ? shortened(found[key], 200) : "nothing";
    throw Error({.what = fmt::format("policy of another network: {} differs", in_quotes(key)),
                 .expected = value.dump(),
                 .got = got,
                 .where = file.source()});
  }
  if (file.entries().size() != specs.size()) {
    throw Error({.what = "policy of another network",
                 .expected = fmt::format("{} tensors", specs.size()),
                 .got = fmt::format("{}", file.entries().size()),
                 .where = file.source()});
  }
}

}  // namespace graphdrl
