#include "graphdrl/nn/vector_math.h"

#include <bit>
#include <cmath>
#include <cstdint>
#include <span>

// One clone of a function per instruction set, the best one picked when the program starts. Sanitizers run before that
// choice can be made.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define GRAPHDRL_VECTOR_CLONES __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define GRAPHDRL_VECTOR_CLONES
#endif
#define GRAPHDRL_INLINE [[gnu::always_inline]] inline

namespace graphdrl {
namespace {

template <typename T>
GRAPHDRL_INLINE T clamp(T x, T limit) {
  x = x < -limit ? -limit : x;
  return x > limit ? limit : x;
}

GRAPHDRL_INLINE double exponential(double x) {
  return std::exp(x);
}

GRAPHDRL_INLINE double exponential_within_87(double x) {
  return std::exp(x);
}

// exp(x) = 2^k exp(f), k = round(x / ln 2), |f| <= ln(2) / 2, with a polynomial of degree 6 for exp(f); relative error
// below 3e-7. Written without branches or calls, so that loops over it become vector code. REQUIRES: |x| <= 87.
GRAPHDRL_INLINE float exponential_within_87(float x) {
  constexpr float kLog2E = 1.44269504f;
  constexpr float kLn2High = 0.693359375f;  // the two parts of ln 2: the first multiplies k exactly
  constexpr float kLn2Low = -2.12194440e-4f;
  constexpr float kRound = 12582912.0f;  // 1.5 · 2^23: adding it leaves the nearest integer in the low bits
  const float shifted = x * kLog2E + kRound;
  const float k = shifted - kRound;
  const float f = (x - k * kLn2High) - k * kLn2Low;
  float p = 1.0f / 720;  // Taylor's coefficients 1 / i!
  p = p * f + 1.0f / 120;
  p = p * f + 1.0f / 24;
  p = p * f + 1.0f / 6;
  p = p * f + 0.5f;
  p = p * f + 1.0f;
  p = p * f + 1.0f;
  const std::int32_t bits = std::bit_cast<std::int32_t>(p) + (std::bit_cast<std::int32_t>(shifted) << 23);
  return std::bit_cast<float>(bits);
}

GRAPHDRL_INLINE float exponential(float x) {
  return exponential_within_87(clamp(x, 87.0f));
}

template <typename T>
GRAPHDRL_INLINE T hyperbolic_tangent(T x) {
  return T{1} - T{2} / (T{1} + exponential(T{2} * x));
}

template <typename T>
GRAPHDRL_INLINE void gru_forward_rows(int rows, int width, const T* bias, T* gates, const T* h, T* h_next) {
  for (int row = 0; row < rows; ++row) {
    T* const n = gates + static_cast<std::ptrdiff_t>(row) * 4 * width;
    T* const r = n + width;
    T* const z = r + width;
    T* const hn = z + width;
    const T* const state = h + static_cast<std::ptrdiff_t>(row) * width;
    T* const next = h_next + static_cast<std::ptrdiff_t>(row) * width;
#pragma omp simd
    for (int i = 0; i < width; ++i) {
      // The two sigmoids share a division, the dearest operation here; past ±40 they are within 5e-18 of 0 and 1.
      const T by_reset = T{1} + exponential_within_87(-clamp(r[i] + bias[width + i], T{40}));
      const T by_update = T{1} + exponential_within_87(-clamp(z[i] + bias[2 * width + i], T{40}));
      const T inverse = T{1} / (by_reset * by_update);
      const T reset = inverse * by_update;
      const T update = inverse * by_reset;
      const T share = hn[i] + bias[3 * width + i];
      const T candidate = hyperbolic_tangent(n[i] + bias[i] + reset * share);
      n[i] = candidate;
      r[i] = reset;
      z[i] = update;
      hn[i] = share;
      next[i] = (T{1} - update) * candidate + update * state[i];
    }
  }
}

template <typename T>
GRAPHDRL_INLINE void gru_backward_rows(int rows, int width, T* gates, const T* h, T* grad) {
  for (int row = 0; row < rows; ++row) {
    T* const n = gates + static_cast<std::ptrdiff_t>(row) * 4 * width;
    T* const r = n + width;
    T* const z = r + width;
    T* const hn = z + width;
    const T* const state = h + static_cast<std::ptrdiff_t>(row) * width;
    T* const by_next = grad + static_cast<std::ptrdiff_t>(row) * width;
#pragma omp simd
    for (int i = 0; i < width; ++i) {
      const T g = by_next[i];
      const T by_n = g * (T{1} - z[i]) * (T{1} - n[i] * n[i]);
      const T by_z = g * (state[i] - n[i]) * z[i] * (T{1} - z[i]);
      by_next[i] = g * z[i];
      const T reset = r[i];
      r[i] = by_n * hn[i] * reset * (T{1} - reset);
      hn[i] = by_n * reset;
      n[i] = by_n;
      z[i] = by_z;
    }
  }
}

template <typename T>
GRAPHDRL_INLINE void sum_neighbours_of_all(const Graph& graph, int columns, int width, const T* in, bool accumulate,
                                           T* out) {
  // Columns whose sum stays in registers over all neighbours.
  typedef T Block __attribute__((vector_size(64), aligned(alignof(T)), may_alias));
  constexpr int kBlock = 64 / sizeof(T);
  const auto block_of = [](auto* values) { return reinterpret_cast<Block*>(const_cast<T*>(values)); };
  for (NodeId node = 0; node < graph.node_count(); ++node) {
    const std::span<const NodeId> neighbours = graph.neighbours(node);
    T* const to = out + static_cast<std::ptrdiff_t>(node) * width;
    int column = 0;
    for (; column + kBlock <= columns; column += kBlock) {
      Block sum = accumulate ? *block_of(to + column) : Block{};
      for (const NodeId next : neighbours) sum += *block_of(in + static_cast<std::ptrdiff_t>(next) * width + column);
      *block_of(to + column) = sum;
    }
    for (; column < columns; ++column) {
      T sum = accumulate ? to[column] : T{0};
      for (const NodeId next : neighbours) sum += in[static_cast<std::ptrdiff_t>(next) * width + column];
      to[column] = sum;
    }
  }
}

template <typename T>
GRAPHDRL_INLINE void elu_values(T* x, std::size_t count) {
#pragma omp simd
  for (std::size_t i = 0; i < count; ++i) x[i] = x[i] > 0 ? x[i] : exponential(x[i]) - T{1};
}

template <typename T>
GRAPHDRL_INLINE void elu_backward_values(const T* y, T* grad, std::size_t count) {
#pragma omp simd
  for (std::size_t i = 0; i < count; ++i) grad[i] = y[i] > 0 ? grad[i] : grad[i] * (y[i] + T{1});
}

}  // namespace

GRAPHDRL_VECTOR_CLONES
void adam_update(const AdamStep& step, const float* grad, float* first, float* second, float* value,
                 std::size_t count) {
#pragma omp simd
  for (std::size_t i = 0; i < count; ++i) {
    float g = grad[i];
    g = g < -step.clamp ? -step.clamp : g;
    g = g > step.clamp ? step.clamp : g;
    first[i] = step.beta1 * first[i] + (1.0f - step.beta1) * g;
    second[i] = step.beta2 * second[i] + (1.0f - step.beta2) * g * g;
    value[i] -= step.rate * first[i] / (__builtin_sqrtf(second[i]) * step.second_scale + step.epsilon);
  }
}

GRAPHDRL_VECTOR_CLONES
void move_towards(const float* goal, float share, float* value, std::size_t count) {
#pragma omp simd
  for (std::size_t i = 0; i < count; ++i) value[i] += share * (goal[i] - value[i]);
}

GRAPHDRL_VECTOR_CLONES
void gru_forward(int rows, int width, const float* bias, float* gates, const float* h, float* h_next) {
  gru_forward_rows(rows, width, bias, gates, h, h_next);
}

void gru_forward(int rows, int width, const double* bias, double* gates, const double* h, double* h_next) {
  gru_forward_rows(rows, width, bias, gates, h, h_next);
}

GRAPHDRL_VECTOR_CLONES
void gru_backward(int rows, int width, float* gates, const float* h, float* grad) {
  gru_backward_rows(rows, width, gates, h, grad);
}

void gru_backward(int rows, int width, double* gates, const double* h, double* grad) {
  gru_backward_rows(rows, width, gates, h, grad);
}

GRAPHDRL_VECTOR_CLONES
void sum_neighbours(const Graph& graph, int columns, int width, const float* in, bool accumulate, float* out) {
  sum_neighbours_of_all(graph, columns, width, in, accumulate, out);
}

void sum_neighbours(const Graph& graph, int columns, int width, const double* in, bool accumulate, double* out) {
  sum_neighbours_of_all(graph, columns, width, in, accumulate, out);
}

GRAPHDRL_VECTOR_CLONES
void elu(float* x, std::size_t count) {
  elu_values(x, count);
}

void elu(double* x, std::size_t count) {
  elu_values(x, count);
}

GRAPHDRL_VECTOR_CLONES
void elu_backward(const float* y, float* grad, std::size_t count) {
  elu_backward_values(y, grad, count);
}

void elu_backward(const double* y, double* grad, std::size_t count) {
  elu_backward_values(y, grad, count);
}

}  // namespace graphdrl
