// The kernel of nn/ as an operator that LibTorch can differentiate.
#pragma once

#include <torch/types.h>

#include "graphdrl/nn/gated_graph_conv.h"

namespace graphdrl {

// One layer's weights as leaf tensors, on the memory that the kernel reads.
struct GatedGraphConvLeaves {
  torch::Tensor weight;  // [L, D, D]
  torch::Tensor w_ih;    // [3D, D]
  torch::Tensor w_hh;    // [3D, D]
  torch::Tensor b_ih;    // [3D]
  torch::Tensor b_hh;    // [3D]
};

// x: [N, F] float32 on the CPU; gives [N, D]. The kernel keeps what backward needs, so between this call and its
// backward the layer, the batch and the weights must stay as they are. REQUIRES: layer.set_weights() was given the
// leaves' memory.
torch::Tensor gated_graph_conv(GatedGraphConv<float>& layer, const GraphBatch& batch, const torch::Tensor& x,
                               const GatedGraphConvLeaves& leaves);

}  // namespace graphdrl
