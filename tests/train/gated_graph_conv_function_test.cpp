#include "graphdrl/train/gated_graph_conv_function.h"

#include <gtest/gtest.h>
#include <torch/torch.h>

#include "graphdrl/train/composed_network.h"

namespace graphdrl {
namespace {

TEST(GatedGraphConvFunction, IsTheComposedOperatorForwardAndBackward) {
  torch::manual_seed(1);
  const std::vector<Graph> graphs = {Graph::grid(5, 5), Graph::grid(3, 4), Graph::grid(11, 10), Graph::grid(1, 1)};
  GraphBatch batch;
  for (const Graph& graph : graphs) batch.add(graph);
  for (const GatedGraphConvShape shape : {GatedGraphConvShape{7, 7, 4}, {7, 64, 4, true}, {3, 5, 1}}) {
    const auto leaf = [](torch::IntArrayRef size) { return (torch::rand(size) * 0.6 - 0.3).requires_grad_(true); };
    const std::int64_t width = shape.width;
    const GatedGraphConvLeaves leaves{leaf({shape.steps, width, width}), leaf({3 * width, width}),
                                      leaf({3 * width, width}), leaf({3 * width}), leaf({3 * width})};
    const torch::Tensor x = torch::randn({batch.node_count(), shape.inputs}).requires_grad_(true);
    const torch::Tensor weighting = torch::randn({batch.node_count(), width});
    const std::vector<torch::Tensor> inputs = {x, leaves.weight, leaves.w_ih, leaves.w_hh, leaves.b_ih, leaves.b_hh};

    const NamedTensors tensors = {{"conv.weight", leaves.weight},
                                  {"conv.rnn.weight_ih", leaves.w_ih},
                                  {"conv.rnn.weight_hh", leaves.w_hh},
                                  {"conv.rnn.bias_ih", leaves.b_ih},
                                  {"conv.rnn.bias_hh", leaves.b_hh}};
    torch::Tensor expected = composed_conv(edge_index(batch, torch::kCPU), x, tensors, "conv");
    if (shape.elu) expected = torch::elu(expected);
    const auto expected_grads = torch::autograd::grad({(expected * weighting).sum()}, inputs);

    GatedGraphConv<float> layer(shape);
    layer.set_weights({leaves.weight.data_ptr<float>(), leaves.w_ih.data_ptr<float>(), leaves.w_hh.data_ptr<float>(),
                       leaves.b_ih.data_ptr<float>(), leaves.b_hh.data_ptr<float>()});
    const torch::Tensor out = gated_graph_conv(layer, batch, x, leaves);
    const auto grads = torch::autograd::grad({(out * weighting).sum()}, inputs);

    EXPECT_TRUE(torch::allclose(out, expected, 1e-4, 1e-5));
    for (std::size_t i = 0; i < inputs.size(); ++i) {
      const double scale = expected_grads[i].abs().max().item<double>();
      EXPECT_LT((grads[i] - expected_grads[i]).abs().max().item<double>(), 1e-4 * scale) << "input " << i;
    }
  }
}

}  // namespace
}  // namespace graphdrl
