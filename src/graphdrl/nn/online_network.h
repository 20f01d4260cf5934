// The online explorer's network: three linear layers that score a first visit of an unknown map by its features. The
// higher the score, the better.
#pragma once

#include <span>
#include <vector>

#include "graphdrl/nn/online_features.h"
#include "graphdrl/nn/parameters.h"

namespace graphdrl {

inline constexpr LinearShape kOnlineLayer1 = {kOnlineFeatureCount, 48};
inline constexpr LinearShape kOnlineLayer2 = {48, 24};
inline constexpr LinearShape kOnlineLayer3 = {24, 1};

class OnlineParameters : public ParameterBuffer {
 public:
  OnlineParameters() : ParameterBuffer(specs()) {}
  explicit OnlineParameters(Rng& rng) : OnlineParameters() { draw(rng); }
  // Of a file. Throws Error as ParameterBuffer does.
  explicit OnlineParameters(const Safetensors& file, const std::string& prefix = "")
      : ParameterBuffer(specs(), file, prefix) {}

  static const std::vector<TensorSpec>& specs();
  static nlohmann::json description();  // as in policy files
};

// Policy files of this network. Throw Error.
void write_policy_file(const std::filesystem::path& path, const OnlineParameters& parameters);
OnlineParameters read_online_explorer(const Safetensors& file);

// Keeps its working memory; not thread safe.
class OnlineNetwork {
 public:
  // rows: [C, features], as encode_online() appends them; score: [C].
  void forward(const OnlineParameters& parameters, std::span<const float> rows, std::span<float> score);

  // After forward() of the same. grad_score: [C], the loss's derivative; `grad` is overwritten by that by the
  // parameters.
  void backward(const OnlineParameters& parameters, std::span<const float> rows, std::span<const float> grad_score,
                OnlineParameters& grad);

 private:
  std::vector<float> hidden1_;  // [C, 48]
  std::vector<float> hidden2_;  // [C, 24]
  std::vector<float> grad1_;
  std::vector<float> grad2_;
};

}  // namespace graphdrl
