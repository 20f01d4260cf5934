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

GRAPHDRL_INLINE float clamp(float x, float limit) {
  x = x < -limit ? -limit : x;
  return x > limit ? limit : x;
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

GRAPHDRL_INLINE float hyperbolic_tangent(float x) {
  return 1.0f - 2.0f / (1.0f + exponential(2.0f * x));
}

}  // namespace

GRAPHDRL_VECTOR_CLONES
void gru_forward(int rows, int width, const float* bias, float* gates, const float* h, float* h_next) {
  for (int row = 0; row < rows; ++row) {
    float* const n = gates + static_cast<std::ptrdiff_t>(row) * 4 * width;
    float* const r = n + width;
    float* const z = r + width;
    float* const hn = z + width;
    const float* const state = h + static_cast<std::ptrdiff_t>(row) * width;
    float* const next = h_next + static_cast<std::ptrdiff_t>(row) * width;
#pragma omp simd
    for (int i = 0; i < width; ++i) {
      // The two sigmoids share a division, the dearest operation here; past ±40 they are within 5e-18 of 0 and 1.
      const float by_reset = 1.0f + exponential_within_87(-clamp(r[i] + bias[width + i], 40.0f));
      const float by_update = 1.0f + exponential_within_87(-clamp(z[i] + bias[2 * width + i], 40.0f));
      const float inverse = 1.0f / (by_reset * by_update);
      const float reset = inverse * by_update;
      const float update = inverse * by_reset;
      const float share = hn[i] + bias[3 * width + i];
      const float candidate = hyperbolic_tangent(n[i] + bias[i] + reset * share);
      n[i] = candidate;
      r[i] = reset;
      z[i] = update;
      hn[i] = share;
      next[i] = (1.0f - update) * candidate + update * state[i];
    }
  }
}

GRAPHDRL_VECTOR_CLONES
void gru_backward(int rows, int width, float* gates, const float* h, float* grad) {
  for (int row = 0; row < rows; ++row) {
    float* const n = gates + static_cast<std::ptrdiff_t>(row) * 4 * width;
    float* const r = n + width;
    float* const z = r + width;
    float* const hn = z + width;
    const float* const state = h + static_cast<std::ptrdiff_t>(row) * width;
    float* const by_next = grad + static_cast<std::ptrdiff_t>(row) * width;
#pragma omp simd
    for (int i = 0; i < width; ++i) {
      const float g = by_next[i];
      const float by_n = g * (1.0f - z[i]) * (1.0f - n[i] * n[i]);
      const float by_z = g * (state[i] - n[i]) * z[i] * (1.0f - z[i]);
      by_next[i] = g * z[i];
      const float reset = r[i];
      r[i] = by_n * hn[i] * reset * (1.0f - reset);
      hn[i] = by_n * reset;
      n[i] = by_n;
      z[i] = by_z;
    }
  }
}

GRAPHDRL_VECTOR_CLONES
void sum_neighbours(const Graph& graph, int columns, int width, const float* in, bool accumulate, float* out) {
  // Columns whose sum stays in registers over all neighbours.
  typedef float Block __attribute__((vector_size(64), aligned(alignof(float)), may_alias));
  constexpr int kBlock = 64 / sizeof(float);
  // Not a deduced type, which would lose the alignment.
  const auto block_of = [](const float* values) -> Block* {
    return reinterpret_cast<Block*>(const_cast<float*>(values));
  };
  for (NodeId node = 0; node < graph.node_count(); ++node) {
    const std::span<const NodeId> neighbours = graph.neighbours(node);
    float* const to = out + static_cast<std::ptrdiff_t>(node) * width;
    int column = 0;
    for (; column + kBlock <= columns; column += kBlock) {
      Block sum = accumulate ? *block_of(to + column) : Block{};
      for (const NodeId next : neighbours) sum += *block_of(in + static_cast<std::ptrdiff_t>(next) * width + column);
      *block_of(to + column) = sum;
    }
    for (; column < columns; ++column) {
      float sum = accumulate ? to[column] : 0.0f;
      for (const NodeId next : neighbours) sum += in[static_cast<std::ptrdiff_t>(next) * width + column];
      to[column] = sum;
    }
  }
}

GRAPHDRL_VECTOR_CLONES
void elu(float* x, std::size_t count) {
#pragma omp simd
  for (std::size_t i = 0; i < count; ++i) x[i] = x[i] > 0 ? x[i] : exponential(x[i]) - 1.0f;
}

GRAPHDRL_VECTOR_CLONES
void elu_backward(const float* y, float* grad, std::size_t count) {
#pragma omp simd
  for (std::size_t i = 0; i < count; ++i) grad[i] = y[i] > 0 ? grad[i] : grad[i] * (y[i] + 1.0f);
}

GRAPHDRL_VECTOR_CLONES
void adam_update(float rate, float second_scale, const float* grad, float* first, float* second, float* value,
                 std::size_t count) {
  constexpr auto kBeta1 = static_cast<float>(kAdamBeta1);
  constexpr auto kBeta2 = static_cast<float>(kAdamBeta2);
  constexpr auto kEpsilon = static_cast<float>(kAdamEpsilon);
#pragma omp simd
  for (std::size_t i = 0; i < count; ++i) {
    const float g = clamp(grad[i], static_cast<float>(kGradientClamp));
    first[i] = kBeta1 * first[i] + (1.0f - kBeta1) * g;
    second[i] = kBeta2 * second[i] + (1.0f - kBeta2) * g * g;
    value[i] -= rate * first[i] / (__builtin_sqrtf(second[i]) * second_scale + kEpsilon);
  }
}

GRAPHDRL_VECTOR_CLONES
void move_towards(const float* goal, float share, float* value, std::size_t count) {
#pragma omp simd
  for (std::size_t i = 0; i < count; ++i) value[i] += share * (goal[i] - value[i]);
}

}  // namespace graphdrl
