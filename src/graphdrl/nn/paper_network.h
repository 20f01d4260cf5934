// The Q-network of the paper, Table 1, without any tensor library: its parameters, its inference, its policy files.
//
// Two facts that differ from the paper's text. Table 1 prints 26,598 parameters for its third row; the formula that
// gives its first and fifth, L·D² + 6·D² + 6·D, gives 41,344 there, and so does this network. The text says the output
// lies in [0, 1]; eq. 3 makes values negative, so the last layer is linear.
#pragma once

#include <array>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "graphdrl/nn/graph_batch.h"
#include "graphdrl/nn/paper_features.h"
#include "graphdrl/nn/parameters.h"

namespace graphdrl {

inline constexpr std::array<GatedGraphConvShape, 3> kConvShapes = {
    {{7, 7, 4, true}, {7, 64, 4, true}, {64, 128, 4, true}}};
inline constexpr int kHiddenWidth = 256;
inline constexpr int kActionCount = 4;  // left, up, right, down
inline constexpr LinearShape kFc1Shape = {kConvShapes[2].width, kHiddenWidth};
inline constexpr LinearShape kFc2Shape = {kHiddenWidth, kActionCount};
inline constexpr double kBatchNormEpsilon = 1e-5;
inline constexpr double kBatchNormMomentum = 0.1;

class PaperParameters : public ParameterBuffer {
 public:
  // Initialised as PyTorch and PyTorch Geometric do; batch norm 1 and 0, its running statistics 0 and 1.
  explicit PaperParameters(Rng& rng);

  // All values 0: a place for gradients, or to be filled.
  PaperParameters() : ParameterBuffer(specs()) {}

  static const std::vector<TensorSpec>& specs();
  static std::size_t trainable_count() { return graphdrl::trainable_count(specs()); }  // 240,678

  // How the network's input is computed.
  PaperWall wall() const { return wall_; }
  void set_wall(PaperWall wall) { wall_ = wall; }
  // The network, as policy files describe it. The key "wall" is there only where it is not the border.
  nlohmann::json description() const;

  using ParameterBuffer::conv;
  GatedGraphConvTensors<float> conv(int layer);  // layer: 1 to 3
  GatedGraphConvTensors<const float> conv(int layer) const;

  static PaperParameters from_file(const Safetensors& file, const std::string& prefix = "") {
    return PaperParameters(ParameterBuffer(specs(), file, prefix));
  }

 private:
  explicit PaperParameters(ParameterBuffer buffer) : ParameterBuffer(std::move(buffer)) {}

  PaperWall wall_ = PaperWall::kBorder;
};

// Policy files of this network. Throw Error.
void write_policy_file(const std::filesystem::path& path, const PaperParameters& parameters);
PaperParameters read_policy_file(const std::filesystem::path& path);

// Computes Q-values as PyTorch does in eval mode: batch norm by its running statistics, no dropout. Keeps its working
// memory; not thread safe, though it spreads its work over parallel_for.
class PaperNetwork {
 public:
  PaperNetwork();

  // Takes the parameters for all later calls; they must stay until the next call.
  void set_parameters(const PaperParameters& parameters);

  // x: [N, F] features, q: [B, A].
  void q_values(const GraphBatch& batch, std::span<const float> x, std::span<float> q);

  // Layer 1 to 3, with its weights set; a learner runs it forward and backward by itself.
  GatedGraphConv<float>& conv(int layer) { return convs_[layer - 1]; }

 private:
  void normalise(int layer, std::span<float> x) const;

  const PaperParameters* parameters_ = nullptr;
  std::vector<GatedGraphConv<float>> convs_;
  std::array<std::vector<float>, 3> outputs_;  // [N, D] each
  std::vector<float> pooled_;                  // [B, 128]
  std::vector<float> hidden_;                  // [B, 256]
};

}  // namespace graphdrl
