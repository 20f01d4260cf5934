// The elementwise loops of networks and sums over neighbours, as vector code chosen at run time (plain, AVX2, AVX-512).
#pragma once

#include <cstddef>

#include "graphdrl/graph/graph.h"

namespace graphdrl {

// The four gate inputs of a GRU cell stand side by side in one row, [n | r | z | hn], D values each, so that the
// product with the message fills the first three and the product with the state adds to the last three. gru_forward
// adds the biases, in the same order; after it they hold n, r, z and the state's share of n; after gru_backward the
// loss's derivative by the four inputs.

// h' = (1 - z) n + z h,  r = σ(r),  z = σ(z),  n = tanh(n + r · hn)  [Cho et al. 2014, as PyTorch's GRUCell]
// gates: [rows, 4D] in and out; bias: [4D]; h: [rows, D]; h_next: [rows, D], may be h itself.
void gru_forward(int rows, int width, const float* bias, float* gates, const float* h, float* h_next);

// gates: [rows, 4D], from gru_forward in, derivatives out; h: [rows, D], the state before the step;
// grad: [rows, D], by h' in, by h through the z gate alone out.
void gru_backward(int rows, int width, float* gates, const float* h, float* grad);

// out[i] = Σ_{j in N(i)} in[j], or out[i] += …; in, out: [nodes, columns] with rows `width` apart
// REQUIRES: in and out do not overlap.
void sum_neighbours(const Graph& graph, int columns, int width, const float* in, bool accumulate, float* out);

// x = x > 0 ? x : exp(x) - 1  [Clevert et al. 2015]
void elu(float* x, std::size_t count);

// grad, by elu(x) in, by x out; y: elu(x)
void elu_backward(const float* y, float* grad, std::size_t count);

inline constexpr double kAdamBeta1 = 0.9;
inline constexpr double kAdamBeta2 = 0.999;
inline constexpr double kAdamEpsilon = 1e-8;
inline constexpr double kGradientClamp = 1.0;  // gradients are cut to ±1 first, one by one, as in the author's code

// m = β1 m + (1 - β1) g,  v = β2 v + (1 - β2) g²,  θ -= rate · m / (√v · second_scale + ε)  [Kingma and Ba 2015]
// The bias corrections of step t are in rate = learning rate / (1 - β1^t) and second_scale = 1 / √(1 - β2^t).
void adam_update(float rate, float second_scale, const float* grad, float* first, float* second, float* value,
                 std::size_t count);

// value += share · (goal - value)
void move_towards(const float* goal, float share, float* value, std::size_t count);

}  // namespace graphdrl
