#include "graphdrl/nn/gated_graph_conv.h"

#include <algorithm>
#include <cstddef>

#include "graphdrl/base/parallel.h"
#include "graphdrl/nn/gemm.h"
#include "graphdrl/nn/vector_math.h"

namespace graphdrl {
namespace {

// Nodes after which a chunk is closed: 4 grids of 5×5; rows enough for the matrix products to run at full speed, few
// enough for a chunk's gates to stay in a core's second-level cache.
constexpr int kChunkNodes = 96;

// Block order of PyTorch's GRU weights (r, z, n), by position in the order used here (n, r, z).
constexpr int kTorchBlock[3] = {2, 0, 1};

template <typename T>
void grow(std::vector<T>& buffer, std::size_t size) {
  if (buffer.size() < size) buffer.resize(size);
}

// out[i] += Σ_{j in N(i)} in[j] within one chunk. in, out: [nodes, columns] with rows `width` apart, starting at the
// chunk's first node.
template <typename T>
void add_neighbours(const GraphBatch& batch, int first_graph, int graph_count, int columns, int width, const T* in,
                    T* out) {
  for (int g = first_graph; g < first_graph + graph_count; ++g) {
    const Graph& graph = batch.graph(g);
    const std::ptrdiff_t base = batch.first_node(g) - batch.first_node(first_graph);
    for (NodeId node = 0; node < graph.node_count(); ++node) {
      T* const row = out + (base + node) * width;
      for (const NodeId next : graph.neighbours(node)) {
        const T* const from = in + (base + next) * width;
#pragma omp simd
        for (int i = 0; i < columns; ++i) row[i] += from[i];
      }
    }
  }
}

}  // namespace

template <typename T>
GatedGraphConv<T>::GatedGraphConv(GatedGraphConvShape shape) : shape_(shape) {
  const std::size_t square = static_cast<std::size_t>(shape.width) * shape.width;
  folded_.resize(shape.steps * 3 * square);
  bias_.resize(4 * static_cast<std::size_t>(shape.width));
}

template <typename T>
void GatedGraphConv<T>::set_weights(const GatedGraphConvTensors<const T>& weights) {
  weights_ = weights;
  const int width = shape_.width;
  const std::ptrdiff_t square = static_cast<std::ptrdiff_t>(width) * width;
  parallel_for(shape_.steps * 3, [&](int task) {  // P_l = Θ_l W_ihᵀ, a gate at a time
    const int step = task / 3;
    const int block = task % 3;
    gemm(Op::kNone, Op::kTranspose, width, width, width, weights.weight + step * square, width,
         weights.w_ih + kTorchBlock[block] * square, width, T{0}, folded_.data() + step * 3 * square + block * width,
         3 * width);
  });
  for (int i = 0; i < width; ++i) {
    bias_[i] = weights.b_ih[2 * width + i];                                    // n
    bias_[width + i] = weights.b_ih[i] + weights.b_hh[i];                      // r
    bias_[2 * width + i] = weights.b_ih[width + i] + weights.b_hh[width + i];  // z
    bias_[3 * width + i] = weights.b_hh[2 * width + i];                        // hn
  }
}

template <typename T>
void GatedGraphConv<T>::cut_into_chunks(const GraphBatch& batch) {
  chunks_.clear();
  Chunk chunk{};
  for (int g = 0; g < batch.graph_count(); ++g) {
    ++chunk.graph_count;
    chunk.node_count += batch.graph(g).node_count();
    if (chunk.node_count >= kChunkNodes || g + 1 == batch.graph_count()) {
      chunks_.push_back(chunk);
      chunk = {.first_graph = g + 1, .graph_count = 0, .first_node = batch.first_node(g + 1), .node_count = 0};
    }
  }
}

template <typename T>
void GatedGraphConv<T>::forward(const GraphBatch& batch, const T* x, T* out, bool keep) {
  const std::size_t values = static_cast<std::size_t>(keep ? shape_.steps : 1) * batch.node_count() * shape_.width;
  grow(state_, values);
  grow(message_, values);
  grow(gates_, 4 * values);
  cut_into_chunks(batch);
  parallel_for(static_cast<int>(chunks_.size()),
               [&](int index) { forward_chunk(batch, chunks_[index], x, out, keep); });
}

template <typename T>
void GatedGraphConv<T>::forward_chunk(const GraphBatch& batch, const Chunk& chunk, const T* x, T* out, bool keep) {
  const int width = shape_.width;
  const int rows = chunk.node_count;
  const std::ptrdiff_t first = static_cast<std::ptrdiff_t>(chunk.first_node) * width;
  const std::ptrdiff_t stride = keep ? static_cast<std::ptrdiff_t>(batch.node_count()) * width : 0;  // a step's values

  T* const padded = state_.data() + first;
  for (int row = 0; row < rows; ++row) {
    const T* const from = x + (static_cast<std::ptrdiff_t>(chunk.first_node) + row) * shape_.inputs;
    T* const to = padded + static_cast<std::ptrdiff_t>(row) * width;
    std::copy(from, from + shape_.inputs, to);
    std::fill(to + shape_.inputs, to + width, T{0});
  }
  for (int step = 0; step < shape_.steps; ++step) {
    const int live = live_columns(step);
    const T* const h = state_.data() + step * stride + first;
    T* const message = message_.data() + step * stride + first;
    T* const gates = gates_.data() + 4 * (step * stride + first);
    std::fill_n(message, static_cast<std::ptrdiff_t>(rows) * width, T{0});
    add_neighbours(batch, chunk.first_graph, chunk.graph_count, live, width, h, message);
    // (A h) P_l into n, r, z; h W_hhᵀ added to r, z, hn
    for (int row = 0; row < rows; ++row) {
      std::fill_n(gates + (static_cast<std::ptrdiff_t>(row) * 4 + 3) * width, width, T{0});
    }
    gemm(Op::kNone, Op::kNone, rows, 3 * width, live, message, width,
         folded_.data() + static_cast<std::ptrdiff_t>(step) * 3 * width * width, 3 * width, T{0}, gates, 4 * width);
    gemm(Op::kNone, Op::kTranspose, rows, 3 * width, live, h, width, weights_.w_hh, width, T{1}, gates + width,
         4 * width);
    T* const next = step + 1 == shape_.steps ? out + first : state_.data() + (step + 1) * stride + first;
    gru_forward(rows, width, bias_.data(), gates, h, next);
  }
  if (shape_.elu) elu(out + first, static_cast<std::size_t>(rows) * width);
}

template <typename T>
void GatedGraphConv<T>::backward(const GraphBatch& batch, const T* out, const T* grad_out, T* grad_x,
                                 const GatedGraphConvTensors<T>& grad) {
  const int nodes = batch.node_count();
  const std::size_t values = static_cast<std::size_t>(nodes) * shape_.width;
  grow(grad_, values);
  grow(scratch_, values);
  folded_grad_.resize(folded_.size());
  bias_grad_.resize(shape_.steps * bias_.size());
  parallel_for(static_cast<int>(chunks_.size()),
               [&](int index) { backward_chunk(batch, chunks_[index], out, grad_out, grad_x); });
  weight_products(nodes, grad);
  unfold(grad);
  sum_biases(nodes, grad);
}

template <typename T>
void GatedGraphConv<T>::backward_chunk(const GraphBatch& batch, const Chunk& chunk, const T* out, const T* grad_out,
                                       T* grad_x) {
  const int width = shape_.width;
  const int rows = chunk.node_count;
  const std::ptrdiff_t first = static_cast<std::ptrdiff_t>(chunk.first_node) * width;
  const std::ptrdiff_t stride = static_cast<std::ptrdiff_t>(batch.node_count()) * width;
  T* const grad = grad_.data() + first;
  T* const by_message = scratch_.data() + first;
  std::copy(grad_out + first, grad_out + first + static_cast<std::ptrdiff_t>(rows) * width, grad);
  if (shape_.elu) elu_backward(out + first, grad, static_cast<std::size_t>(rows) * width);
  for (int step = shape_.steps - 1; step >= 0; --step) {
    const int live = live_columns(step);
    T* const gates = gates_.data() + 4 * (step * stride + first);
    gru_backward(rows, width, gates, state_.data() + step * stride + first, grad);
    if (step == 0 && grad_x == nullptr) return;
    // by h: through the gates' own share, dgates W_hh, and through the message, Aᵀ (dgates P_lᵀ), where Aᵀ = A
    gemm(Op::kNone, Op::kTranspose, rows, live, 3 * width, gates, 4 * width,
         folded_.data() + static_cast<std::ptrdiff_t>(step) * 3 * width * width, 3 * width, T{0}, by_message, width);
    gemm(Op::kNone, Op::kNone, rows, live, 3 * width, gates + width, 4 * width, weights_.w_hh, width, T{1}, grad,
         width);
    add_neighbours(batch, chunk.first_graph, chunk.graph_count, live, width, by_message, grad);
  }
  for (int row = 0; row < rows; ++row) {
    const T* const from = grad + static_cast<std::ptrdiff_t>(row) * width;
    std::copy(from, from + shape_.inputs,
              grad_x + (static_cast<std::ptrdiff_t>(chunk.first_node) + row) * shape_.inputs);
  }
}

template <typename T>
void GatedGraphConv<T>::weight_products(int nodes, const GatedGraphConvTensors<T>& grad) {
  const int width = shape_.width;
  const std::ptrdiff_t square = static_cast<std::ptrdiff_t>(width) * width;
  const std::ptrdiff_t stride = static_cast<std::ptrdiff_t>(nodes) * width;
  // A task is one gate's block: three of W_hh first, which sum over the steps, then three of every P_l.
  parallel_for(3 + 3 * shape_.steps, [&](int task) {
    const int block = task % 3;
    if (task < 3) {  // by W_hh: Σ_l dgatesᵀ h_l
      T* const out = grad.w_hh + block * square;
      std::fill_n(out, square, T{0});
      for (int step = shape_.steps - 1; step >= 0; --step) {
        gemm(Op::kTranspose, Op::kNone, width, live_columns(step), nodes,
             gates_.data() + 4 * step * stride + (1 + block) * width, 4 * width, state_.data() + step * stride, width,
             T{1}, out, width);
      }
    } else {  // by P_l: (A h_l)ᵀ dgates, with rows of zeros where the state is still padding
      const int step = task / 3 - 1;
      const int live = live_columns(step);
      T* const out = folded_grad_.data() + step * 3 * square + block * width;
      gemm(Op::kTranspose, Op::kNone, live, width, nodes, message_.data() + step * stride, width,
           gates_.data() + 4 * step * stride + block * width, 4 * width, T{0}, out, 3 * width);
      for (int row = live; row < width; ++row) {
        std::fill_n(out + static_cast<std::ptrdiff_t>(row) * 3 * width, width, T{0});
      }
    }
  });
}

template <typename T>
void GatedGraphConv<T>::unfold(const GatedGraphConvTensors<T>& grad) {
  const int width = shape_.width;
  const std::ptrdiff_t square = static_cast<std::ptrdiff_t>(width) * width;
  parallel_for(shape_.steps + 3, [&](int task) {
    if (task < shape_.steps) {  // by Θ_l: Σ over gates of dP_l W_ih
      for (int block = 0; block < 3; ++block) {
        gemm(Op::kNone, Op::kNone, width, width, width, folded_grad_.data() + task * 3 * square + block * width,
             3 * width, weights_.w_ih + kTorchBlock[block] * square, width, block == 0 ? T{0} : T{1},
             grad.weight + task * square, width);
      }
    } else {  // by W_ih: Σ_l dP_lᵀ Θ_l
      const int block = task - shape_.steps;
      for (int step = 0; step < shape_.steps; ++step) {
        gemm(Op::kTranspose, Op::kNone, width, width, width, folded_grad_.data() + step * 3 * square + block * width,
             3 * width, weights_.weight + step * square, width, step == 0 ? T{0} : T{1},
             grad.w_ih + kTorchBlock[block] * square, width);
      }
    }
  });
}

template <typename T>
void GatedGraphConv<T>::sum_biases(int nodes, const GatedGraphConvTensors<T>& grad) {
  const int width = shape_.width;
  const int columns = 4 * width;
  parallel_for(shape_.steps, [&](int step) {
    T* const sum = bias_grad_.data() + static_cast<std::ptrdiff_t>(step) * columns;
    std::fill_n(sum, columns, T{0});
    const T* row = gates_.data() + static_cast<std::ptrdiff_t>(step) * nodes * columns;
    for (int node = 0; node < nodes; ++node, row += columns) {
#pragma omp simd
      for (int i = 0; i < columns; ++i) sum[i] += row[i];
    }
  });
  for (int step = 1; step < shape_.steps; ++step) {
    for (int i = 0; i < columns; ++i) bias_grad_[i] += bias_grad_[static_cast<std::size_t>(step) * columns + i];
  }
  const T* const n = bias_grad_.data();
  const T* const r_z = n + width;
  const T* const hn = n + 3 * width;
  std::copy_n(r_z, 2 * width, grad.b_ih);
  std::copy_n(r_z, 2 * width, grad.b_hh);
  std::copy_n(n, width, grad.b_ih + 2 * width);
  std::copy_n(hn, width, grad.b_hh + 2 * width);
}

template class GatedGraphConv<float>;
template class GatedGraphConv<double>;

}  // namespace graphdrl
