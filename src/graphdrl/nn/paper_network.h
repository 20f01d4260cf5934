// The Q-network of the paper, Table 1, without any tensor library: its parameters, its passes, its policy files.
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
  // Of a file. Throws Error as ParameterBuffer does.
  explicit PaperParameters(const Safetensors& file, const std::string& prefix = "")
      : ParameterBuffer(specs(), file, prefix) {}

  static const std::vector<TensorSpec>& specs();
  static std::size_t trainable_count() { return graphdrl::trainable_count(specs()); }  // 240,678

  // How the network's input is computed.
  PaperWall wall() const { return wall_; }
  void set_wall(PaperWall wall) { wall_ = wall; }
  // The network, as policy files describe it. The key "wall" is there only where it is not the border.
  nlohmann::json description() const;

 private:
  PaperWall wall_ = PaperWall::kBorder;
};

// Policy files of this network. Throw Error.
void write_policy_file(const std::filesystem::path& path, const PaperParameters& parameters);
PaperParameters read_policy_file(const std::filesystem::path& path);

// Computes Q-values as PyTorch does, and the gradients of a training. Keeps its working memory; not thread safe, though
// it spreads its work over parallel_for.
class PaperNetwork {
 public:
  PaperNetwork();

  // Takes the parameters for all later calls; they must stay until the next call, which must follow every change.
  void set_parameters(const PaperParameters& parameters);

  // x: [N, F] features, q: [B, A]. Without `keep_scale` in eval mode: batch norm by its running statistics, no dropout.
  // With it in train mode [paper, Table 1]: batch norm by the batch's statistics, and hidden values multiplied by
  // keep_scale [B, 256], 0 where one is dropped and 1 / (1 - p) where it is kept; what backward() needs stays.
  void q_values(const GraphBatch& batch, std::span<const float> x, std::span<float> q,
                std::span<const float> keep_scale = {});

  // After q_values() with the same batch and keep_scale. grad_q: [B, A], the loss's derivative by q; `grad` is
  // overwritten by that by the parameters, but for the running statistics, which have none.
  void backward(const GraphBatch& batch, std::span<const float> keep_scale, std::span<const float> grad_q,
                PaperParameters& grad);

  // Moves running statistics towards those of the last q_values() in train mode, which had `nodes` nodes.
  void move_statistics(int nodes, PaperParameters& parameters) const;

 private:
  struct Layer {
    explicit Layer(const GatedGraphConvShape& shape) : conv(shape) {}

    GatedGraphConv conv;
    std::vector<float> output;      // [N, D]
    std::vector<float> grad;        // by it: [N, D]
    BatchNormTensors norm{};        // after it, but for the last
    ColumnStatistics running;       // of the norm
    ColumnStatistics of_batch;      // in train mode
    std::vector<float> normalised;  // [N, D], in train mode
  };

  LinearTensors<const float> fc1_{};
  LinearTensors<const float> fc2_{};
  std::vector<Layer> layers_;
  std::vector<float> pooled_;       // [B, 128]
  std::vector<float> activated_;    // [B, 256], before the dropout
  std::vector<float> hidden_;       // [B, 256], after it
  std::vector<float> grad_hidden_;  // [B, 256]
  std::vector<float> grad_pooled_;  // [B, 128]
};

}  // namespace graphdrl
