// The paper's Q-network composed of LibTorch's own operators: for every device that LibTorch has, and the reference
// that the kernels are tested against.
#pragma once

#include <torch/types.h>

#include <map>
#include <string>

#include "graphdrl/nn/graph_batch.h"
#include "graphdrl/nn/paper_network.h"

namespace graphdrl {

// The network's tensors by PyTorch's names.
using NamedTensors = std::map<std::string, torch::Tensor>;

// Views of a flat buffer [all] of parameters and running statistics. With `gradients` [240678], the trainable ones are
// leaves whose gradients add up there.
NamedTensors named_tensors(const torch::Tensor& values, const torch::Tensor& gradients = {});

// A batch's edges and the graph of each node, as tensors.
struct EdgeIndex {
  torch::Tensor from;      // [2E] int64, rows of a batch's nodes; both directions of every edge
  torch::Tensor to;        // [2E]
  torch::Tensor graph_of;  // [N], a node's graph
  std::int64_t graph_count;
};
EdgeIndex edge_index(const GraphBatch& batch, torch::Device device);

// One gated graph convolution without its ELU [paper, eq. 7]: that of the tensors NAME.weight [L, D, D] and NAME.rnn.*,
// as PyTorch Geometric has them. x: [N, F], F <= D; gives [N, D].
torch::Tensor composed_conv(const EdgeIndex& edges, const torch::Tensor& x, const NamedTensors& tensors,
                            const std::string& name);

// q [B, A] of x [N, F]. With `keep_scale` [B, 256] in train mode, as PaperQNetwork::forward_train; without it in eval
// mode.
torch::Tensor composed_q_values(const EdgeIndex& edges, const torch::Tensor& x, const NamedTensors& tensors,
                                const torch::Tensor& keep_scale = {});

}  // namespace graphdrl
