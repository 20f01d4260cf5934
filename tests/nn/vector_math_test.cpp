#include "graphdrl/nn/vector_math.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace graphdrl {
namespace {

TEST(VectorMath, EluIsExpMinusOneBelowZero) {
  std::vector<float> x;
  for (float value = -100; value < 10; value += 0.37f) x.push_back(value);
  const std::vector<float> before = x;
  elu(x.data(), x.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    EXPECT_NEAR(x[i], before[i] > 0 ? before[i] : std::expm1(before[i]), 3e-7);
  }
}

TEST(VectorMath, SumsOfNeighboursAreTheFormula) {
  const Graph graph = Graph::grid(3, 4);
  for (const int columns : {1, 7, 16, 19, 64}) {
    for (const bool accumulate : {false, true}) {
      const int width = columns + 3;
      std::vector<float> in;
      for (int i = 0; i < graph.node_count() * width; ++i) in.push_back(static_cast<float>(i * i % 101));
      std::vector<float> out(in.size(), 5);
      sum_neighbours(graph, columns, width, in.data(), accumulate, out.data());
      for (NodeId node = 0; node < graph.node_count(); ++node) {
        for (int i = 0; i < width; ++i) {
          float sum = accumulate || i >= columns ? 5 : 0;  // whole numbers: exact
          if (i < columns) {
            for (const NodeId next : graph.neighbours(node)) sum += in[next * width + i];
          }
          ASSERT_EQ(out[node * width + i], sum) << columns << " " << accumulate << " " << node << " " << i;
        }
      }
    }
  }
}

TEST(VectorMath, GruStepIsTheFormulas) {
  // Odd widths leave a remainder behind the vector code.
  for (const int width : {1, 7, 19, 64}) {
    std::vector<float> gates(4 * width);
    std::vector<float> bias(4 * width);
    std::vector<float> h(width);
    std::vector<double> expected;
    for (int i = 0; i < width; ++i) {
      const float n = 0.3f * static_cast<float>(i) - 5;
      const float r = 2 - 0.2f * static_cast<float>(i);
      const float z = 0.1f * static_cast<float>(i) - 1;
      const float hn = 1.5f - 0.1f * static_cast<float>(i);
      for (int gate = 0; gate < 4; ++gate) bias[gate * width + i] = 0.1f * static_cast<float>(gate + i);
      gates[i] = n - bias[i];
      gates[width + i] = r - bias[width + i];
      gates[2 * width + i] = z - bias[2 * width + i];
      gates[3 * width + i] = hn - bias[3 * width + i];
      h[i] = 0.05f * static_cast<float>(i);
      const double reset = 1 / (1 + std::exp(-static_cast<double>(r)));
      const double update = 1 / (1 + std::exp(-static_cast<double>(z)));
      const double candidate = std::tanh(n + reset * hn);
      expected.push_back((1 - update) * candidate + update * h[i]);
    }
    gru_forward(1, width, bias.data(), gates.data(), h.data(), h.data());
    for (int i = 0; i < width; ++i) EXPECT_NEAR(h[i], expected[i], 1e-6);
  }
}

}  // namespace
}  // namespace graphdrl
