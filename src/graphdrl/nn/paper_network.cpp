#include "graphdrl/nn/paper_network.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "graphdrl/base/error.h"
#include "graphdrl/nn/features.h"
#include "graphdrl/nn/vector_math.h"

namespace graphdrl {
namespace {

constexpr const char* kDescriptionKey = "network";

std::vector<TensorSpec> make_specs() {
  std::vector<TensorSpec> specs;
  const auto add = [&](const std::string& name, Shape shape, bool trainable) {
    std::size_t size = 1;
    for (const std::int64_t extent : shape) size *= static_cast<std::size_t>(extent);
    const std::size_t offset = specs.empty() ? 0 : specs.back().offset + specs.back().size;
    specs.push_back({name, std::move(shape), trainable, offset, size});
  };
  const auto conv = [](std::size_t layer) { return fmt::format("conv{}", layer + 1); };
  for (std::size_t layer = 0; layer < kConvShapes.size(); ++layer) {
    const auto [inputs, width, steps, elu] = kConvShapes[layer];
    add(conv(layer) + ".weight", {steps, width, width}, true);
    add(conv(layer) + ".rnn.weight_ih", {3 * width, width}, true);
    add(conv(layer) + ".rnn.weight_hh", {3 * width, width}, true);
    add(conv(layer) + ".rnn.bias_ih", {3 * width}, true);
    add(conv(layer) + ".rnn.bias_hh", {3 * width}, true);
    if (layer + 1 == kConvShapes.size()) continue;  // the last one is pooled, not normalised
    add(fmt::format("bn{}.weight", layer + 1), {width}, true);
    add(fmt::format("bn{}.bias", layer + 1), {width}, true);
  }
  add("fc1.weight", {kHiddenWidth, kFc1Shape.inputs}, true);
  add("fc1.bias", {kHiddenWidth}, true);
  add("fc2.weight", {kActionCount, kHiddenWidth}, true);
  add("fc2.bias", {kActionCount}, true);
  for (std::size_t layer = 0; layer + 1 < kConvShapes.size(); ++layer) {
    add(fmt::format("bn{}.running_mean", layer + 1), {kConvShapes[layer].width}, false);
    add(fmt::format("bn{}.running_var", layer + 1), {kConvShapes[layer].width}, false);
  }
  return specs;
}

const TensorSpec& find_spec(const std::string& name) {
  const auto& specs = PaperParameters::specs();
  return *std::find_if(specs.begin(), specs.end(), [&](const TensorSpec& spec) { return spec.name == name; });
}

// Half the width of the uniform distribution a tensor starts from.
float initial_bound(const TensorSpec& spec) {
  const float fan = spec.name.starts_with("conv")  ? static_cast<float>(kConvShapes[spec.name[4] - '1'].width)
                    : spec.name.starts_with("fc1") ? static_cast<float>(kFc1Shape.inputs)
                                                   : static_cast<float>(kHiddenWidth);
  return 1.0f / std::sqrt(fan);
}

// Everything a reader needs to rebuild the network, and what a file is compared with before it is believed.
nlohmann::json network_description() {
  nlohmann::json layers = nlohmann::json::array();
  for (const auto [inputs, width, steps, elu] : kConvShapes) {
    layers.push_back({{"type", "gated_graph_conv"}, {"inputs", inputs}, {"width", width}, {"steps", steps}});
  }
  layers.push_back({{"type", "linear"}, {"inputs", kFc1Shape.inputs}, {"width", kHiddenWidth}});
  layers.push_back({{"type", "linear"}, {"inputs", kHiddenWidth}, {"width", kActionCount}});
  return {{"kind", "paper"},
          {"features", kFeatureNames},
          {"actions", kDirectionNames},
          {"layers", layers},
          {"activation", "elu"},
          {"batch_norm", {{"epsilon", kBatchNormEpsilon}, {"momentum", kBatchNormMomentum}}},
          {"pooling", "sum"}};
}

}  // namespace

PaperParameters::PaperParameters() : values_(specs().back().offset + specs().back().size) {}

PaperParameters::PaperParameters(Rng& rng) : PaperParameters() {
  for (const TensorSpec& spec : specs()) {
    float* const values = values_.data() + spec.offset;
    if (spec.name.starts_with("bn")) {
      const bool one = spec.name.ends_with(".weight") || spec.name.ends_with(".running_var");
      std::fill_n(values, spec.size, one ? 1.0f : 0.0f);
      continue;
    }
    const float bound = initial_bound(spec);
    for (std::size_t i = 0; i < spec.size; ++i) values[i] = bound * static_cast<float>(2 * rng.uniform() - 1);
  }
}

const std::vector<TensorSpec>& PaperParameters::specs() {
  static const std::vector<TensorSpec> specs = make_specs();
  return specs;
}

std::size_t PaperParameters::trainable_count() {
  std::size_t count = 0;
  for (const TensorSpec& spec : specs()) count += spec.trainable ? spec.size : 0;
  return count;
}

float* PaperParameters::tensor(const std::string& name) {
  return values_.data() + find_spec(name).offset;
}

const float* PaperParameters::tensor(const std::string& name) const {
  return values_.data() + find_spec(name).offset;
}

GatedGraphConvTensors<float> PaperParameters::conv(int layer) {
  const std::string name = fmt::format("conv{}", layer);
  return {.weight = tensor(name + ".weight"),
          .w_ih = tensor(name + ".rnn.weight_ih"),
          .w_hh = tensor(name + ".rnn.weight_hh"),
          .b_ih = tensor(name + ".rnn.bias_ih"),
          .b_hh = tensor(name + ".rnn.bias_hh")};
}

GatedGraphConvTensors<const float> PaperParameters::conv(int layer) const {
  const auto views = const_cast<PaperParameters*>(this)->conv(layer);
  return {.weight = views.weight, .w_ih = views.w_ih, .w_hh = views.w_hh, .b_ih = views.b_ih, .b_hh = views.b_hh};
}

LinearTensors<float> PaperParameters::linear(const std::string& name) {
  return {.weight = tensor(name + ".weight"), .bias = tensor(name + ".bias")};
}

LinearTensors<const float> PaperParameters::linear(const std::string& name) const {
  return {.weight = tensor(name + ".weight"), .bias = tensor(name + ".bias")};
}

std::vector<TensorView> PaperParameters::views(const std::string& prefix) const {
  std::vector<TensorView> views;
  for (const TensorSpec& spec : specs()) {
    views.emplace_back(prefix + spec.name, spec.shape, std::span(values_).subspan(spec.offset, spec.size));
  }
  return views;
}

PaperParameters PaperParameters::from_file(const Safetensors& file, const std::string& prefix) {
  PaperParameters parameters;
  for (const TensorSpec& spec : specs()) {
    const std::vector<float> values = file.get<float>(prefix + spec.name, spec.shape);
    const bool variance = spec.name.ends_with("running_var");
    for (const float value : values) {
      if (std::isfinite(value) && !(variance && value < 0)) continue;
      throw Error({.what = "tensor " + in_quotes(prefix + spec.name) + " holds a value that no network can have",
                   .got = fmt::format("{}", value),
                   .where = file.source()});
    }
    std::copy(values.begin(), values.end(), parameters.values_.begin() + static_cast<std::ptrdiff_t>(spec.offset));
  }
  return parameters;
}

void write_policy_file(const std::filesystem::path& path, const PaperParameters& parameters) {
  write_safetensors(path, parameters.views(), {{kDescriptionKey, network_description().dump()}});
}

PaperParameters read_policy_file(const std::filesystem::path& path) {
  const Safetensors file = Safetensors::read(path);
  const auto text = file.metadata().find(kDescriptionKey);
  if (text == file.metadata().end()) {
    throw Error({.what = "not a policy file", .expected = "a network's description", .where = path.string()});
  }
  const auto found = nlohmann::json::parse(text->second, nullptr, /*allow_exceptions=*/false);
  const auto expected = network_description();
  for (const auto& [key, value] : expected.items()) {
    if (found.is_object() && found.contains(key) && found[key] == value) continue;
    const std::string got = found.is_object() && found.contains(key) ? found[key].dump() : "nothing";
    throw Error({.what = fmt::format("policy of another network: {} differs", in_quotes(key)),
                 .expected = value.dump(),
                 .got = in_quotes(got, 200),
                 .where = path.string()});
  }
  const std::size_t tensors = PaperParameters::specs().size();
  if (file.entries().size() != tensors) {
    throw Error({.what = "policy of another network",
                 .expected = fmt::format("{} tensors", tensors),
                 .got = fmt::format("{}", file.entries().size()),
                 .where = path.string()});
  }
  return PaperParameters::from_file(file);
}

PaperNetwork::PaperNetwork() {
  for (const GatedGraphConvShape& shape : kConvShapes) convs_.emplace_back(shape);
}

void PaperNetwork::set_parameters(const PaperParameters& parameters) {
  parameters_ = &parameters;
  for (int layer = 1; layer <= 3; ++layer) conv(layer).set_weights(parameters.conv(layer));
}

void PaperNetwork::normalise(int layer, std::span<float> x) const {
  const std::string name = fmt::format("bn{}", layer);
  const float* const mean = parameters_->tensor(name + ".running_mean");
  const float* const variance = parameters_->tensor(name + ".running_var");
  const int width = kConvShapes[layer - 1].width;
  ColumnStatistics running{.mean = {mean, mean + width}, .variance = {variance, variance + width}, .inverse = {}};
  for (const float value : running.variance) {
    running.inverse.push_back(1 / std::sqrt(value + static_cast<float>(kBatchNormEpsilon)));
  }
  const BatchNormTensors weights = {parameters_->tensor(name + ".weight"), parameters_->tensor(name + ".bias")};
  batch_norm(static_cast<int>(x.size()) / width, width, x.data(), running, weights, x.data());
}

void PaperNetwork::q_values(const GraphBatch& batch, std::span<const float> x, std::span<float> q) {
  const int nodes = batch.node_count();
  const int graphs = batch.graph_count();
  const float* input = x.data();
  for (int layer = 1; layer <= 3; ++layer) {
    std::vector<float>& output = outputs_[layer - 1];
    output.resize(static_cast<std::size_t>(nodes) * kConvShapes[layer - 1].width);
    conv(layer).forward(batch, input, output.data(), /*keep=*/false);
    if (layer < 3) normalise(layer, output);
    input = output.data();
  }
  pooled_.resize(static_cast<std::size_t>(graphs) * kFc1Shape.inputs);
  hidden_.resize(static_cast<std::size_t>(graphs) * kFc1Shape.outputs);
  sum_pool(batch, kFc1Shape.inputs, input, pooled_.data());
  linear(kFc1Shape, graphs, pooled_.data(), parameters_->linear("fc1"), hidden_.data());
  elu(hidden_.data(), hidden_.size());
  linear(kFc2Shape, graphs, hidden_.data(), parameters_->linear("fc2"), q.data());
}

}  // namespace graphdrl
