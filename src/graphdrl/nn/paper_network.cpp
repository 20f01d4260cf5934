#include "graphdrl/nn/paper_network.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "graphdrl/nn/vector_math.h"

namespace graphdrl {
namespace {

constexpr const char* kWallKey = "wall";

std::vector<TensorSpec> paper_specs() {
  TensorList list;
  for (std::size_t layer = 0; layer < kConvShapes.size(); ++layer) {
    list.add_conv(fmt::format("conv{}", layer + 1), kConvShapes[layer]);
    if (layer + 1 == kConvShapes.size()) continue;  // the last one is pooled, not normalised
    list.add(fmt::format("bn{}.weight", layer + 1), {kConvShapes[layer].width}, 0);
    list.add(fmt::format("bn{}.bias", layer + 1), {kConvShapes[layer].width}, 0);
  }
  list.add_linear("fc1", kFc1Shape);
  list.add_linear("fc2", kFc2Shape);
  for (std::size_t layer = 0; layer + 1 < kConvShapes.size(); ++layer) {
    list.add(fmt::format("bn{}.running_mean", layer + 1), {kConvShapes[layer].width}, 0, /*trainable=*/false);
    list.add(fmt::format("bn{}.running_var", layer + 1), {kConvShapes[layer].width}, 0, /*trainable=*/false);
  }
  return std::move(list).specs();
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
          {"features", kPaperFeatureNames},
          {"actions", kDirectionNames},
          {"layers", layers},
          {"activation", "elu"},
          {"batch_norm", {{"epsilon", kBatchNormEpsilon}, {"momentum", kBatchNormMomentum}}},
          {"pooling", "sum"}};
}

PaperWall described_wall(const Safetensors& file) {
  const nlohmann::json description = policy_description(file);
  const auto wall = description.find(kWallKey);
  if (wall == description.end()) return PaperWall::kBorder;
  return parse_paper_wall(wall->is_string() ? wall->get<std::string>() : wall->dump(), file.source());
}

}  // namespace

PaperParameters::PaperParameters(Rng& rng) : PaperParameters() {
  draw(rng);
  for (const TensorSpec& spec : specs()) {
    const bool of_batch_norm = spec.name.starts_with("bn");
    if (!of_batch_norm || !(spec.name.ends_with(".weight") || spec.name.ends_with(".running_var"))) continue;
    std::fill_n(values().data() + spec.offset, spec.size, 1.0f);
  }
}

const std::vector<TensorSpec>& PaperParameters::specs() {
  static const std::vector<TensorSpec> specs = paper_specs();
  return specs;
}

GatedGraphConvTensors<float> PaperParameters::conv(int layer) {
  return conv(fmt::format("conv{}", layer));
}

GatedGraphConvTensors<const float> PaperParameters::conv(int layer) const {
  return conv(fmt::format("conv{}", layer));
}

nlohmann::json PaperParameters::description() const {
  nlohmann::json description = network_description();
  if (wall_ != PaperWall::kBorder) description[kWallKey] = name_of(wall_);
  return description;
}

void write_policy_file(const std::filesystem::path& path, const PaperParameters& parameters) {
  write_policy_file(path, parameters, parameters.description());
}

PaperParameters read_policy_file(const std::filesystem::path& path) {
  const Safetensors file = Safetensors::read(path);
  require_description(file, network_description(), PaperParameters::specs());
  PaperParameters parameters = PaperParameters::from_file(file);
  parameters.set_wall(described_wall(file));
  return parameters;
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
