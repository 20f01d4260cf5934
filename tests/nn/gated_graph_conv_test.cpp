#include "graphdrl/nn/gated_graph_conv.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "graphdrl/base/parallel.h"
#include "support.h"

namespace graphdrl {
namespace {

// One layer's weights, or their gradients, in memory of their own.
template <typename T>
struct Weights {
  explicit Weights(GatedGraphConvShape shape)
      : weight(static_cast<std::size_t>(shape.steps) * shape.width * shape.width),
        w_ih(3 * static_cast<std::size_t>(shape.width) * shape.width),
        w_hh(w_ih.size()),
        b_ih(3 * static_cast<std::size_t>(shape.width)),
        b_hh(b_ih.size()) {}

  std::vector<std::vector<T>*> all() { return {&weight, &w_ih, &w_hh, &b_ih, &b_hh}; }
  GatedGraphConvTensors<T> views() { return {weight.data(), w_ih.data(), w_hh.data(), b_ih.data(), b_hh.data()}; }
  GatedGraphConvTensors<const T> const_views() const {
    return {weight.data(), w_ih.data(), w_hh.data(), b_ih.data(), b_hh.data()};
  }

  std::vector<T> weight, w_ih, w_hh, b_ih, b_hh;
};

template <typename T>
void fill(std::vector<T>& values, Rng& rng, double scale) {
  for (T& value : values) value = static_cast<T>(scale * (2 * rng.uniform() - 1));
}

Weights<double> in_double(Weights<float>& weights, GatedGraphConvShape shape) {
  Weights<double> result(shape);
  for (std::size_t i = 0; i < result.all().size(); ++i) {
    result.all()[i]->assign(weights.all()[i]->begin(), weights.all()[i]->end());
  }
  return result;
}

// The layer as the paper writes it, node by node and without any of the kernel's rearrangements.
std::vector<double> reference(const GraphBatch& batch, GatedGraphConvShape shape, const Weights<double>& w,
                              const std::vector<double>& x) {
  const int d = shape.width;
  std::vector<double> h(static_cast<std::size_t>(batch.node_count()) * d, 0);
  for (int i = 0; i < batch.node_count(); ++i) {
    for (int f = 0; f < shape.inputs; ++f) h[i * d + f] = x[i * shape.inputs + f];
  }
  for (int l = 0; l < shape.steps; ++l) {
    std::vector<double> next = h;
    for (int g = 0; g < batch.graph_count(); ++g) {
      for (NodeId node = 0; node < batch.graph(g).node_count(); ++node) {
        std::vector<double> m(d, 0);
        for (const NodeId j : batch.graph(g).neighbours(node)) {
          for (int c = 0; c < d; ++c) {
            for (int k = 0; k < d; ++k) m[c] += h[(batch.first_node(g) + j) * d + k] * w.weight[(l * d + k) * d + c];
          }
        }
        const int row = batch.first_node(g) + node;
        const auto gate = [&](int block, int c, bool from_message) {
          double sum = from_message ? w.b_ih[block * d + c] : w.b_hh[block * d + c];
          for (int k = 0; k < d; ++k) {
            sum += from_message ? m[k] * w.w_ih[(block * d + c) * d + k]
                                : h[row * d + k] * w.w_hh[(block * d + c) * d + k];
          }
          return sum;
        };
        for (int c = 0; c < d; ++c) {
          const double r = 1 / (1 + std::exp(-gate(0, c, true) - gate(0, c, false)));
          const double z = 1 / (1 + std::exp(-gate(1, c, true) - gate(1, c, false)));
          const double n = std::tanh(gate(2, c, true) + r * gate(2, c, false));
          next[row * d + c] = (1 - z) * n + z * h[row * d + c];
        }
      }
    }
    h = next;
  }
  if (shape.elu) {
    for (double& value : h) value = value > 0 ? value : std::expm1(value);
  }
  return h;
}

// Graphs of different sizes, one larger than a chunk, one with a node that has no neighbour.
class GatedGraphConvTest : public ::testing::Test {
 protected:
  GatedGraphConvTest() {
    const std::vector<Edge> star = {{0, 1}, {0, 2}, {0, 3}};
    graphs_ = {Graph::grid(3, 3), Graph::from_edges(5, star), Graph::grid(10, 11), Graph::grid(1, 1),
               Graph::grid(2, 5)};
    for (const Graph& graph : graphs_) batch_.add(graph);
  }

