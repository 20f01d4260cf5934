#include "graphdrl/nn/explorer_network.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "graphdrl/base/parallel.h"
#include "graphdrl/nn/vector_math.h"

namespace graphdrl {
namespace {

constexpr int kWidth = kExplorerConvShape.width;
constexpr int kVisitsPerTask = 64;

void add_to(const float* from, int count, float* to) {
  for (int i = 0; i < count; ++i) to[i] += from[i];
}

// Divides each graph's row by its number of nodes. rows: [B, D].
void divide_by_sizes(const GraphBatch& graphs, float* rows) {
  for (int g = 0; g < graphs.graph_count(); ++g) {
    const float share = 1.0f / static_cast<float>(graphs.graph(g).node_count());
    for (int i = 0; i < kWidth; ++i) row_of(rows, g, kWidth)[i] *= share;
  }
}

}  // namespace

const std::vector<TensorSpec>& ExplorerParameters::specs() {
  static const std::vector<TensorSpec> specs = [] {
    std::vector<TensorSpec> list;
    add_conv(list, "conv", kExplorerConvShape);
    add_linear(list, "head1", kExplorerHead1);
    add_linear(list, "head2", kExplorerHead2);
    return list;
  }();
  return specs;
}

nlohmann::json ExplorerParameters::description() {
  const auto& conv = kExplorerConvShape;
  const auto names_of = [](const auto& features) {
    nlohmann::json names;
    for (const ExplorerFeature& feature : features) names.push_back(feature.name);
    return names;
  };
  return {{"kind", "explorer"},
          {"node_features", names_of(kExplorerNodeFeatures)},
          {"visit_features", names_of(kExplorerVisitFeatures)},
          {"layers",
           {{{"type", "gated_graph_conv"},
             {"inputs", conv.inputs},
             {"width", conv.width},
             {"steps", conv.steps},
             {"activation", "none"}},
            {{"type", "linear"},
             {"inputs", kExplorerHead1.inputs},
             {"width", kExplorerHead1.outputs},
             {"activation", "elu"}},
            {{"type", "linear"},
             {"inputs", kExplorerHead2.inputs},
             {"width", kExplorerHead2.outputs},
             {"activation", "none"}}}},
          {"scope", kExplorerScope},
          {"head_inputs", {"target", "current", "mean", "node_features", "visit_features"}}};
}

void write_policy_file(const std::filesystem::path& path, const ExplorerParameters& parameters) {
  write_policy_file(path, parameters, ExplorerParameters::description());
}

ExplorerParameters read_explorer(const Safetensors& file) {
  require_description(file, ExplorerParameters::description(), ExplorerParameters::specs());
  return ExplorerParameters(file);
}

void ExplorerNetwork::set_parameters(const ExplorerParameters& parameters) {
  parameters_ = &parameters;
  conv_.set_weights(parameters.conv("conv"));
}

void ExplorerNetwork::forward(const ExplorerBatch& batch, std::span<float> shortfall, bool keep) {
  const int visits = batch.visit_count();
  embedded_.resize(static_cast<std::size_t>(batch.graphs.node_count()) * kWidth);
  pooled_.resize(static_cast<std::size_t>(batch.graphs.graph_count()) * kWidth);
  joined_.resize(static_cast<std::size_t>(visits) * kExplorerHeadInputs);
  hidden_.resize(static_cast<std::size_t>(visits) * kExplorerHead1.outputs);
  conv_.forward(batch.graphs, batch.node_x.data(), embedded_.data(), keep);
  sum_pool(batch.graphs, kWidth, embedded_.data(), pooled_.data());
  divide_by_sizes(batch.graphs, pooled_.data());
  parallel_for((visits + kVisitsPerTask - 1) / kVisitsPerTask, [&](int task) {
    for (int v = task * kVisitsPerTask; v < std::min(visits, (task + 1) * kVisitsPerTask); ++v) {
      float* to = row_of(joined_.data(), v, kExplorerHeadInputs);
      to = std::copy_n(row_of(embedded_.data(), batch.target[v], kWidth), kWidth, to);
      to = std::copy_n(row_of(embedded_.data(), batch.current[batch.state[v]], kWidth), kWidth, to);
      to = std::copy_n(row_of(pooled_.data(), batch.state[v], kWidth), kWidth, to);
      to = std::copy_n(row_of(batch.node_x.data(), batch.target[v], kExplorerNodeFeatureCount),
                       kExplorerNodeFeatureCount, to);
      std::copy_n(row_of(batch.visit_x.data(), v, kExplorerVisitFeatureCount), kExplorerVisitFeatureCount, to);
    }
  });
  linear(kExplorerHead1, visits, joined_.data(), parameters_->linear("head1"), hidden_.data());
  elu(hidden_.data(), hidden_.size());
  linear(kExplorerHead2, visits, hidden_.data(), parameters_->linear("head2"), shortfall.data());
}

void ExplorerNetwork::backward(const ExplorerBatch& batch, std::span<const float> grad_shortfall,
                               ExplorerParameters& grad) {
  const int visits = batch.visit_count();
  grad_hidden_.resize(hidden_.size());
  grad_joined_.resize(joined_.size());
  grad_pooled_.assign(pooled_.size(), 0.0f);
  grad_nodes_.resize(embedded_.size());
  linear_backward(kExplorerHead2, visits, hidden_.data(), parameters_->linear("head2"), grad_shortfall.data(),
                  grad_hidden_.data(), grad.linear("head2"));
  elu_backward(hidden_.data(), grad_hidden_.data(), grad_hidden_.size());
  linear_backward(kExplorerHead1, visits, joined_.data(), parameters_->linear("head1"), grad_hidden_.data(),
                  grad_joined_.data(), grad.linear("head1"));
  for (int v = 0; v < visits; ++v) {
    const float* const from = row_of(grad_joined_.data(), v, kExplorerHeadInputs);
    add_to(from + 2 * kWidth, kWidth, row_of(grad_pooled_.data(), batch.state[v], kWidth));
  }
  divide_by_sizes(batch.graphs, grad_pooled_.data());
  sum_pool_backward(batch.graphs, kWidth, grad_pooled_.data(), grad_nodes_.data());
  for (int v = 0; v < visits; ++v) {
    const float* const from = row_of(grad_joined_.data(), v, kExplorerHeadInputs);
    add_to(from, kWidth, row_of(grad_nodes_.data(), batch.target[v], kWidth));
    add_to(from + kWidth, kWidth, row_of(grad_nodes_.data(), batch.current[batch.state[v]], kWidth));
  }
  conv_.backward(batch.graphs, embedded_.data(), grad_nodes_.data(), nullptr, grad.conv("conv"));
}

}  // namespace graphdrl
