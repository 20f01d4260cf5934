// How long a learning step of the preset `paper` takes, and how much of that its matrix products alone would.
#pragma once

namespace graphdrl {

// Medians over alternating rounds of one run, in milliseconds.
struct LearningStepTime {
  double step_ms;      // sample, features, both forward passes, backward, Adam, soft update
  double products_ms;  // the bare matrix products of such a step, at their own shapes, spread over the same threads
  double sgemm_ms;     // the same products by OpenBLAS's sgemm
};

// On `threads` threads. Takes some seconds.
LearningStepTime time_learning_step(int threads);

}  // namespace graphdrl
