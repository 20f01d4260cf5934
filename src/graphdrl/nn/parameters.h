// The tensors of a network, by PyTorch's names, in one flat buffer.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <vector>

#include "graphdrl/base/random.h"
#include "graphdrl/io/safetensors.h"
#include "graphdrl/nn/gated_graph_conv.h"
#include "graphdrl/nn/layers.h"

namespace graphdrl {

// One tensor, and where it stands in the flat buffer of all of them.
struct TensorSpec {
  std::string name;  // PyTorch's: "conv1.rnn.weight_ih"
  Shape shape;
  bool trainable;  // batch norm's running statistics are not
  float bound;     // the values start uniformly within ±bound; 0 for those that start otherwise
  std::size_t offset;
  std::size_t size;
};

// List a network's tensors in the order of the buffer; the trainable ones must come first.
void add_tensor(std::vector<TensorSpec>& specs, std::string name, Shape shape, float bound, bool trainable = true);
// NAME.weight [L, D, D], NAME.rnn.*; within ±1/√D at the start, as in PyTorch Geometric.
void add_conv(std::vector<TensorSpec>& specs, const std::string& name, const GatedGraphConvShape& shape);
// NAME.weight [outputs, inputs], NAME.bias; within ±1/√inputs at the start, as in PyTorch.
void add_linear(std::vector<TensorSpec>& specs, const std::string& name, const LinearShape& shape);

// The values. The specs must outlive it.
class ParameterBuffer {
 public:
  // All values 0: a place for gradients, or to be filled.
  explicit ParameterBuffer(const std::vector<TensorSpec>& specs);
  // Values from a file's tensors of the same names. Throws Error where one is missing, of another shape or holds what
  // no network can have.
  ParameterBuffer(const std::vector<TensorSpec>& specs, const Safetensors& file, const std::string& prefix);

  // Sets one tensor. Throws Error, naming the source, where a value is one that no network can have.
  // REQUIRES: as many values as it has.
  void set(const TensorSpec& spec, std::span<const float> values, const std::string& source,
           const std::string& prefix = "");

  void draw(Rng& rng);  // each tensor within its bound; 0 draws no number

  std::span<float> values() { return values_; }
  std::span<const float> values() const { return values_; }
  // REQUIRES, of all that take a name: there is such a tensor, or such a layer.
  float* tensor(const std::string& name) { return values_.data() + offset_of(name); }
  const float* tensor(const std::string& name) const { return values_.data() + offset_of(name); }
  GatedGraphConvTensors<float> conv(const std::string& name);
  GatedGraphConvTensors<const float> conv(const std::string& name) const;
  LinearTensors<float> linear(const std::string& name);
  LinearTensors<const float> linear(const std::string& name) const;

  // The name of the first tensor with a value that is not finite; empty where there is none.
  std::string first_not_finite() const;

  // The tensors under their names, with `prefix` before each; for files. The values stay this object's.
  std::vector<TensorView> views(const std::string& prefix = "") const;

 private:
  std::size_t offset_of(const std::string& name) const;

  const std::vector<TensorSpec>* specs_;
  std::vector<float> values_;
};

std::size_t trainable_count(const std::vector<TensorSpec>& specs);

// A policy file: the parameters and, as metadata, the network's full description. Throws Error.
void write_policy_file(const std::filesystem::path& path, const ParameterBuffer& parameters,
                       const nlohmann::json& description);

// The description in a policy file. Throws Error where there is none, or no JSON, and where the checksum is missing
// that every file of this layout has.
nlohmann::json policy_description(const Safetensors& file);

// Throws Error where the file's description is not the one expected, or its tensors are not as many as the specs. Notes
// that an older file has no checksum.
void require_description(const Safetensors& file, const nlohmann::json& expected, const std::vector<TensorSpec>& specs);

}  // namespace graphdrl