  std::vector<Graph> graphs_;
  GraphBatch batch_;
};

TEST_F(GatedGraphConvTest, ForwardIsThePapersFormula) {
  Rng rng(1);
  for (const GatedGraphConvShape shape : {GatedGraphConvShape{3, 5, 3}, {4, 4, 1}, {1, 6, 2, true}, {7, 33, 4}}) {
    Weights<float> w(shape);
    for (auto* values : w.all()) fill(*values, rng, shape.width > 6 ? 0.3 : 0.5);
    std::vector<float> x(static_cast<std::size_t>(batch_.node_count()) * shape.inputs);
    fill(x, rng, 1);
    const std::vector<double> expected = reference(batch_, shape, in_double(w, shape), {x.begin(), x.end()});
    for (const bool keep : {false, true}) {
      GatedGraphConv layer(shape);
      layer.set_weights(w.const_views());
      std::vector<float> out(expected.size());
      layer.forward(batch_, x.data(), out.data(), keep);
      for (std::size_t i = 0; i < out.size(); ++i) ASSERT_NEAR(out[i], expected[i], 2e-6);
    }
  }
}

TEST_F(GatedGraphConvTest, BackwardIsTheFiniteDifferenceOfTheFormula) {
  Rng rng(3);
  for (const GatedGraphConvShape shape : {GatedGraphConvShape{3, 5, 3}, {4, 4, 1, true}}) {
    Weights<float> w(shape);
    for (auto* values : w.all()) fill(*values, rng, 0.5);
    std::vector<float> x(static_cast<std::size_t>(batch_.node_count()) * shape.inputs);
    fill(x, rng, 1);
    std::vector<float> grad_out(static_cast<std::size_t>(batch_.node_count()) * shape.width);
    fill(grad_out, rng, 1);
    GatedGraphConv layer(shape);
    layer.set_weights(w.const_views());
    std::vector<float> out(grad_out.size());
    layer.forward(batch_, x.data(), out.data(), true);
    Weights<float> grad(shape);
    std::vector<float> grad_x(x.size());
    layer.backward(batch_, out.data(), grad_out.data(), grad_x.data(), grad.views());

    Weights<double> exact = in_double(w, shape);
    std::vector<double> exact_x(x.begin(), x.end());
    const auto loss = [&] {  // Σ grad_out · out
      const std::vector<double> result = reference(batch_, shape, exact, exact_x);
      return std::inner_product(result.begin(), result.end(), grad_out.begin(), 0.0);
    };
    const auto check = [&](std::vector<double>& values, const std::vector<float>& gradient) {
      for (std::size_t i = 0; i < values.size(); i += 1 + values.size() / 40) {
        constexpr double kStep = 1e-5;
        const double value = values[i];
        values[i] = value + kStep;
        const double above = loss();
        values[i] = value - kStep;
        const double below = loss();
        values[i] = value;
        ASSERT_NEAR(gradient[i], (above - below) / (2 * kStep), 1e-5 * std::max(1.0f, std::abs(gradient[i])));
      }
    };
    for (std::size_t i = 0; i < w.all().size(); ++i) check(*exact.all()[i], *grad.all()[i]);
    check(exact_x, grad_x);
  }
}

TEST_F(GatedGraphConvTest, AnyNumberOfThreadsGivesTheSameBytes) {
  const GatedGraphConvShape shape{7, 32, 4, true};
  Rng rng(4);
  Weights<float> w(shape);
  for (auto* values : w.all()) fill(*values, rng, 0.3);
  std::vector<float> x(static_cast<std::size_t>(batch_.node_count()) * shape.inputs);
  fill(x, rng, 1);
  std::vector<float> grad_out(static_cast<std::size_t>(batch_.node_count()) * shape.width);
  fill(grad_out, rng, 1);
  std::vector<std::vector<float>> results;
  for (const int count : {1, 2, 4}) {
    set_threads(count);
    GatedGraphConv layer(shape);
    layer.set_weights(w.const_views());
    std::vector<float> result(grad_out.size());
    layer.forward(batch_, x.data(), result.data(), true);
    Weights<float> grad(shape);
    std::vector<float> grad_x(x.size());
    layer.backward(batch_, result.data(), grad_out.data(), grad_x.data(), grad.views());
    for (auto* values : grad.all()) result.insert(result.end(), values->begin(), values->end());
    result.insert(result.end(), grad_x.begin(), grad_x.end());
    results.push_back(result);
  }
  set_threads(1);
  EXPECT_EQ(results[0], results[1]);
  EXPECT_EQ(results[0], results[2]);
}

}  // namespace
}  // namespace graphdrl
