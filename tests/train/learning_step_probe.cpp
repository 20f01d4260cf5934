// Computes Q-values, targets, loss and every gradient of one learning step on random states of several maps, and writes
// them with everything they depend on to a safetensors file, for a PyTorch model to compute again.
//   learning_step_probe OUT [--double-dqn]
#include <string_view>
#include <utility>

#include "graphdrl/env/episode.h"
#include "graphdrl/env/load_worlds.h"
#include "graphdrl/nn/paper_features.h"
#include "graphdrl/train/paper_kernel_learner.h"

namespace graphdrl {
namespace {

constexpr double kDiscount = 0.99;

// Another network's values with batch norm statistics that are not the initial ones, so that none of them cancels out.
PaperParameters disturbed(Rng& rng) {
  PaperParameters parameters(rng);
  for (const TensorSpec& spec : PaperParameters::specs()) {
    if (!spec.name.starts_with("bn")) continue;
    for (float& value : parameters.values().subspan(spec.offset, spec.size)) {
      value += 0.5f * static_cast<float>(rng.uniform());
    }
  }
  return parameters;
}

struct Probe {
  PaperMinibatch batch;
  // The batch's edges, and where each graph's nodes begin.
  std::vector<std::int64_t> from;
  std::vector<std::int64_t> to;
  std::vector<std::int64_t> first_nodes = {0};
};

// Adds a random transition.
void add_transition(const World& world, bool terminal, Rng& rng, Probe& probe) {
  const PaperFeatureEncoder encoder(world);
  PaperMinibatch& batch = probe.batch;
  Episode episode(world, {.budget = 40, .end_at_full_coverage = true});
  episode.reset(world.valid_nodes()[rng.below(static_cast<std::uint32_t>(world.valid_count()))]);
  for (std::uint32_t steps = rng.below(25); steps > 0; --steps) episode.step(static_cast<int>(rng.below(4)));
  const std::size_t row = batch.x.size();
  const std::size_t size = episode.visits().size() * kPaperFeatureCount;
  batch.x.resize(row + size);
  batch.next_x.resize(row + size);
  encoder.encode(episode.position(), std::span(episode.visits()), std::span(batch.x).subspan(row));
  batch.actions.push_back(rng.below(4));
  batch.rewards.push_back(static_cast<float>(episode.step(static_cast<int>(batch.actions.back())).reward));
  batch.terminal.push_back(terminal);
  encoder.encode(episode.position(), std::span(episode.visits()), std::span(batch.next_x).subspan(row));
  for (NodeId node = 0; node < world.graph().node_count(); ++node) {
    for (const NodeId next : world.graph().neighbours(node)) {
      probe.from.push_back(probe.first_nodes.back() + next);
      probe.to.push_back(probe.first_nodes.back() + node);
    }
  }
  batch.graphs.add(world.graph());
  probe.first_nodes.push_back(batch.graphs.node_count());
}

int write_probe(const std::string& out, bool double_dqn) {
  Rng rng(42);
  std::vector<World> worlds = load_worlds({"paper"});
  worlds.emplace_back("wide", GridMap{.rows = 3, .cols = 9, .blocked = std::vector<bool>(27)});
  worlds.emplace_back("large", GridMap{.rows = 11, .cols = 11, .blocked = std::vector<bool>(121)});
  Probe probe;
  PaperMinibatch& batch = probe.batch;
  batch.graphs.clear();
  for (int i = 0; i < 32; ++i) {
    add_transition(worlds[static_cast<std::size_t>(i) % worlds.size()], /*terminal=*/i % 7 == 3, rng, probe);
  }

  PaperKernelLearner learner({.double_dqn = double_dqn, .discount = kDiscount}, rng);
  PaperState state = learner.state();
  state.online = disturbed(rng);
  state.target = disturbed(rng);
  learner.set_state(state);
  std::vector<float> q(batch.actions.size() * kActionCount);
  learner.q_values(batch.graphs, batch.x, q);
  const std::vector<float> keep_scale = draw_keep_scale(batch.graphs.graph_count(), kHiddenWidth, 0.5, rng);
  const std::vector<double> loss = {learner.compute_gradients(batch, keep_scale)};

  const auto n = static_cast<std::int64_t>(batch.graphs.node_count());
  const auto b = static_cast<std::int64_t>(batch.graphs.graph_count());
  const auto e = static_cast<std::int64_t>(probe.from.size());
  const std::vector<std::int64_t> terminal(batch.terminal.begin(), batch.terminal.end());
  const std::vector<double> discount = {kDiscount};
  std::vector<TensorView> tensors;
  const auto add = [&]<typename T>(const char* name, Shape shape, const std::vector<T>& values) {
    tensors.emplace_back(name, std::move(shape), std::span<const T>(values));
  };
  add("x", {n, kPaperFeatureCount}, batch.x);
  add("next_x", {n, kPaperFeatureCount}, batch.next_x);
  add("edges.from", {e}, probe.from);
  add("edges.to", {e}, probe.to);
  add("first_nodes", {b + 1}, probe.first_nodes);
  add("actions", {b}, batch.actions);
  add("rewards", {b}, batch.rewards);
  add("terminal", {b}, terminal);
  add("discount", {1}, discount);
  add("keep_scale", {b, kHiddenWidth}, keep_scale);
  add("q", {b, kActionCount}, q);
  add("loss", {1}, loss);
  for (const auto& [prefix, parameters] :
       {std::pair("online.", &std::as_const(state.online)),  // before the running statistics move
        std::pair("grad.", &learner.gradients()), std::pair("target.", &learner.target()),
        std::pair("after.", &learner.online())}) {
    for (const TensorView& view : parameters->views(prefix)) tensors.push_back(view);
  }
  write_safetensors(out, tensors, {});
  return 0;
}

}  // namespace
}  // namespace graphdrl

int main(int argc, char** argv) {
  if (argc < 2) return 2;
  return graphdrl::write_probe(argv[1], argc > 2 && std::string_view(argv[2]) == "--double-dqn");
}
