#include "graphdrl/nn/layers.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "graphdrl/base/parallel.h"
#include "graphdrl/base/random.h"

namespace graphdrl {
namespace {

std::vector<float> random_values(std::size_t count, Rng& rng) {
  std::vector<float> values(count);
  for (float& value : values) value = static_cast<float>(2 * rng.uniform() - 1);
  return values;
}

// d loss / d values, by central differences of a loss computed in double precision.
std::vector<double> slopes(std::vector<double> values, const std::function<double(const std::vector<double>&)>& loss) {
  std::vector<double> result;
  for (double& value : values) {
    const double kept = value;
    value = kept + 1e-5;
    const double above = loss(values);
    value = kept - 1e-5;
    result.push_back((above - loss(values)) / 2e-5);
    value = kept;
  }
  return result;
}

std::vector<double> widen(const std::vector<float>& values) {
  return {values.begin(), values.end()};
}

void expect_near(const std::vector<float>& got, const std::vector<double>& expected) {
  ASSERT_EQ(got.size(), expected.size());
  for (std::size_t i = 0; i < got.size(); ++i)
    EXPECT_NEAR(got[i], expected[i], 2e-5 * (1 + std::abs(expected[i]))) << i;
}

TEST(Linear, IsItsFormulaForwardAndBackward) {
  constexpr LinearShape kShape = {5, 37};
  constexpr int kRows = 300;  // more than one task's
  Rng rng(1);
  const std::vector<float> x = random_values(kRows * kShape.inputs, rng);
  const std::vector<float> weight = random_values(kShape.inputs * kShape.outputs, rng);
  const std::vector<float> bias = random_values(kShape.outputs, rng);
  const std::vector<float> grad_out = random_values(kRows * kShape.outputs, rng);
  std::vector<double> out(kRows * kShape.outputs);
  std::vector<double> by_x(x.size());
  std::vector<double> by_weight(weight.size());
  std::vector<double> by_bias(bias.size());
  for (int row = 0; row < kRows; ++row) {
    for (int o = 0; o < kShape.outputs; ++o) {
      const double g = grad_out[row * kShape.outputs + o];
      out[row * kShape.outputs + o] = bias[o];
      by_bias[o] += g;
      for (int i = 0; i < kShape.inputs; ++i) {
        out[row * kShape.outputs + o] += double{x[row * kShape.inputs + i]} * weight[o * kShape.inputs + i];
        by_x[row * kShape.inputs + i] += g * weight[o * kShape.inputs + i];
        by_weight[o * kShape.inputs + i] += g * x[row * kShape.inputs + i];
      }
    }
  }
  for (const int thread_count : {1, 3}) {
    set_threads(thread_count);
    std::vector<float> got(out.size());
    std::vector<float> got_by_x(x.size());
    std::vector<float> got_by_weight(weight.size(), 7.0f);  // overwritten
    std::vector<float> got_by_bias(bias.size(), 7.0f);
    linear(kShape, kRows, x.data(), {weight.data(), bias.data()}, got.data());
    linear_backward(kShape, kRows, x.data(), {weight.data(), bias.data()}, grad_out.data(), got_by_x.data(),
                    {got_by_weight.data(), got_by_bias.data()});
    expect_near(got, out);
    expect_near(got_by_x, by_x);
    expect_near(got_by_weight, by_weight);
    expect_near(got_by_bias, by_bias);
  }
  set_threads(1);
}

TEST(BatchNorm, IsItsFormulaForwardAndBackward) {
  constexpr int kRows = 150;  // more than one task's
  constexpr int kWidth = 3;
  constexpr double kEpsilon = 1e-3;
  Rng rng(2);
  std::vector<float> x = random_values(kRows * kWidth, rng);
  for (int row = 0; row < kRows; ++row) x[row * kWidth + 1] += 5;
  const std::vector<float> weight = random_values(kWidth, rng);
  const std::vector<float> bias = random_values(kWidth, rng);
  const std::vector<float> weighting = random_values(x.size(), rng);

  std::vector<double> expected(x.size());
  const auto loss = [&](const std::vector<double>& input, const std::vector<double>& w, const std::vector<double>& b) {
    double sum = 0;
    for (int i = 0; i < kWidth; ++i) {
      double mean = 0;
      double variance = 0;
      for (int row = 0; row < kRows; ++row) mean += input[row * kWidth + i] / kRows;
      for (int row = 0; row < kRows; ++row) variance += std::pow(input[row * kWidth + i] - mean, 2) / kRows;
      for (int row = 0; row < kRows; ++row) {
        const int at = row * kWidth + i;
        expected[at] = (input[at] - mean) / std::sqrt(variance + kEpsilon) * w[i] + b[i];
        sum += weighting[at] * expected[at];
      }
    }
    return sum;
  };
  const auto by_x = slopes(widen(x), [&](const auto& v) { return loss(v, widen(weight), widen(bias)); });
  const auto by_weight = slopes(widen(weight), [&](const auto& v) { return loss(widen(x), v, widen(bias)); });
  const auto by_bias = slopes(widen(bias), [&](const auto& v) { return loss(widen(x), widen(weight), v); });
  loss(widen(x), widen(weight), widen(bias));

  const BatchNormTensors weights = {weight.data(), bias.data()};
  const ColumnStatistics statistics = column_statistics(kRows, kWidth, x.data(), kEpsilon);
  std::vector<float> out(x.size());
  batch_norm(kRows, kWidth, x.data(), statistics, weights, out.data());
  expect_near(out, expected);
  std::vector<float> grad = weighting;
  std::vector<float> grad_weight(kWidth);
  std::vector<float> grad_bias(kWidth);
  batch_norm_backward(kRows, kWidth, x.data(), statistics, weights, grad.data(), grad_weight.data(), grad_bias.data());
  expect_near(grad, by_x);
  expect_near(grad_weight, by_weight);
  expect_near(grad_bias, by_bias);
}

TEST(SumPool, AddsEachGraphsRows) {
  const Graph pair = Graph::grid(1, 2);
  const Graph single = Graph::grid(1, 1);
  GraphBatch batch;
  batch.add(pair);
  batch.add(single);
  const std::vector<float> x = {1, 10, 2, 20, 3, 30};
  std::vector<float> out(4);
  sum_pool(batch, 2, x.data(), out.data());
  EXPECT_EQ(out, (std::vector<float>{3, 30, 3, 30}));
  std::vector<float> grad(6);
  sum_pool_backward(batch, 2, std::vector<float>{4, 5, 6, 7}.data(), grad.data());
  EXPECT_EQ(grad, (std::vector<float>{4, 5, 4, 5, 6, 7}));
}

}  // namespace
}  // namespace graphdrl
