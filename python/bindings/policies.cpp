#include "bindings.h"
#include "graphdrl/base/error.h"
#include "graphdrl/nn/onnx_export.h"
#include "graphdrl/planners/paper_policy.h"
#include "graphdrl/planners/planner_policy.h"
#include "graphdrl/planners/registry.h"

namespace graphdrl::python {
namespace {

using Tensors = std::vector<InArray<float>>;

// Tensors in the order of the specs.
template <typename Parameters>
Parameters from_tensors(const Tensors& tensors) {
  const std::vector<TensorSpec>& specs = Parameters::specs();
  if (tensors.size() != specs.size()) throw Error({.what = "bad number of tensors"});
  Parameters parameters;
  for (std::size_t i = 0; i < specs.size(); ++i) {
    const InArray<float>& tensor = tensors[i];
    Shape shape;
    for (std::size_t axis = 0; axis < tensor.ndim(); ++axis)
      shape.push_back(static_cast<std::int64_t>(tensor.shape(axis)));
    if (shape != specs[i].shape) {
      throw Error({.what = "bad shape of tensor " + in_quotes(specs[i].name),
                   .expected = format_shape(specs[i].shape),
                   .got = format_shape(shape)});
    }
    parameters.set(specs[i], values_of<float>(tensor), "tensors");
  }
  return parameters;
}

// By name, copies.
nb::dict tensors_of(const ParameterBuffer& parameters, const std::vector<TensorSpec>& specs) {
  nb::dict out;
  for (const TensorSpec& spec : specs) {
    const auto values = parameters.values().subspan(spec.offset, spec.size);
    auto* const owned = new std::vector<float>(values.begin(), values.end());
    const nb::capsule owner(owned, [](void* p) noexcept { delete static_cast<std::vector<float>*>(p); });
    const std::vector<std::size_t> shape(spec.shape.begin(), spec.shape.end());
    out[spec.name.c_str()] = nb::ndarray<nb::numpy, float>(owned->data(), shape.size(), shape.data(), owner);
  }
  return out;
}

// Graphs as ONNX models and PyTorch Geometric want them.
void add_graphs(const GraphBatch& graphs, nb::dict& inputs) {
  std::vector<std::int64_t> sources;
  std::vector<std::int64_t> targets;
  std::vector<std::int64_t> batch;
  for (int g = 0; g < graphs.graph_count(); ++g) {
    const Graph& graph = graphs.graph(g);
    const int first = graphs.first_node(g);
    for (NodeId node = 0; node < graph.node_count(); ++node) {
      batch.push_back(g);
      for (const NodeId next : graph.neighbours(node)) {
        sources.push_back(first + next);
        targets.push_back(first + node);
      }
    }
  }
  const std::size_t edges = sources.size();
  sources.insert(sources.end(), targets.begin(), targets.end());
  inputs["edge_index"] = edges > 0
                             ? nb::cast(to_numpy(std::move(sources), edges))
                             : nb::cast(nb::ndarray<nb::numpy, std::int64_t, nb::ndim<2>>(nullptr, {2, 0}, nb::none()));
  inputs["batch"] = to_numpy(std::move(batch));
}

nb::object numbers(const std::vector<int>& values) {
  return nb::cast(to_numpy(std::vector<std::int64_t>(values.begin(), values.end())));
}

// An explorer in Python's hands: its network, and its scratch memory for questions about single states.
class Explorer {
 public:
  explicit Explorer(SharedExplorer parameters) : parameters_(std::move(parameters)), scorer_(parameters_) {}
  explicit Explorer(const Tensors& tensors)
      : Explorer(std::make_shared<const ExplorerParameters>(from_tensors<ExplorerParameters>(tensors))) {}

  const ExplorerParameters& parameters() const { return *parameters_; }
  const SharedExplorer& shared() const { return parameters_; }

  // Appends a state to the batch. Gives its first visits until the next call.
  std::span<const FirstVisit> append(const State& state, ExplorerBatch& batch) {
    const NodeSet ground = state.get().ground();
    return encode(Exploration(state.get(), ground), scratch_, batch).visits;
  }

  // Nodes, costs, shortfalls, the ceiling, and the index of the one it would make, or -1.
  nb::tuple first_visits(const State& state) {
    ExplorerBatch batch;
    const auto visits = append(state, batch);
    std::vector<NodeId> nodes;
    std::vector<double> costs;
    for (const FirstVisit& visit : visits) {
      nodes.push_back(visit.node);
      costs.push_back(visit.cost);
    }
    std::vector<float> shortfalls;
    int choice = -1;
    if (!visits.empty()) {
      scorer_.shortfalls(batch, shortfalls);
      choice = static_cast<int>(scorer_.choose(*state.get().task, batch, visits));
    }
    return nb::make_tuple(to_numpy(std::move(nodes)), to_numpy(std::move(costs)), to_numpy(std::move(shortfalls)),
                          batch.ceiling[0], choice);
  }

  nb::dict inputs(const std::vector<const State*>& states) {
    ExplorerBatch batch;
    for (const State* const state : states) append(*state, batch);
    nb::dict inputs;
    inputs["node_x"] = to_numpy(std::move(batch.node_x), kExplorerNodeFeatureCount);
    add_graphs(batch.graphs, inputs);
    inputs["current"] = numbers(batch.current);
    inputs["visit_x"] = to_numpy(std::move(batch.visit_x), kExplorerVisitFeatureCount);
    inputs["target"] = numbers(batch.target);
    inputs["state"] = numbers(batch.state);
    return inputs;
  }

