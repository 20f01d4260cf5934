// The explorer's network: one gated graph convolution over a state's valid nodes, and a head that scores every first
// visit by the embeddings of its target, of the current node and of the whole graph. Its output is what a first visit
// is going to cost in the end: how many nodes the best walk after it falls short of the state's ceiling
// [explorer_features.h], and kWorthOfCost more for every mean edge that the walk costs beyond one a node. So it tells
// first visits apart where the budget suffices for everything, too.
//
// Renumbering a world's nodes renumbers the scores and changes nothing else, but for ties at the edge of the scope. No
// tensor library is needed.
#pragma once

#include <span>
#include <vector>

#include "graphdrl/nn/explorer_features.h"
#include "graphdrl/nn/graph_batch.h"
#include "graphdrl/nn/parameters.h"

namespace graphdrl {

inline constexpr GatedGraphConvShape kExplorerConvShape = {kExplorerNodeFeatureCount, 48, 8};
static_assert(kExplorerConvShape.inputs <= kExplorerConvShape.width);
inline constexpr int kExplorerHeadInputs =
    3 * kExplorerConvShape.width + kExplorerNodeFeatureCount + kExplorerVisitFeatureCount;
inline constexpr LinearShape kExplorerHead1 = {kExplorerHeadInputs, 64};
inline constexpr LinearShape kExplorerHead2 = {64, 1};

inline constexpr double kWorthOfCost = 0.25;  // nodes

class ExplorerParameters : public ParameterBuffer {
 public:
  ExplorerParameters() : ParameterBuffer(specs()) {}
  explicit ExplorerParameters(Rng& rng) : ExplorerParameters() { draw(rng); }
  // Of a file. Throws Error as ParameterBuffer does.
  explicit ExplorerParameters(const Safetensors& file, const std::string& prefix = "")
      : ParameterBuffer(specs(), file, prefix) {}

  static const std::vector<TensorSpec>& specs();
  static nlohmann::json description();  // as in policy files
};

// Policy files of this network. Throw Error.
void write_policy_file(const std::filesystem::path& path, const ExplorerParameters& parameters);
ExplorerParameters read_explorer(const Safetensors& file);

// Keeps its working memory; not thread safe, though it spreads its work over parallel_for.
class ExplorerNetwork {
 public:
  ExplorerNetwork() : conv_(kExplorerConvShape) {}

  // Takes the parameters for all later calls; they must stay until the next call.
  void set_parameters(const ExplorerParameters& parameters);

  // shortfall: [C], in nodes. With `keep`, what backward() needs stays.
  void forward(const ExplorerBatch& batch, std::span<float> shortfall, bool keep = false);

  // After forward(batch, …, keep = true). grad_shortfall: [C], the loss's derivative; `grad` is overwritten by that by
  // the parameters.
  void backward(const ExplorerBatch& batch, std::span<const float> grad_shortfall, ExplorerParameters& grad);

 private:
  const ExplorerParameters* parameters_ = nullptr;
  GatedGraphConv conv_;
  std::vector<float> embedded_;     // [N, D]
  std::vector<float> pooled_;       // [B, D], means
  std::vector<float> joined_;       // [C, head inputs]
  std::vector<float> hidden_;       // [C, 64]
  std::vector<float> grad_hidden_;  // [C, 64]
  std::vector<float> grad_joined_;  // [C, head inputs]
  std::vector<float> grad_pooled_;  // [B, D]
  std::vector<float> grad_nodes_;   // [N, D]
};

}  // namespace graphdrl
