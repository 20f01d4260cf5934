// How long a learning step of the preset `paper` takes, and how much of that its matrix products alone would.
#pragma once

#include <optional>

#include "graphdrl/nn/gemm.h"

namespace graphdrl {

// Medians over alternating rounds of one run, in milliseconds.
struct LearningStepTime {
  double step_ms;      // sample, features, both forward passes, backward, Adam, soft update
  double products_ms;  // the bare matrix products of such a step, at their own shapes, spread over the same threads
  std::optional<double> other_products_ms;  // the same by another library's product
};

// c = a b, or aᵀ b, of a shape, on the calling thread alone. a: [m, k] with rows lda apart, or [k, m]; b: [k, n];
// c: [m, n] with rows ldc apart.
using GemmFunction = void (*)(const GemmShape& shape, const float* a, const float* b, float* c);

// On `threads` threads. Takes some seconds. `other`: a library's product to compare with, if there is one.
LearningStepTime time_learning_step(int threads, GemmFunction other = nullptr);

}  // namespace graphdrl
