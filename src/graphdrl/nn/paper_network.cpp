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

// Parameters: PaperParameters, const where T is.
template <typename T, typename Parameters>
PaperTensors<T> find_tensors(Parameters& parameters) {
  PaperTensors<T> tensors;
  for (std::size_t i = 0; i < tensors.convs.size(); ++i) {
    tensors.convs[i] = parameters.conv(fmt::format("conv{}", i + 1));
    if (i == tensors.norms.size()) break;
    const std::string name = fmt::format("bn{}.", i + 1);
    tensors.norms[i] = {.weight = parameters.tensor(name + "weight"),
                        .bias = parameters.tensor(name + "bias"),
                        .running_mean = parameters.tensor(name + "running_mean"),
                        .running_variance = parameters.tensor(name + "running_var")};
  }
  tensors.fc1 = parameters.linear("fc1");
  tensors.fc2 = parameters.linear("fc2");
  return tensors;
}

BatchNormTensors weights_of(const PaperTensors<const float>::Norm& norm) {
  return {.weight = norm.weight, .bias = norm.bias};
}

void multiply(std::span<const float> scale, std::vector<float>& values) {
  for (std::size_t i = 0; i < values.size(); ++i) values[i] *= scale[i];
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

PaperTensors<float> PaperParameters::tensors() {
  return find_tensors<float>(*this);
}

PaperTensors<const float> PaperParameters::tensors() const {
  return find_tensors<const float>(*this);
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
  for (const GatedGraphConvShape& shape : kConvShapes) layers_.emplace_back(shape);
}

void PaperNetwork::set_parameters(const PaperParameters& parameters) {
  tensors_ = parameters.tensors();
  for (std::size_t i = 0; i < layers_.size(); ++i) layers_[i].conv.set_weights(tensors_.convs[i]);
  for (std::size_t i = 0; i < tensors_.norms.size(); ++i) {
    const int width = kConvShapes[i].width;
    const auto& norm = tensors_.norms[i];
    ColumnStatistics& running = layers_[i].running;
    running.mean.assign(norm.running_mean, norm.running_mean + width);
    running.inverse.clear();
    for (int column = 0; column < width; ++column) {
      running.inverse.push_back(1 / std::sqrt(norm.running_variance[column] + static_cast<float>(kBatchNormEpsilon)));
    }
  }
}

void PaperNetwork::q_values(const GraphBatch& batch, std::span<const float> x, std::span<float> q,
                            std::span<const float> keep_scale) {
  const bool train = !keep_scale.empty();
  const int nodes = batch.node_count();
  const int graphs = batch.graph_count();
  const float* input = x.data();
  for (std::size_t i = 0; i < layers_.size(); ++i) {
    Layer& layer = layers_[i];
    const int width = kConvShapes[i].width;
    layer.output.resize(static_cast<std::size_t>(nodes) * width);
    layer.conv.forward(batch, input, layer.output.data(), /*keep=*/train);
    input = layer.output.data();
    if (i == tensors_.norms.size()) break;  // the last one is pooled, not normalised
    if (train) {
      layer.of_batch = column_statistics(nodes, width, input, kBatchNormEpsilon);
      layer.normalised.resize(layer.output.size());
    }
    float* const normalised = train ? layer.normalised.data() : layer.output.data();
    batch_norm(nodes, width, input, train ? layer.of_batch : layer.running, weights_of(tensors_.norms[i]), normalised);
    input = normalised;
  }
  pooled_.resize(static_cast<std::size_t>(graphs) * kFc1Shape.inputs);
  hidden_.resize(static_cast<std::size_t>(graphs) * kFc1Shape.outputs);
  sum_pool(batch, kFc1Shape.inputs, input, pooled_.data());
  linear(kFc1Shape, graphs, pooled_.data(), tensors_.fc1, hidden_.data());
  elu(hidden_.data(), hidden_.size());
  if (train) {
    activated_ = hidden_;
    multiply(keep_scale, hidden_);
  }
  linear(kFc2Shape, graphs, hidden_.data(), tensors_.fc2, q.data());
}

void PaperNetwork::backward(const GraphBatch& batch, std::span<const float> keep_scale, std::span<const float> grad_q,
                            const PaperTensors<float>& grad) {
  const int nodes = batch.node_count();
  const int graphs = batch.graph_count();
  grad_hidden_.resize(hidden_.size());
  grad_pooled_.resize(pooled_.size());
  for (Layer& layer : layers_) layer.grad.resize(layer.output.size());
  linear_backward(kFc2Shape, graphs, hidden_.data(), tensors_.fc2, grad_q.data(), grad_hidden_.data(), grad.fc2);
  multiply(keep_scale, grad_hidden_);
  elu_backward(activated_.data(), grad_hidden_.data(), grad_hidden_.size());
  linear_backward(kFc1Shape, graphs, pooled_.data(), tensors_.fc1, grad_hidden_.data(), grad_pooled_.data(), grad.fc1);
  sum_pool_backward(batch, kFc1Shape.inputs, grad_pooled_.data(), layers_.back().grad.data());
  for (std::size_t i = layers_.size(); i-- > 0;) {
    Layer& layer = layers_[i];
    Layer* const before = i > 0 ? &layers_[i - 1] : nullptr;
    float* const by_input = before != nullptr ? before->grad.data() : nullptr;
    layer.conv.backward(batch, layer.output.data(), layer.grad.data(), by_input, grad.convs[i]);
    if (before == nullptr) break;
    batch_norm_backward(nodes, kConvShapes[i - 1].width, before->output.data(), before->of_batch,
                        weights_of(tensors_.norms[i - 1]), by_input, grad.norms[i - 1].weight, grad.norms[i - 1].bias);
  }
}

void PaperNetwork::move_statistics(int nodes, const PaperTensors<float>& parameters) const {
  constexpr auto kMomentum = static_cast<float>(kBatchNormMomentum);
  const float unbiased = static_cast<float>(nodes) / static_cast<float>(std::max(nodes - 1, 1));
  for (std::size_t i = 0; i < parameters.norms.size(); ++i) {
    const auto& norm = parameters.norms[i];
    const ColumnStatistics& statistics = layers_[i].of_batch;
    for (int column = 0; column < kConvShapes[i].width; ++column) {
      norm.running_mean[column] += kMomentum * (statistics.mean[column] - norm.running_mean[column]);
      norm.running_variance[column] +=
          kMomentum * (statistics.variance[column] * unbiased - norm.running_variance[column]);
    }
  }
}

}  // namespace graphdrl
