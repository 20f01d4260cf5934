#include "graphdrl/nn/paper_network.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "graphdrl/nn/vector_math.h"

namespace graphdrl {
namespace {

constexpr const char* kWallKey = "wall";

constexpr std::size_t kNorms = kConvShapes.size() - 1;  // the last convolution is pooled, not normalised

std::string conv_name(std::size_t layer) {
  return fmt::format("conv{}", layer + 1);
}

std::string norm_name(std::size_t layer, const char* tensor) {
  return fmt::format("bn{}.{}", layer + 1, tensor);
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

void multiply(std::span<const float> scale, std::vector<float>& values) {
  for (std::size_t i = 0; i < values.size(); ++i) values[i] *= scale[i];
}

}  // namespace

PaperParameters::PaperParameters(Rng& rng) : PaperParameters() {
  draw(rng);
  for (std::size_t i = 0; i < kNorms; ++i) {
    for (const char* const name : {"weight", "running_var"}) {
      std::fill_n(tensor(norm_name(i, name)), kConvShapes[i].width, 1.0f);
    }
  }
}

const std::vector<TensorSpec>& PaperParameters::specs() {
  static const std::vector<TensorSpec> specs = [] {
    std::vector<TensorSpec> list;
    for (std::size_t i = 0; i < kConvShapes.size(); ++i) {
      add_conv(list, conv_name(i), kConvShapes[i]);
      if (i == kNorms) break;
      for (const char* const of : {"weight", "bias"}) add_tensor(list, norm_name(i, of), {kConvShapes[i].width}, 0);
    }
    add_linear(list, "fc1", kFc1Shape);
    add_linear(list, "fc2", kFc2Shape);
    for (std::size_t i = 0; i < kNorms; ++i) {
      for (const char* const of : {"running_mean", "running_var"}) {
        add_tensor(list, norm_name(i, of), {kConvShapes[i].width}, 0, /*trainable=*/false);
      }
    }
    return list;
  }();
  return specs;
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
  PaperParameters parameters(file);
  const nlohmann::json description = policy_description(file);
  if (const auto wall = description.find(kWallKey); wall != description.end()) {
    parameters.set_wall(parse_paper_wall(wall->is_string() ? wall->get<std::string>() : wall->dump(), file.source()));
  }
  return parameters;
}

PaperNetwork::PaperNetwork() {
  for (const GatedGraphConvShape& shape : kConvShapes) layers_.emplace_back(shape);
}

void PaperNetwork::set_parameters(const PaperParameters& parameters) {
  fc1_ = parameters.linear("fc1");
  fc2_ = parameters.linear("fc2");
  for (std::size_t i = 0; i < layers_.size(); ++i) {
    Layer& layer = layers_[i];
    layer.conv.set_weights(parameters.conv(conv_name(i)));
    if (i == kNorms) break;
    const auto of_norm = [&](const char* tensor) { return parameters.tensor(norm_name(i, tensor)); };
    layer.norm = {.weight = of_norm("weight"), .bias = of_norm("bias")};
    layer.running.mean.assign(of_norm("running_mean"), of_norm("running_mean") + kConvShapes[i].width);
    layer.running.inverse.clear();
    for (const float variance : std::span(of_norm("running_var"), kConvShapes[i].width)) {
      layer.running.inverse.push_back(1 / std::sqrt(variance + static_cast<float>(kBatchNormEpsilon)));
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
    if (i == kNorms) break;
    if (train) {
      layer.of_batch = column_statistics(nodes, width, input, kBatchNormEpsilon);
      layer.normalised.resize(layer.output.size());
    }
    float* const normalised = train ? layer.normalised.data() : layer.output.data();
    batch_norm(nodes, width, input, train ? layer.of_batch : layer.running, layer.norm, normalised);
    input = normalised;
  }
  pooled_.resize(static_cast<std::size_t>(graphs) * kFc1Shape.inputs);
  hidden_.resize(static_cast<std::size_t>(graphs) * kFc1Shape.outputs);
  sum_pool(batch, kFc1Shape.inputs, input, pooled_.data());
  linear(kFc1Shape, graphs, pooled_.data(), fc1_, hidden_.data());
  elu(hidden_.data(), hidden_.size());
  if (train) {
    activated_ = hidden_;
    multiply(keep_scale, hidden_);
  }
  linear(kFc2Shape, graphs, hidden_.data(), fc2_, q.data());
}

void PaperNetwork::backward(const GraphBatch& batch, std::span<const float> keep_scale, std::span<const float> grad_q,
                            PaperParameters& grad) {
  const int nodes = batch.node_count();
  const int graphs = batch.graph_count();
  grad_hidden_.resize(hidden_.size());
  grad_pooled_.resize(pooled_.size());
  for (Layer& layer : layers_) layer.grad.resize(layer.output.size());
  linear_backward(kFc2Shape, graphs, hidden_.data(), fc2_, grad_q.data(), grad_hidden_.data(), grad.linear("fc2"));
  multiply(keep_scale, grad_hidden_);
  elu_backward(activated_.data(), grad_hidden_.data(), grad_hidden_.size());
  linear_backward(kFc1Shape, graphs, pooled_.data(), fc1_, grad_hidden_.data(), grad_pooled_.data(),
                  grad.linear("fc1"));
  sum_pool_backward(batch, kFc1Shape.inputs, grad_pooled_.data(), layers_.back().grad.data());
  for (std::size_t i = layers_.size(); i-- > 0;) {
    Layer& layer = layers_[i];
    Layer* const before = i > 0 ? &layers_[i - 1] : nullptr;
    float* const by_input = before != nullptr ? before->grad.data() : nullptr;
    layer.conv.backward(batch, layer.output.data(), layer.grad.data(), by_input, grad.conv(conv_name(i)));
    if (before == nullptr) break;
    batch_norm_backward(nodes, kConvShapes[i - 1].width, before->output.data(), before->of_batch, before->norm,
                        by_input, grad.tensor(norm_name(i - 1, "weight")), grad.tensor(norm_name(i - 1, "bias")));
  }
}

void PaperNetwork::move_statistics(int nodes, PaperParameters& parameters) const {
  constexpr auto kMomentum = static_cast<float>(kBatchNormMomentum);
  const float unbiased = static_cast<float>(nodes) / static_cast<float>(std::max(nodes - 1, 1));
  for (std::size_t i = 0; i < kNorms; ++i) {
    float* const mean = parameters.tensor(norm_name(i, "running_mean"));
    float* const variance = parameters.tensor(norm_name(i, "running_var"));
    const ColumnStatistics& statistics = layers_[i].of_batch;
    for (int column = 0; column < kConvShapes[i].width; ++column) {
      mean[column] += kMomentum * (statistics.mean[column] - mean[column]);
      variance[column] += kMomentum * (statistics.variance[column] * unbiased - variance[column]);
    }
  }
}

}  // namespace graphdrl
