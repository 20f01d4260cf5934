#include "graphdrl/train/gated_graph_conv_function.h"

#include <gtest/gtest.h>
#include <torch/torch.h>

namespace graphdrl {
namespace {

// The same layer composed of LibTorch's own operators.
torch::Tensor composed(const GraphBatch& batch, torch::Tensor x, const GatedGraphConvLeaves& leaves) {
  std::vector<std::int64_t> from;
  std::vector<std::int64_t> to;
  for (int g = 0; g < batch.graph_count(); ++g) {
    for (NodeId node = 0; node < batch.graph(g).node_count(); ++node) {
      for (const NodeId next : batch.graph(g).neighbours(node)) {
        from.push_back(batch.first_node(g) + next);
        to.push_back(batch.first_node(g) + node);
      }
    }
  }
  const std::int64_t width = leaves.weight.size(1);
  torch::Tensor h = torch::constant_pad_nd(x, {0, width - x.size(1)});
  for (std::int64_t step = 0; step < leaves.weight.size(0); ++step) {
    const torch::Tensor sent = torch::matmul(h, leaves.weight[step]);
    const torch::Tensor message =
        torch::zeros_like(sent).index_add(0, torch::tensor(to), sent.index_select(0, torch::tensor(from)));
    h = torch::gru_cell(message, h, leaves.w_ih, leaves.w_hh, leaves.b_ih, leaves.b_hh);
  }
  return h;
}

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

    torch::Tensor expected = composed(batch, x, leaves);
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
