#include "graphdrl/train/gated_graph_conv_function.h"

#include <torch/csrc/autograd/custom_function.h>

namespace graphdrl {
namespace {

using torch::autograd::AutogradContext;
using torch::autograd::Variable;
using torch::autograd::variable_list;

class GatedGraphConvFunction : public torch::autograd::Function<GatedGraphConvFunction> {
 public:
  static Variable forward(AutogradContext* context, GatedGraphConv<float>* layer, const GraphBatch* batch,
                          const Variable& x, const Variable& weight, const Variable& w_ih, const Variable& w_hh,
                          const Variable& b_ih, const Variable& b_hh) {
    context->saved_data["layer"] = reinterpret_cast<std::int64_t>(layer);
    context->saved_data["batch"] = reinterpret_cast<std::int64_t>(batch);
    context->saved_data["x_needs_grad"] = x.requires_grad();
    const torch::Tensor input = x.contiguous();
    torch::Tensor out = torch::empty({x.size(0), weight.size(1)});
    layer->forward(*batch, input.data_ptr<float>(), out.data_ptr<float>(), /*keep=*/true);
    context->save_for_backward({out, x, weight, w_ih, w_hh, b_ih, b_hh});  // the inputs for their shapes
    return out;
  }

  static variable_list backward(AutogradContext* context, variable_list grad_outputs) {
    auto* const layer = reinterpret_cast<GatedGraphConv<float>*>(context->saved_data["layer"].toInt());
    const auto* const batch = reinterpret_cast<const GraphBatch*>(context->saved_data["batch"].toInt());
    const bool x_needs_grad = context->saved_data["x_needs_grad"].toBool();
    const torch::Tensor grad_out = grad_outputs[0].contiguous();
    variable_list grads = {{}, {}};  // the layer and the batch have none
    const variable_list saved = context->get_saved_variables();
    for (std::size_t i = 1; i < saved.size(); ++i) grads.push_back(torch::empty_like(saved[i]));
    const auto data = [&](int index) { return grads[index].data_ptr<float>(); };
    layer->backward(*batch, saved[0].data_ptr<float>(), grad_out.data_ptr<float>(), x_needs_grad ? data(2) : nullptr,
                    {.weight = data(3), .w_ih = data(4), .w_hh = data(5), .b_ih = data(6), .b_hh = data(7)});
    if (!x_needs_grad) grads[2] = torch::Tensor();
    return grads;
  }
};

}  // namespace

torch::Tensor gated_graph_conv(GatedGraphConv<float>& layer, const GraphBatch& batch, const torch::Tensor& x,
                               const GatedGraphConvLeaves& leaves) {
  return GatedGraphConvFunction::apply(&layer, &batch, x, leaves.weight, leaves.w_ih, leaves.w_hh, leaves.b_ih,
                                       leaves.b_hh);
}

}  // namespace graphdrl
