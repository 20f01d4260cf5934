#include "graphdrl/nn/layers.h"

#include <algorithm>
#include <cmath>

#include "graphdrl/base/parallel.h"
#include "graphdrl/nn/gemm.h"

namespace graphdrl {
namespace {

constexpr int kBlockRows = 128;    // a task's share of rows
constexpr int kBlockOutputs = 32;  // a task's share of a weight's rows

int block_count(int rows) {
  return (rows + kBlockRows - 1) / kBlockRows;
}

// task(first row, rows) for each block.
template <typename Task>
void for_blocks(int rows, const Task& task) {
  parallel_for(block_count(rows), [&](int block) {
    const int first = block * kBlockRows;
    task(first, std::min(kBlockRows, rows - first));
  });
}

// Sums of `values` terms over rows, block by block: term(row, sums) adds a row's terms to sums [values].
template <typename Term>
std::vector<double> column_sums(int rows, int values, const Term& term) {
  std::vector<float> partial(static_cast<std::size_t>(block_count(rows)) * values);
  for_blocks(rows, [&](int first, int count) {
    float* const sums = partial.data() + static_cast<std::ptrdiff_t>(first / kBlockRows) * values;
    for (int row = first; row < first + count; ++row) term(row, sums);
  });
  std::vector<double> total(values);
  for (std::size_t i = 0; i < partial.size(); ++i) total[i % values] += partial[i];
  return total;
}

}  // namespace

void linear(LinearShape shape, int rows, const float* x, const LinearTensors<const float>& weights, float* out) {
  const int inputs = shape.inputs;
  const int outputs = shape.outputs;
  static thread_local PackedMatrix<float> packed;
  PackedMatrix<float>& transposed = packed;  // the caller's, for all threads
  transposed.set(inputs, outputs, Op::kTranspose, weights.weight, inputs);
  for_blocks(rows, [&](int first, int count) {
    for (int row = first; row < first + count; ++row) std::copy_n(weights.bias, outputs, row_of(out, row, outputs));
    gemm(Op::kNone, count, outputs, inputs, row_of(x, first, inputs), inputs, transposed, true,
         row_of(out, first, outputs), outputs);
  });
}

void linear_backward(LinearShape shape, int rows, const float* x, const LinearTensors<const float>& weights,
                     const float* grad_out, float* grad_x, const LinearTensors<float>& grad) {
  const int inputs = shape.inputs;
  const int outputs = shape.outputs;
  static thread_local PackedMatrix<float> packed;
  PackedMatrix<float>& right = packed;
  if (grad_x != nullptr) {
    right.set(outputs, inputs, Op::kNone, weights.weight, inputs);
    for_blocks(rows, [&](int first, int count) {
      gemm(Op::kNone, count, inputs, outputs, row_of(grad_out, first, outputs), outputs, right, false,
           row_of(grad_x, first, inputs), inputs);
    });
  }
  right.set(rows, inputs, Op::kNone, x, inputs);
  parallel_for((outputs + kBlockOutputs - 1) / kBlockOutputs, [&](int block) {
    const int first = block * kBlockOutputs;
    gemm(Op::kTranspose, std::min(kBlockOutputs, outputs - first), inputs, rows, grad_out + first, outputs, right,
         false, row_of(grad.weight, first, inputs), inputs);
  });
  std::fill_n(grad.bias, outputs, 0.0f);
  for (int row = 0; row < rows; ++row) {
    const float* const from = row_of(grad_out, row, outputs);
    for (int i = 0; i < outputs; ++i) grad.bias[i] += from[i];
  }
}

void sum_pool(const GraphBatch& batch, int width, const float* x, float* out) {
  parallel_for(batch.graph_count(), [&](int g) {
    float* const sum = row_of(out, g, width);
    std::fill_n(sum, width, 0.0f);
    for (int node = batch.first_node(g); node < batch.first_node(g + 1); ++node) {
      const float* const from = row_of(x, node, width);
      for (int i = 0; i < width; ++i) sum[i] += from[i];
    }
  });
}

void sum_pool_backward(const GraphBatch& batch, int width, const float* grad_out, float* grad_x) {
  parallel_for(batch.graph_count(), [&](int g) {
    for (int node = batch.first_node(g); node < batch.first_node(g + 1); ++node) {
      std::copy_n(row_of(grad_out, g, width), width, row_of(grad_x, node, width));
    }
  });
}

ColumnStatistics column_statistics(int rows, int width, const float* x, double epsilon) {
  ColumnStatistics statistics{
      .mean = std::vector<float>(width), .variance = std::vector<float>(width), .inverse = std::vector<float>(width)};
  const std::vector<double> sums = column_sums(rows, width, [&](int row, float* sum) {
    const float* const from = row_of(x, row, width);
    for (int i = 0; i < width; ++i) sum[i] += from[i];
  });
  for (int i = 0; i < width; ++i) statistics.mean[i] = static_cast<float>(sums[i] / rows);
  const std::vector<double> squares = column_sums(rows, width, [&](int row, float* sum) {
    const float* const from = row_of(x, row, width);
    for (int i = 0; i < width; ++i) {
      const float deviation = from[i] - statistics.mean[i];
      sum[i] += deviation * deviation;
    }
  });
  for (int i = 0; i < width; ++i) {
    statistics.variance[i] = static_cast<float>(squares[i] / rows);
    statistics.inverse[i] = static_cast<float>(1 / std::sqrt(squares[i] / rows + epsilon));
  }
  return statistics;
}

void batch_norm(int rows, int width, const float* x, const ColumnStatistics& statistics,
                const BatchNormTensors& weights, float* out) {
  std::vector<float> scale(width);
  for (int i = 0; i < width; ++i) scale[i] = weights.weight[i] * statistics.inverse[i];
  for_blocks(rows, [&](int first, int count) {
    for (int row = first; row < first + count; ++row) {
      const float* const from = row_of(x, row, width);
      float* const to = row_of(out, row, width);
      for (int i = 0; i < width; ++i) to[i] = (from[i] - statistics.mean[i]) * scale[i] + weights.bias[i];
    }
  });
}

void batch_norm_backward(int rows, int width, const float* x, const ColumnStatistics& statistics,
                         const BatchNormTensors& weights, float* grad, float* grad_weight, float* grad_bias) {
  const float* const mean = statistics.mean.data();
  const float* const inverse = statistics.inverse.data();
  // Σ g, then Σ g · normalised x
  const std::vector<double> sums = column_sums(rows, 2 * width, [&](int row, float* sum) {
    const float* const from = row_of(x, row, width);
    const float* const by_out = row_of(grad, row, width);
    for (int i = 0; i < width; ++i) {
      sum[i] += by_out[i];
      sum[width + i] += by_out[i] * (from[i] - mean[i]) * inverse[i];
    }
  });
  std::vector<float> scale(width);
  std::vector<float> mean_grad(width);
  std::vector<float> slope(width);
  for (int i = 0; i < width; ++i) {
    grad_bias[i] = static_cast<float>(sums[i]);
    grad_weight[i] = static_cast<float>(sums[width + i]);
    scale[i] = weights.weight[i] * inverse[i];
    mean_grad[i] = static_cast<float>(sums[i] / rows);
    slope[i] = static_cast<float>(sums[width + i] / rows) * inverse[i];
  }
  for_blocks(rows, [&](int first, int count) {
    for (int row = first; row < first + count; ++row) {
      const float* const from = row_of(x, row, width);
      float* const by_out = row_of(grad, row, width);
      for (int i = 0; i < width; ++i) {
        by_out[i] = scale[i] * (by_out[i] - mean_grad[i] - (from[i] - mean[i]) * slope[i]);
      }
    }
  });
}

}  // namespace graphdrl
