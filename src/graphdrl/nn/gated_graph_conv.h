// The gated graph convolution [Li et al. 2015; paper, eq. 7], forward and backward, with the semantics of PyTorch
// Geometric's GatedGraphConv: the input is padded with zeros to the layer's width; then, for l = 0 … L-1,
//   m_i = Σ_{j in N(i)} h_j Θ_l,   h = GRU(m, h).
// Each step has its own Θ_l; all steps share one GRU cell. Biases are added to nodes without neighbours too. A layer
// can apply ELU to the last h, while it is still in cache.
//
// How it is computed: a step is gates = (A h) P_l + h W_hhᵀ + b with P_l = Θ_l W_ihᵀ, folded once per set of weights,
// so that a node costs 6 D² multiplications a step instead of 7 D². Nodes are cut into chunks of whole graphs that stay
// in cache; one thread takes a chunk through all steps. Gradients of weights are products over all nodes, cut by
// columns. Neither cut depends on the number of threads, so results do not either.
#pragma once

#include <span>
#include <vector>

#include "graphdrl/nn/gemm.h"
#include "graphdrl/nn/graph_batch.h"

namespace graphdrl {

// Views of one layer's weights, or of their gradients; layouts and names as in PyTorch.
template <typename T>
struct GatedGraphConvTensors {
  T* weight;  // [L, D, D], Θ
  T* w_ih;    // [3D, D], gates in the order r, z, n
  T* w_hh;    // [3D, D]
  T* b_ih;    // [3D]
  T* b_hh;    // [3D]
};

struct GatedGraphConvShape {
  int inputs;        // F <= D
  int width;         // D
  int steps;         // L >= 1
  bool elu = false;  // of the output
};

// One layer's folded weights and what it keeps from forward to backward; memory grows to the largest batch seen and is
// then reused. Not thread safe; it spreads its work over parallel_for by itself.
class GatedGraphConv {
 public:
  explicit GatedGraphConv(GatedGraphConvShape shape);

  // Takes the weights for all later calls; they are read again by backward(), so they must stay until then.
  void set_weights(const GatedGraphConvTensors<const float>& weights);

  // x: [N, F], out: [N, D]. With `keep`, everything backward() needs stays in the layer, L times the memory.
  // REQUIRES: set_weights() was called; every graph is undirected.
  void forward(const GraphBatch& batch, const float* x, float* out, bool keep);

  // After forward(batch, …, keep = true), once. out, grad_out: [N, D], the output and the loss's derivative by it;
  // grad_x: [N, F] or null where it is not asked for; the gradients of the weights are overwritten.
  void backward(const GraphBatch& batch, const float* out, const float* grad_out, float* grad_x,
                const GatedGraphConvTensors<float>& grad);

 private:
  struct Chunk {
    int first_graph;
    int graph_count;
    int first_node;
    int node_count;
  };

  void cut_into_chunks(const GraphBatch& batch);
  void forward_chunk(const GraphBatch& batch, const Chunk& chunk, const float* x, float* out, bool keep);
  void backward_chunk(const GraphBatch& batch, const Chunk& chunk, const float* out, const float* grad_out,
                      float* grad_x);
  void weight_products(int step, int gate, int nodes);
  void unfold(const GatedGraphConvTensors<float>& grad);

  // Columns of h that can differ from 0 before step l.
  int live_columns(int step) const { return step == 0 ? shape_.inputs : shape_.width; }

  GatedGraphConvShape shape_;
  GatedGraphConvTensors<const float> weights_{};
  PackedMatrix<float> w_ih_;                            // W_ihᵀ: [D, 3D], columns in the order n, r, z
  PackedMatrix<float> w_hh_reset_update_;               // W_hhᵀ: [D, 2D], r and z
  PackedMatrix<float> w_hh_new_;                        // [D, D], hn
  PackedMatrix<float> w_hh_;                            // W_hh: [3D, D]; for backward only
  std::vector<PackedMatrix<float>> folded_;             // P_l: [D, 3D], columns in the order n, r, z
  std::vector<PackedMatrix<float>> folded_transposed_;  // P_lᵀ: [3D, D]; for backward only
  std::vector<float> bias_;                             // [4D], in the order n, r, z, hn
  std::vector<float> folded_grad_;                      // by P: [L, D, 3D]
  std::vector<float> w_hh_grad_;                        // by W_hhᵀ, a step's share each: [L, D, 3D], r, z, hn
  std::vector<float> bias_grad_;                        // [L, 4D]
  std::vector<Chunk> chunks_;
  std::vector<float> state_;    // h before step l: [L, N, D]; without keep only [N, D]
  std::vector<float> message_;  // A h: likewise
  std::vector<float> gates_;    // [L, N, 4D]; likewise
  std::vector<float> grad_;     // by the state: [N, D]
  std::vector<float> scratch_;  // by the message: [N, D]
};

}  // namespace graphdrl
