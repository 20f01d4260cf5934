#include "graphdrl/nn/online_network.h"

#include <nlohmann/json.hpp>

#include "graphdrl/nn/vector_math.h"

namespace graphdrl {

const std::vector<TensorSpec>& OnlineParameters::specs() {
  static const std::vector<TensorSpec> specs = [] {
    std::vector<TensorSpec> list;
    add_linear(list, "layer1", kOnlineLayer1);
    add_linear(list, "layer2", kOnlineLayer2);
    add_linear(list, "layer3", kOnlineLayer3);
    return list;
  }();
  return specs;
}

nlohmann::json OnlineParameters::description() {
  const auto layer = [](const LinearShape& shape, const char* activation) {
    return nlohmann::json{
        {"type", "linear"}, {"inputs", shape.inputs}, {"width", shape.outputs}, {"activation", activation}};
  };
  return {{"kind", "online_explorer"},
          {"visit_features", kOnlineVisitFeatures},
          {"map_features", kOnlineMapFeatures},
          {"visits", kOnlineVisits},
          {"layers", {layer(kOnlineLayer1, "elu"), layer(kOnlineLayer2, "elu"), layer(kOnlineLayer3, "none")}}};
}

void write_policy_file(const std::filesystem::path& path, const OnlineParameters& parameters) {
  write_policy_file(path, parameters, OnlineParameters::description());
}

OnlineParameters read_online_explorer(const Safetensors& file) {
  require_description(file, OnlineParameters::description(), OnlineParameters::specs());
  return OnlineParameters(file);
}

void OnlineNetwork::forward(const OnlineParameters& parameters, std::span<const float> rows, std::span<float> score) {
  const int count = static_cast<int>(score.size());
  hidden1_.resize(static_cast<std::size_t>(count) * kOnlineLayer1.outputs);
  hidden2_.resize(static_cast<std::size_t>(count) * kOnlineLayer2.outputs);
  linear(kOnlineLayer1, count, rows.data(), parameters.linear("layer1"), hidden1_.data());
  elu(hidden1_.data(), hidden1_.size());
  linear(kOnlineLayer2, count, hidden1_.data(), parameters.linear("layer2"), hidden2_.data());
  elu(hidden2_.data(), hidden2_.size());
  linear(kOnlineLayer3, count, hidden2_.data(), parameters.linear("layer3"), score.data());
}

void OnlineNetwork::backward(const OnlineParameters& parameters, std::span<const float> rows,
                             std::span<const float> grad_score, OnlineParameters& grad) {
  const int count = static_cast<int>(grad_score.size());
  grad1_.resize(hidden1_.size());
  grad2_.resize(hidden2_.size());
  linear_backward(kOnlineLayer3, count, hidden2_.data(), parameters.linear("layer3"), grad_score.data(), grad2_.data(),
                  grad.linear("layer3"));
  elu_backward(hidden2_.data(), grad2_.data(), grad2_.size());
  linear_backward(kOnlineLayer2, count, hidden1_.data(), parameters.linear("layer2"), grad2_.data(), grad1_.data(),
                  grad.linear("layer2"));
  elu_backward(hidden1_.data(), grad1_.data(), grad1_.size());
  linear_backward(kOnlineLayer1, count, rows.data(), parameters.linear("layer1"), grad1_.data(), nullptr,
                  grad.linear("layer1"));
}

}  // namespace graphdrl