 private:
  SharedExplorer parameters_;
  ExplorerScorer scorer_;
  ExplorerScratch scratch_;
};

// The paper's network in Python's hands.
class QNetwork {
 public:
  explicit QNetwork(PaperParameters parameters) : parameters_(parameters), policy_(std::move(parameters)) {}
  QNetwork(const Tensors& tensors, const std::string& wall) : QNetwork(described(tensors, wall)) {}

  const PaperParameters& parameters() const { return parameters_; }

  auto q_values(const std::vector<const State*>& states) {
    std::vector<float> q(states.size() * kActionCount);
    policy_.q_values(observations_of(states), q);
    return to_numpy(std::move(q), kActionCount);
  }

  nb::dict inputs(const std::vector<const State*>& states) {
    GraphBatch batch;
    std::vector<float> x;
    for (const Observation& now : observations_of(states)) {
      batch.add(now.view().grid().graph());
      const std::size_t size = x.size();
      x.resize(static_cast<std::size_t>(batch.node_count()) * kPaperFeatureCount);
      policy_.encoder_for(now.view()).encode(now.position, now.visits, std::span(x).subspan(size));
    }
    nb::dict inputs;
    inputs["x"] = to_numpy(std::move(x), kPaperFeatureCount);
    add_graphs(batch, inputs);
    return inputs;
  }

 private:
  static PaperParameters described(const Tensors& tensors, const std::string& wall) {
    PaperParameters parameters = from_tensors<PaperParameters>(tensors);
    parameters.set_wall(parse_paper_wall(wall));
    return parameters;
  }

  static std::vector<Observation> observations_of(const std::vector<const State*>& states) {
    std::vector<Observation> observations;
    for (const State* const state : states) observations.push_back(state->get());
    return observations;
  }

  PaperParameters parameters_;
  PaperPolicy policy_;
};

// What both networks have.
template <typename Network, typename Parameters>
nb::class_<Network> bind_network(nb::module_& module, const char* name) {
  nb::list tensors;
  for (const TensorSpec& spec : Parameters::specs()) {
    nb::list shape;
    for (const std::int64_t extent : spec.shape) shape.append(extent);
    tensors.append(nb::make_tuple(spec.name, nb::tuple(shape), spec.trainable));
  }
  nb::class_<Network> network(module, name);
  network.def_prop_ro("tensors", [](const Network& self) { return tensors_of(self.parameters(), Parameters::specs()); })
      .def("save", [](const Network& self, const std::string& path) { write_policy_file(path, self.parameters()); })
      .def("export_onnx", [](const Network& self, const std::string& path) { write_onnx(path, self.parameters()); })
      .def("inputs", &Network::inputs, nb::arg("states"));
  network.attr("specs") = tensors;
  return network;
}

}  // namespace

OwnPolicy own_policy_of(nb::handle policy) {
  if (nb::isinstance<Explorer>(policy)) {
    return {.planner = [parameters = nb::cast<Explorer&>(policy).shared()]() -> std::unique_ptr<Planner> {
              return std::make_unique<ExplorerPlanner>(std::make_shared<ExplorerScorer>(parameters));
            },
            .policy = {}};
  }
  if (nb::isinstance<QNetwork>(policy)) {
    const QNetwork* const network = &nb::cast<QNetwork&>(policy);
    return {.planner = {}, .policy = [network]() -> std::unique_ptr<Policy> {
              return std::make_unique<PaperPolicy>(network->parameters());
            }};
  }
  return {.planner = {}, .policy = [policy] {
            const nb::gil_scoped_acquire lock;
            return make_callable_policy(nb::borrow(policy));
          }};
}

std::unique_ptr<Policy> OwnPolicy::as_policy() const {
  return planner ? std::make_unique<PlannerPolicy>(planner()) : policy();
}

void bind_policies(nb::module_& module) {
  bind_network<Explorer, ExplorerParameters>(module, "Explorer")
      .def(nb::init<const Tensors&>(), nb::arg("tensors"))
      .def_static("builtin", [] { return std::make_unique<Explorer>(builtin_explorer()); })
      .def("first_visits", &Explorer::first_visits, nb::arg("state"));
  bind_network<QNetwork, PaperParameters>(module, "PaperNetwork")
      .def(nb::init<const Tensors&, const std::string&>(), nb::arg("tensors"), nb::arg("wall"))
      .def_prop_ro("wall", [](const QNetwork& self) { return std::string(name_of(self.parameters().wall())); })
      .def_static("random",
                  [](std::uint64_t seed) {
                    Rng rng(seed);
                    return std::make_unique<QNetwork>(PaperParameters(rng));
                  })
      .def("q_values", &QNetwork::q_values, nb::arg("states"));
  module.def(
      "read_policy",
      [](const std::string& path) -> nb::object {
        KnownMapPolicy policy = read_known_map_policy(path);
        if (auto* const explorer = std::get_if<SharedExplorer>(&policy)) {
          return nb::cast(std::make_unique<Explorer>(*explorer));
        }
        return nb::cast(std::make_unique<QNetwork>(std::get<PaperParameters>(std::move(policy))));
      },
      nb::arg("path"));
}

}  // namespace graphdrl::python
