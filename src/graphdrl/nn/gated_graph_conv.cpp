#include "graphdrl/nn/gated_graph_conv.h"

#include <algorithm>
#include <cstddef>

#include "graphdrl/base/parallel.h"
#include "graphdrl/nn/gemm.h"
#include "graphdrl/nn/vector_math.h"

namespace graphdrl {
namespace {

// Nodes after which a chunk is closed: 2 grids of 5×5; rows enough for the matrix products to run at full speed, few
// enough for a chunk's gates to stay in a core's second-level cache.
constexpr int kChunkNodes = 48;

// Rows of gates that a gradient's product packs at a time; they stay in the second-level cache.
constexpr int kBlockNodes = 200;

// Block order of PyTorch's GRU weights (r, z, n), by position in the order used here (n, r, z).
constexpr int kTorchBlock[3] = {2, 0, 1};

void grow(std::vector<float>& buffer, std::size_t size) {
  if (buffer.size() < size) buffer.resize(size);
}

// The sums within each graph of a chunk. in, out: [nodes, columns] with rows `width` apart, starting at the chunk's
// first node.
void sum_neighbours(const GraphBatch& batch, int first_graph, int graph_count, int columns, int width, const float* in,
                    bool accumulate, float* out) {
  for (int g = first_graph; g < first_graph + graph_count; ++g) {
    const std::ptrdiff_t base = (batch.first_node(g) - batch.first_node(first_graph)) * std::ptrdiff_t{width};
    sum_neighbours(batch.graph(g), columns, width, in + base, accumulate, out + base);
  }
}

}  // namespace

GatedGraphConv::GatedGraphConv(GatedGraphConvShape shape)
    : shape_(shape), folded_(shape.steps), bias_(4 * static_cast<std::size_t>(shape.width)) {}

void GatedGraphConv::set_weights(const GatedGraphConvTensors<const float>& weights) {
  weights_ = weights;
  const int width = shape_.width;
  const std::ptrdiff_t square = static_cast<std::ptrdiff_t>(width) * width;
  w_ih_.reset(width, 3 * width);
  parallel_for(4, [&](int task) {
    if (task < 3) {
      w_ih_.set_columns(task * width, width, Op::kTranspose, weights.w_ih + kTorchBlock[task] * square, width);
    } else {
      w_hh_reset_update_.set(width, 2 * width, Op::kTranspose, weights.w_hh, width);
      w_hh_new_.set(width, width, Op::kTranspose, weights.w_hh + 2 * square, width);
    }
  });
  parallel_for(shape_.steps,
               [&](int step) { gemm(width, weights.weight + step * square, width, w_ih_, folded_[step]); });
  for (int i = 0; i < width; ++i) {
    bias_[i] = weights.b_ih[2 * width + i];                                    // n
    bias_[width + i] = weights.b_ih[i] + weights.b_hh[i];                      // r
    bias_[2 * width + i] = weights.b_ih[width + i] + weights.b_hh[width + i];  // z
    bias_[3 * width + i] = weights.b_hh[2 * width + i];                        // hn
  }
}

void GatedGraphConv::cut_into_chunks(const GraphBatch& batch) {
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

void GatedGraphConv::forward(const GraphBatch& batch, const float* x, float* out, bool keep) {
  const std::size_t values = static_cast<std::size_t>(keep ? shape_.steps : 1) * batch.node_count() * shape_.width;
  grow(state_, values);
  grow(message_, values);
  grow(gates_, 4 * values);
  cut_into_chunks(batch);
  parallel_for(static_cast<int>(chunks_.size()),
               [&](int index) { forward_chunk(batch, chunks_[index], x, out, keep); });
}

void GatedGraphConv::forward_chunk(const GraphBatch& batch, const Chunk& chunk, const float* x, float* out, bool keep) {
  const int width = shape_.width;
  const int rows = chunk.node_count;
  const std::ptrdiff_t first = static_cast<std::ptrdiff_t>(chunk.first_node) * width;
  const std::ptrdiff_t stride = keep ? static_cast<std::ptrdiff_t>(batch.node_count()) * width : 0;  // a step's values

  float* const padded = state_.data() + first;
  for (int row = 0; row < rows; ++row) {
    const float* const from = x + (static_cast<std::ptrdiff_t>(chunk.first_node) + row) * shape_.inputs;
    float* const to = padded + static_cast<std::ptrdiff_t>(row) * width;
    std::copy(from, from + shape_.inputs, to);
    std::fill(to + shape_.inputs, to + width, 0.0f);
  }
  for (int step = 0; step < shape_.steps; ++step) {
    const int live = live_columns(step);
    const float* const h = state_.data() + step * stride + first;
    float* const message = message_.data() + step * stride + first;
    float* const gates = gates_.data() + 4 * (step * stride + first);
    sum_neighbours(batch, chunk.first_graph, chunk.graph_count, live, width, h, false, message);
    // (A h) P_l into n, r, z; h W_hhᵀ added to r, z and put into hn
    gemm(Op::kNone, rows, 3 * width, live, message, width, folded_[step], false, gates, 4 * width);
    gemm(Op::kNone, rows, 2 * width, live, h, width, w_hh_reset_update_, true, gates + width, 4 * width);
    gemm(Op::kNone, rows, width, live, h, width, w_hh_new_, false, gates + 3 * width, 4 * width);
    float* const next = step + 1 == shape_.steps ? out + first : state_.data() + (step + 1) * stride + first;
    gru_forward(rows, width, bias_.data(), gates, h, next);
  }
  if (shape_.elu) elu(out + first, static_cast<std::size_t>(rows) * width);
}

void GatedGraphConv::backward(const GraphBatch& batch, const float* out, const float* grad_out, float* grad_x,
                              const GatedGraphConvTensors<float>& grad) {
  const int nodes = batch.node_count();
  const std::size_t values = static_cast<std::size_t>(nodes) * shape_.width;
  grow(grad_, values);
  grow(scratch_, values);
  const std::ptrdiff_t square = static_cast<std::ptrdiff_t>(shape_.width) * shape_.width;
  folded_grad_.resize(shape_.steps * 3 * square);
  w_hh_grad_.resize(shape_.steps * 3 * square);
  bias_grad_.resize(shape_.steps * bias_.size());
  folded_transposed_.resize(shape_.steps);
  parallel_for(shape_.steps + 1, [&](int task) {
    if (task < shape_.steps) {
      folded_transposed_[task].set_transposed(folded_[task]);
    } else {
      w_hh_.set(3 * shape_.width, shape_.width, Op::kNone, weights_.w_hh, shape_.width);
    }
  });
  parallel_for(static_cast<int>(chunks_.size()),
               [&](int index) { backward_chunk(batch, chunks_[index], out, grad_out, grad_x); });
  parallel_for(4 * shape_.steps, [&](int task) { weight_products(task / 4, task % 4, nodes); });
  unfold(grad);
}

void GatedGraphConv::backward_chunk(const GraphBatch& batch, const Chunk& chunk, const float* out,
                                    const float* grad_out, float* grad_x) {
  const int width = shape_.width;
  const int rows = chunk.node_count;
  const std::ptrdiff_t first = static_cast<std::ptrdiff_t>(chunk.first_node) * width;
  const std::ptrdiff_t stride = static_cast<std::ptrdiff_t>(batch.node_count()) * width;
  float* const grad = grad_.data() + first;
  float* const by_message = scratch_.data() + first;
  std::copy(grad_out + first, grad_out + first + static_cast<std::ptrdiff_t>(rows) * width, grad);
  if (shape_.elu) elu_backward(out + first, grad, static_cast<std::size_t>(rows) * width);
  for (int step = shape_.steps - 1; step >= 0; --step) {
    const int live = live_columns(step);
    float* const gates = gates_.data() + 4 * (step * stride + first);
    gru_backward(rows, width, gates, state_.data() + step * stride + first, grad);
    if (step == 0 && grad_x == nullptr) return;
    // by h: through the gates' own share, dgates W_hh, and through the message, Aᵀ (dgates P_lᵀ), where Aᵀ = A
    gemm(Op::kNone, rows, live, 3 * width, gates, 4 * width, folded_transposed_[step], false, by_message, width);
    gemm(Op::kNone, rows, live, 3 * width, gates + width, 4 * width, w_hh_, true, grad, width);
    sum_neighbours(batch, chunk.first_graph, chunk.graph_count, live, width, by_message, true, grad);
  }
  for (int row = 0; row < rows; ++row) {
    const float* const from = grad + static_cast<std::ptrdiff_t>(row) * width;
    std::copy(from, from + shape_.inputs,
              grad_x + (static_cast<std::ptrdiff_t>(chunk.first_node) + row) * shape_.inputs);
  }
}

void GatedGraphConv::weight_products(int step, int gate, int nodes) {
  const int width = shape_.width;
  const int live = live_columns(step);
  const std::ptrdiff_t stride = static_cast<std::ptrdiff_t>(nodes) * width;
  const std::ptrdiff_t offset = static_cast<std::ptrdiff_t>(step) * 3 * width * width;
  float* const by_folded = folded_grad_.data() + offset + gate * width;               // n, r, z
  float* const by_w_hh = w_hh_grad_.data() + offset + std::max(gate - 1, 0) * width;  // r, z, hn
  float* const by_bias = bias_grad_.data() + (static_cast<std::ptrdiff_t>(step) * 4 + gate) * width;
  const bool in_message = gate < 3;
  const bool in_state = gate > 0;
  for (int row = live; row < width; ++row) {  // the state is still padding there
    if (in_message) std::fill_n(by_folded + static_cast<std::ptrdiff_t>(row) * 3 * width, width, 0.0f);
    if (in_state) std::fill_n(by_w_hh + static_cast<std::ptrdiff_t>(row) * 3 * width, width, 0.0f);
  }
  std::fill_n(by_bias, width, 0.0f);
  static thread_local PackedMatrix<float> dgates;
  for (int first = 0; first < nodes; first += kBlockNodes) {
    const int count = std::min(kBlockNodes, nodes - first);
    const std::ptrdiff_t rows = step * stride + static_cast<std::ptrdiff_t>(first) * width;
    const float* const block = gates_.data() + 4 * rows + gate * width;
    dgates.set(count, width, Op::kNone, block, 4 * width);
    if (in_message) {
      gemm(Op::kTranspose, live, width, count, message_.data() + rows, width, dgates, first > 0, by_folded, 3 * width);
    }
    if (in_state) {
      gemm(Op::kTranspose, live, width, count, state_.data() + rows, width, dgates, first > 0, by_w_hh, 3 * width);
    }
    for (int node = 0; node < count; ++node) {
      const float* const row = block + static_cast<std::ptrdiff_t>(node) * 4 * width;
#pragma omp simd
      for (int i = 0; i < width; ++i) by_bias[i] += row[i];
    }
  }
}

void GatedGraphConv::unfold(const GatedGraphConvTensors<float>& grad) {
  const int width = shape_.width;
  const int steps = shape_.steps;
  const std::ptrdiff_t square = static_cast<std::ptrdiff_t>(width) * width;
  parallel_for(steps + 6, [&](int task) {
    if (task < steps) {  // by Θ_l: Σ over gates of dP_l W_ih
      for (int block = 0; block < 3; ++block) {
        gemm(Op::kNone, Op::kNone, width, width, width, folded_grad_.data() + task * 3 * square + block * width,
             3 * width, weights_.w_ih + kTorchBlock[block] * square, width, block > 0, grad.weight + task * square,
             width);
      }
    } else if (task < steps + 3) {  // by W_ih: Σ_l dP_lᵀ Θ_l
      const int block = task - steps;
      for (int step = 0; step < steps; ++step) {
        gemm(Op::kTranspose, Op::kNone, width, width, width, folded_grad_.data() + step * 3 * square + block * width,
             3 * width, weights_.weight + step * square, width, step > 0, grad.w_ih + kTorchBlock[block] * square,
             width);
      }
    } else {  // by W_hh: the sum over l, transposed
      const int block = task - steps - 3;
      float* const out = grad.w_hh + block * square;
      for (int step = 0; step < steps; ++step) {
        const float* const in = w_hh_grad_.data() + step * 3 * square + block * width;
        for (int column = 0; column < width; ++column) {
          float* const row = out + static_cast<std::ptrdiff_t>(column) * width;
          for (int i = 0; i < width; ++i) {
            const float value = in[static_cast<std::ptrdiff_t>(i) * 3 * width + column];
            row[i] = step == 0 ? value : row[i] + value;
          }
        }
      }
    }
  });
  for (int step = 1; step < steps; ++step) {
    for (int i = 0; i < 4 * width; ++i) bias_grad_[i] += bias_grad_[static_cast<std::size_t>(step) * 4 * width + i];
  }
  const float* const n = bias_grad_.data();
  const float* const r_z = n + width;
  const float* const hn = n + 3 * width;
  std::copy_n(r_z, 2 * width, grad.b_ih);
  std::copy_n(r_z, 2 * width, grad.b_hh);
  std::copy_n(n, width, grad.b_ih + 2 * width);
  std::copy_n(hn, width, grad.b_hh + 2 * width);
}

}  // namespace graphdrl
