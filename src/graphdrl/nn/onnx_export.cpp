#include "graphdrl/nn/onnx_export.h"

#include <fmt/format.h>
#include <onnx.pb.h>

#include <nlohmann/json.hpp>
#include <variant>

#include "graphdrl/io/file.h"

namespace graphdrl {
namespace {

constexpr std::int64_t kIrVersion = 8;
constexpr std::int64_t kOpset = 16;  // the first whose ScatterElements adds up

using Names = std::vector<std::string>;

// A model under construction. Everything is known by its name; what a node computes gets a name of its own.
class OnnxModel {
 public:
  explicit OnnxModel(const nlohmann::json& description) {
    model_.set_ir_version(kIrVersion);
    model_.set_producer_name("graphdrl");
    model_.add_opset_import()->set_version(kOpset);
    onnx::StringStringEntryProto* const entry = model_.add_metadata_props();
    entry->set_key("network");
    entry->set_value(description.dump());
    graph().set_name(description["kind"].get<std::string>());
  }

  // A dimension is a name where it differs from call to call, else a number.
  using Dimension = std::variant<const char*, std::int64_t>;

  // An attribute of a node.
  struct Attribute {
    const char* name;
    std::variant<std::int64_t, double, const char*> value;
  };

  std::string input(const std::string& name, onnx::TensorProto::DataType type, const std::vector<Dimension>& shape) {
    describe(*graph().add_input(), name, type, shape);
    return name;
  }
  void output(const std::string& name, const std::vector<Dimension>& shape) {
    describe(*graph().add_output(), name, onnx::TensorProto::FLOAT, shape);
  }

  // All tensors of a network, under their own names.
  void add_tensors(const std::vector<TensorView>& tensors) {
    for (const TensorView& view : tensors) {
      onnx::TensorProto& tensor = *graph().add_initializer();
      tensor.set_name(view.name);
      tensor.set_data_type(onnx::TensorProto::FLOAT);
      for (const std::int64_t extent : view.shape) tensor.add_dims(extent);
      tensor.set_raw_data(view.bytes.data(), view.bytes.size());
    }
  }

  // Whole numbers: [n].
  std::string constant(const std::vector<std::int64_t>& values) {
    onnx::TensorProto& tensor = constant_of(onnx::TensorProto::INT64);
    tensor.add_dims(std::ssize(values));
    tensor.mutable_int64_data()->Assign(values.begin(), values.end());
    return tensor.name();
  }
  std::string index(std::int64_t value) {
    onnx::TensorProto& tensor = constant_of(onnx::TensorProto::INT64);
    tensor.add_int64_data(value);
    return tensor.name();
  }
  std::string scalar(float value) {
    onnx::TensorProto& tensor = constant_of(onnx::TensorProto::FLOAT);
    tensor.add_float_data(value);
    return tensor.name();
  }

  // Adds a node; gives its outputs.
  Names add_node(const char* op, const Names& inputs, int outputs, const std::vector<Attribute>& attributes) {
    onnx::NodeProto& node = *graph().add_node();
    node.set_op_type(op);
    for (const std::string& name : inputs) node.add_input(name);
    for (int i = 0; i < outputs; ++i) node.add_output(fmt::format("{}_{}", op, ++values_));
    for (const auto& [name, value] : attributes) {
      onnx::AttributeProto& attribute = *node.add_attribute();
      attribute.set_name(name);
      if (const std::int64_t* const integer = std::get_if<std::int64_t>(&value)) {
        attribute.set_type(onnx::AttributeProto::INT);
        attribute.set_i(*integer);
      } else if (const double* const number = std::get_if<double>(&value)) {
        attribute.set_type(onnx::AttributeProto::FLOAT);
        attribute.set_f(static_cast<float>(*number));
      } else {
        attribute.set_type(onnx::AttributeProto::STRING);
        attribute.set_s(std::get<const char*>(value));
      }
    }
    return {node.output().begin(), node.output().end()};
  }
  // With one output.
  std::string add(const char* op, const Names& inputs, const std::vector<Attribute>& attributes = {}) {
    return add_node(op, inputs, 1, attributes).front();
  }

  // Gives the output of the last node a name.
  void name_output(const std::string& name) { graph().mutable_node()->rbegin()->set_output(0, name); }

