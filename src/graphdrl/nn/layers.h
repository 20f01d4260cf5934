// The layers around gated graph convolutions, forward and backward. All matrices are row-major and dense; work is
// spread over parallel_for, cut the same for any number of threads.
#pragma once

#include <vector>

#include "graphdrl/nn/graph_batch.h"

namespace graphdrl {

// A linear layer's weights as PyTorch keeps them, or their gradients.
template <typename T>
struct LinearTensors {
  T* weight;  // [outputs, inputs]
  T* bias;    // [outputs]
};

struct LinearShape {
  int inputs;
  int outputs;
};

// out = x Wᵀ + b.  x: [rows, inputs], out: [rows, outputs].
void linear(LinearShape shape, int rows, const float* x, const LinearTensors<const float>& weights, float* out);

// grad_out: [rows, outputs]; grad_x: [rows, inputs], or null where it is not asked for; `grad` is overwritten.
void linear_backward(LinearShape shape, int rows, const float* x, const LinearTensors<const float>& weights,
                     const float* grad_out, float* grad_x, const LinearTensors<float>& grad);

// Sums each graph's rows. x: [N, width], out: [B, width].
void sum_pool(const GraphBatch& batch, int width, const float* x, float* out);
// grad_out: [B, width], grad_x: [N, width].
void sum_pool_backward(const GraphBatch& batch, int width, const float* grad_out, float* grad_x);

// Batch normalisation of columns [Ioffe and Szegedy 2015].
struct BatchNormTensors {
  const float* weight;  // [width]
  const float* bias;    // [width]
};

// What a column is normalised by: (x - mean) · inverse.
struct ColumnStatistics {
  std::vector<float> mean;      // [width]
  std::vector<float> variance;  // [width]; column_statistics() divides by the number of rows
  std::vector<float> inverse;   // [width], 1 / √(variance + epsilon)
};
ColumnStatistics column_statistics(int rows, int width, const float* x, double epsilon);

// out = (x - mean) · inverse · weight + bias.  x, out: [rows, width]; out may be x.
void batch_norm(int rows, int width, const float* x, const ColumnStatistics& statistics,
                const BatchNormTensors& weights, float* out);

// Through the statistics too, which are those of x. x, grad: [rows, width]; grad by the output in, by x out.
// grad_weight, grad_bias: [width], overwritten.
void batch_norm_backward(int rows, int width, const float* x, const ColumnStatistics& statistics,
                         const BatchNormTensors& weights, float* grad, float* grad_weight, float* grad_bias);

}  // namespace graphdrl