  void write(const std::filesystem::path& path) const { write_file(path, model_.SerializeAsString()); }

 private:
  onnx::GraphProto& graph() { return *model_.mutable_graph(); }

  onnx::TensorProto& constant_of(onnx::TensorProto::DataType type) {
    onnx::TensorProto& tensor = *graph().add_initializer();
    tensor.set_name(fmt::format("constant_{}", ++values_));
    tensor.set_data_type(type);
    return tensor;
  }

  static void describe(onnx::ValueInfoProto& value, const std::string& name, onnx::TensorProto::DataType type,
                       const std::vector<Dimension>& shape) {
    value.set_name(name);
    onnx::TypeProto::Tensor& tensor = *value.mutable_type()->mutable_tensor_type();
    tensor.set_elem_type(type);
    tensor.mutable_shape();
    for (const Dimension& dimension : shape) {
      onnx::TensorShapeProto::Dimension& dim = *tensor.mutable_shape()->add_dim();
      if (const char* const* const named = std::get_if<const char*>(&dimension)) {
        dim.set_dim_param(*named);
      } else {
        dim.set_dim_value(std::get<std::int64_t>(dimension));
      }
    }
  }

  onnx::ModelProto model_;
  int values_ = 0;
};

// The inputs that say how graphs hang together, as rows to gather from and to add to.
struct GraphInputs {
  std::string sources;  // [E]
  std::string targets;  // [E, 1]
  std::string batch;    // [N]
  std::string graphs;   // [N, 1]
  std::string count;    // [1], B
};

GraphInputs add_graph_inputs(OnnxModel& model) {
  const std::string edges = model.input("edge_index", onnx::TensorProto::INT64, {2, "E"});
  const std::string batch = model.input("batch", onnx::TensorProto::INT64, {"N"});
  const std::string last_axis = model.constant({1});
  const std::string targets = model.add("Gather", {edges, model.index(1)});
  const std::string last_graph = model.add("ReduceMax", {batch}, {{"keepdims", 1}});
  return {.sources = model.add("Gather", {edges, model.index(0)}),
          .targets = model.add("Unsqueeze", {targets, last_axis}),
          .batch = batch,
          .graphs = model.add("Unsqueeze", {batch, last_axis}),
          .count = model.add("Add", {last_graph, model.constant({1})})};
}

// Adds rows up where `to` [rows, 1] says, in a matrix of that shape. Not by ScatterND: several threads of ONNX Runtime
// 1.23 add to one row at once there, and some sums are lost.
std::string add_rows(OnnxModel& model, const std::string& shape, const std::string& to, const std::string& rows) {
  const std::string zeros = model.add("ConstantOfShape", {shape});
  const std::string indices = model.add("Expand", {to, model.add("Shape", {rows})});
  return model.add("ScatterElements", {zeros, indices, rows}, {{"axis", 0}, {"reduction", "add"}});
}

// Sums each graph's rows: [N, width] to [B, width].
std::string pool(OnnxModel& model, const GraphInputs& graphs, int width, const std::string& x) {
  const std::string shape = model.add("Concat", {graphs.count, model.constant({width})}, {{"axis", 0}});
  return add_rows(model, shape, graphs.graphs, x);
}

// x Wᵀ + b.
std::string affine(OnnxModel& model, const std::string& x, const std::string& weight, const std::string& bias) {
  return model.add("Gemm", {x, weight, bias}, {{"transB", 1}});
}

// As GatedGraphConv, by PyTorch's formulas.
std::string gated_graph_conv(OnnxModel& model, const GraphInputs& graphs, const std::string& name,
                             const GatedGraphConvShape& shape, const std::string& x) {
  std::string h = x;
  if (shape.inputs < shape.width) h = model.add("Pad", {x, model.constant({0, 0, 0, shape.width - shape.inputs})});
  for (int step = 0; step < shape.steps; ++step) {
    const std::string theta = model.add("Gather", {name + ".weight", model.index(step)});
    const std::string sent = model.add("MatMul", {h, theta});
    const std::string along_edges = model.add("Gather", {sent, graphs.sources});
    const std::string message = add_rows(model, model.add("Shape", {sent}), graphs.targets, along_edges);
    const std::string of_message = affine(model, message, name + ".rnn.weight_ih", name + ".rnn.bias_ih");
    const std::string of_state = affine(model, h, name + ".rnn.weight_hh", name + ".rnn.bias_hh");
    const std::string thirds = model.constant({shape.width, shape.width, shape.width});
    const Names i = model.add_node("Split", {of_message, thirds}, 3, {{"axis", 1}});
    const Names s = model.add_node("Split", {of_state, thirds}, 3, {{"axis", 1}});
    const std::string r = model.add("Sigmoid", {model.add("Add", {i[0], s[0]})});
    const std::string z = model.add("Sigmoid", {model.add("Add", {i[1], s[1]})});
    const std::string n = model.add("Tanh", {model.add("Add", {i[2], model.add("Mul", {r, s[2]})})});
    // (1 - z) n + z h
    const std::string change = model.add("Mul", {z, model.add("Sub", {h, n})});
    h = model.add("Add", {n, change});
  }
  return shape.elu ? model.add("Elu", {h}) : h;
}

}  // namespace

void write_onnx(const std::filesystem::path& path, const PaperParameters& parameters) {
  OnnxModel model(parameters.description());
  model.add_tensors(parameters.views());
  std::string x = model.input("x", onnx::TensorProto::FLOAT, {"N", kConvShapes[0].inputs});
  const GraphInputs graphs = add_graph_inputs(model);
  for (std::size_t layer = 1; layer <= kConvShapes.size(); ++layer) {
    x = gated_graph_conv(model, graphs, fmt::format("conv{}", layer), kConvShapes[layer - 1], x);
    if (layer == kConvShapes.size()) break;
    const auto of_norm = [&](const char* tensor) { return fmt::format("bn{}.{}", layer, tensor); };
    x = model.add("BatchNormalization",
                  {x, of_norm("weight"), of_norm("bias"), of_norm("running_mean"), of_norm("running_var")},
                  {{"epsilon", kBatchNormEpsilon}});
  }
  const std::string pooled = pool(model, graphs, kFc1Shape.inputs, x);
  const std::string hidden = model.add("Elu", {affine(model, pooled, "fc1.weight", "fc1.bias")});
  affine(model, hidden, "fc2.weight", "fc2.bias");
  model.name_output("q");
  model.output("q", {"B", kActionCount});
  model.write(path);
}

void write_onnx(const std::filesystem::path& path, const ExplorerParameters& parameters) {
  constexpr int kNodeWidth = kExplorerConvShape.width;
  OnnxModel model(ExplorerParameters::description());
  model.add_tensors(parameters.views());
  const auto numbers = onnx::TensorProto::INT64;
  const std::string node_x = model.input("node_x", onnx::TensorProto::FLOAT, {"N", kExplorerNodeFeatureCount});
  const GraphInputs graphs = add_graph_inputs(model);
  const std::string current = model.input("current", numbers, {"B"});
  const std::string visit_x = model.input("visit_x", onnx::TensorProto::FLOAT, {"C", kExplorerVisitFeatureCount});
  const std::string target = model.input("target", numbers, {"C"});
  const std::string state = model.input("state", numbers, {"C"});

  const std::string embedded = gated_graph_conv(model, graphs, "conv", kExplorerConvShape, node_x);
  const std::string ones = model.add("Expand", {model.scalar(1), model.add("Shape", {graphs.graphs})});
  const std::string means = model.add("Div", {pool(model, graphs, kNodeWidth, embedded), pool(model, graphs, 1, ones)});
  const Names parts = {model.add("Gather", {embedded, target}),
                       model.add("Gather", {embedded, model.add("Gather", {current, state})}),
                       model.add("Gather", {means, state}), model.add("Gather", {node_x, target}), visit_x};
  const std::string joined = model.add("Concat", parts, {{"axis", 1}});
  const std::string hidden = model.add("Elu", {affine(model, joined, "head1.weight", "head1.bias")});
  const std::string column = affine(model, hidden, "head2.weight", "head2.bias");
  model.add("Squeeze", {column, model.constant({1})});
  model.name_output("shortfall");
  model.output("shortfall", {"C"});
  model.write(path);
}

}  // namespace graphdrl
