#include "graphdrl/nn/explorer_network.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "graphdrl/base/error.h"
#include "graphdrl/base/parallel.h"
#include "graphdrl/env/world_families.h"
#include "support.h"

namespace graphdrl {
namespace {

// A state some first visits into a walk.
struct Walked {
  Walked(const World& of, NodeId start, double budget) : world(of), task(of, start, budget), visited(of.node_count()) {
    visit(start, 0);
    spendable = budget;
  }
  void visit(NodeId node, double cost) {
    visited.insert(node);
    position = node;
    spendable -= cost;
  }
  Exploration state() const { return {task, visited, visited.count(), position, spendable}; }

  World world;
  Task task;
  NodeSet visited;
  NodeId position = 0;
  double spendable = 0;
};

std::vector<float> scores(const ExplorerParameters& parameters, const ExplorerBatch& batch) {
  ExplorerNetwork network;
  network.set_parameters(parameters);
  std::vector<float> shortfall(static_cast<std::size_t>(batch.visit_count()));
  network.forward(batch, shortfall);
  return shortfall;
}

// Makes first visits drawn at random.
void wander(Walked& walked, ExplorerScratch& scratch, int visits, Rng& rng) {
  for (; visits > 0; --visits) {
    ExplorerBatch batch;
    const auto found = encode(walked.state(), scratch, batch).visits;
    if (found.empty()) return;
    const FirstVisit visit = found[rng.below(static_cast<std::uint32_t>(found.size()))];
    walked.visit(visit.node, visit.cost);
  }
}

TEST(ExplorerFeatures, AreWorkedOutByHand) {
  // S . .    From S with 4 steps to spend: its right neighbour and the one below are the first visits.
  // . # .
  const World world = grid_world("...\n.#.\n");
  ExplorerScratch scratch;
  const Walked walked(world, 0, 4);
  ExplorerBatch batch;
  const auto visits = encode(walked.state(), scratch, batch).visits;
  ASSERT_EQ(visits.size(), 2u);
  EXPECT_EQ(visits[0].node, 1);
  EXPECT_EQ(visits[1].node, 3);
  EXPECT_EQ(batch.graphs.node_count(), 5);
  EXPECT_EQ(batch.ceiling, std::vector<double>{4});
  const auto feature = [&](int row, std::string_view name) {
    return batch.node_x[static_cast<std::size_t>(row) * kExplorerNodeFeatureCount +
                        feature_column(kExplorerNodeFeatures, name)];
  };
  const auto count = [](int nodes) { return static_cast<float>(std::log1p(nodes) / 4); };
  // Rows are nodes 0, 1, 2, 3, 5.
  EXPECT_EQ(feature(0, "unvisited"), 0);
  EXPECT_EQ(feature(0, "current"), 1);
  EXPECT_EQ(feature(0, "distance_to_work"), 1.0f / 8);
  EXPECT_EQ(feature(1, "candidate"), 1);
  EXPECT_EQ(feature(1, "visit_cost"), 1.0f / 8);
  EXPECT_EQ(feature(2, "candidate"), 0);
  EXPECT_EQ(feature(2, "distance"), 2.0f / 8);
  EXPECT_EQ(feature(3, "isolated"), 1);
  EXPECT_EQ(feature(2, "part_size"), count(3));
  EXPECT_EQ(feature(3, "part_size"), count(1));
  EXPECT_EQ(feature(1, "hanging_size"), count(3));  // 1, 2 and 5 can only be left by the way one came
  EXPECT_EQ(feature(5 - 1, "hanging_size"), count(1));
  EXPECT_EQ(feature(1, "hanging_height"), 3.0f / 8);
  EXPECT_EQ(feature(4, "budget_per_work"), 1);
  EXPECT_EQ(feature(4, "slack"), 0);
  // Of the visit to node 3: nothing unvisited next to it, and two steps back and on to node 1.
  const float* const to_3 = batch.visit_x.data() + kExplorerVisitFeatureCount;
  EXPECT_EQ(to_3[feature_column(kExplorerVisitFeatures, "cost")], 1.0f / 8);
  EXPECT_EQ(to_3[feature_column(kExplorerVisitFeatures, "change_of_penalties")], -4.0f / 4);  // an isolated node less
  EXPECT_EQ(to_3[feature_column(kExplorerVisitFeatures, "next_cost")], 2.0f / 8);
}

TEST(ExplorerFeatures, MarkTheTargetOfAFirstVisitThatCostsNothing) {
  const World world("free", Graph::from_edges(3, std::vector<Edge>{{0, 1, 0}, {1, 2, 1}}), std::vector<bool>(3));
  ExplorerScratch scratch;
  ExplorerBatch batch;
  encode(Walked(world, 0, 9).state(), scratch, batch);
  ASSERT_EQ(batch.target, std::vector<int>{1});
  EXPECT_EQ(batch.node_x[kExplorerNodeFeatureCount + feature_column(kExplorerNodeFeatures, "candidate")], 1);
}

TEST(ExplorerFeatures, LeaveOutWhatCannotBeReachedOrIsFarAway) {
  const World world = grid_world(std::string(200, '.') + "\n");
  ExplorerScratch scratch;
  ExplorerBatch batch;
  encode(Walked(world, 100, 5).state(), scratch, batch);
  EXPECT_EQ(batch.graphs.graph(0).node_count(), 11);
  encode(Walked(world, 100, 500).state(), scratch, batch);
  EXPECT_EQ(batch.graphs.graph(1).node_count(), kExplorerScope);
  // Each of its two ends has one neighbour of two out of scope.
  double out_of_scope = 0;
  for (int row = 11; row < batch.graphs.node_count(); ++row) {
    out_of_scope += batch.node_x[static_cast<std::size_t>(row) * kExplorerNodeFeatureCount +
                                 feature_column(kExplorerNodeFeatures, "out_of_scope")];
  }
  EXPECT_EQ(out_of_scope, 1);
  EXPECT_EQ(batch.visit_x.back(), 95.0f / 199) << "work_in_scope";
  EXPECT_EQ(batch.unseen[0], 0);
  EXPECT_DOUBLE_EQ(batch.unseen[1], 1 - 95.0 / 199);
  // Far from any unvisited node, the scope grows until a first visit is in it.
  Walked walked(world, 0, 1000);
  for (NodeId node = 1; node < 150; ++node) walked.visit(node, 1);
  walked.visit(0, 149);
  const auto [visits, left_out] = encode(walked.state(), scratch, batch);
  ASSERT_EQ(visits.size(), 1u);
  EXPECT_EQ(visits[0].node, 150);
  EXPECT_FALSE(left_out);
  EXPECT_EQ(batch.graphs.graph(2).node_count(), 151);

  // A star of 200 leaves, all of them first visits: more than the scope holds.
  std::vector<Edge> rays;
  for (NodeId leaf = 1; leaf <= 200; ++leaf) rays.push_back({0, leaf});
  const World star("star", Graph::from_edges(201, rays), std::vector<bool>(201));
  const SeenVisits seen = encode(Walked(star, 0, 9).state(), scratch, batch);
  EXPECT_EQ(seen.visits.size(), kExplorerScope - 1u);
  EXPECT_TRUE(seen.left_out);
}

TEST(ExplorerNetwork, DoesNotDependOnHowNodesAreNumbered) {
  Rng rng(1);
  const ExplorerParameters parameters(rng);
  int compared = 0;
  for (const char* const family : {"erdos-renyi", "barabasi-albert", "geometric"}) {
    for (const bool directed : {false, true}) {
      const World world = split_world({family, 40, true, directed}, Split::kValidation, 0);
      const NodeId nodes = world.graph().node_count();
      std::vector<NodeId> number(static_cast<std::size_t>(nodes));
      std::iota(number.begin(), number.end(), 0);
      for (NodeId i = nodes - 1; i > 0; --i) std::swap(number[i], number[rng.below(static_cast<std::uint32_t>(i + 1))]);
      std::vector<Edge> edges = world.graph().edges();
      for (Edge& edge : edges) edge = {number[edge.a], number[edge.b], edge.cost};
      const EdgeKind kind = directed ? EdgeKind::kDirected : EdgeKind::kUndirected;
      const World renumbered("renumbered", Graph::from_edges(nodes, edges, kind), std::vector<bool>(nodes));
      ExplorerScratch scratch;
      ExplorerScratch other;
      Walked walked(world, 0, 0.9 * nodes * world.open().mean_cost());
      wander(walked, scratch, 8, rng);
      Walked same(renumbered, number[walked.position], walked.spendable);
      for (NodeId node = 0; node < nodes; ++node) {
        if (walked.visited.contains(node)) same.visit(number[node], 0);
      }
      same.position = number[walked.position];
      ExplorerBatch batch;
      ExplorerBatch same_batch;
      const auto found = encode(walked.state(), scratch, batch).visits;
      const auto same_found = encode(same.state(), other, same_batch).visits;
      const std::vector<float> score = scores(parameters, batch);
      const std::vector<float> same_score = scores(parameters, same_batch);
      ASSERT_EQ(found.size(), same_found.size());
      compared += static_cast<int>(found.size());
      for (std::size_t i = 0; i < found.size(); ++i) {
        const auto twin = std::find_if(same_found.begin(), same_found.end(),
                                       [&](const FirstVisit& visit) { return visit.node == number[found[i].node]; });
        ASSERT_NE(twin, same_found.end());
        EXPECT_NEAR(score[i], same_score[twin - same_found.begin()], 1e-5);
      }
    }
  }
  EXPECT_GT(compared, 20);
}

// States of several worlds, one of them seen in part.
struct Sample {
  Sample() {
    Rng rng(2);
    for (const WorldSpec& spec :
         {WorldSpec{"obstacles", 6}, WorldSpec{"tree", 30}, WorldSpec{"geometric", 25, true, true}}) {
      worlds.push_back(split_world(spec, Split::kValidation, 1));
    }
    for (std::size_t i = 0; i < worlds.size(); ++i) {
      Walked walked(worlds[i], worlds[i].valid_nodes()[0], worlds[i].valid_count() * worlds[i].open().mean_cost());
      wander(walked, scratch, 5, rng);
      encode(walked.state(), scratch, batch, i == 1 ? 12 : kExplorerScope);
    }
  }
  std::vector<World> worlds;
  ExplorerScratch scratch;
  ExplorerBatch batch;
};

TEST(ExplorerNetwork, GivesTheSameBytesForAnyNumberOfThreads) {
  const Sample sample;
  Rng rng(3);
  const ExplorerParameters parameters(rng);
  const std::vector<float> together = scores(parameters, sample.batch);
  for (const int count : {2, 3}) {
    set_threads(count);
    EXPECT_EQ(scores(parameters, sample.batch), together) << count << " threads";
  }
  set_threads(1);
}

TEST(ExplorerNetwork, IsItsHeadOnTheConvolution) {
  const Sample sample;
  const ExplorerBatch& batch = sample.batch;
  Rng rng(6);
  const ExplorerParameters parameters(rng);
  constexpr int kWidth = kExplorerConvShape.width;
  GatedGraphConv conv(kExplorerConvShape);
  conv.set_weights(parameters.conv("conv"));
  std::vector<float> embedded(static_cast<std::size_t>(batch.graphs.node_count()) * kWidth);
  conv.forward(batch.graphs, batch.node_x.data(), embedded.data(), /*keep=*/false);
  const std::vector<float> score = scores(parameters, batch);
  for (int v = 0; v < batch.visit_count(); ++v) {
    const int graph = batch.state[v];
    std::vector<double> input;
    const auto add = [&](const float* values, int count) { input.insert(input.end(), values, values + count); };
    add(&embedded[batch.target[v] * kWidth], kWidth);
    add(&embedded[batch.current[graph] * kWidth], kWidth);
    const int first = batch.graphs.first_node(graph);
    const int end = batch.graphs.first_node(graph + 1);
    for (int i = 0; i < kWidth; ++i) {
      double sum = 0;
      for (int row = first; row < end; ++row) sum += embedded[row * kWidth + i];
      input.push_back(sum / (end - first));
    }
    add(&batch.node_x[batch.target[v] * kExplorerNodeFeatureCount], kExplorerNodeFeatureCount);
    add(&batch.visit_x[v * kExplorerVisitFeatureCount], kExplorerVisitFeatureCount);
    ASSERT_EQ(std::ssize(input), kExplorerHeadInputs);
    const auto layer = [](const LinearTensors<const float>& weights, LinearShape shape, const std::vector<double>& x) {
      std::vector<double> out(weights.bias, weights.bias + shape.outputs);
      for (int o = 0; o < shape.outputs; ++o) {
        for (int i = 0; i < shape.inputs; ++i) out[o] += double{weights.weight[o * shape.inputs + i]} * x[i];
      }
      return out;
    };
    std::vector<double> hidden = layer(parameters.linear("head1"), kExplorerHead1, input);
    for (double& value : hidden) value = value > 0 ? value : std::expm1(value);
    EXPECT_NEAR(score[v], layer(parameters.linear("head2"), kExplorerHead2, hidden)[0], 1e-5) << v;
  }
}

TEST(ExplorerNetwork, HasTheGradientOfItsOutput) {
  const Sample sample;
  Rng rng(4);
  ExplorerParameters parameters(rng);
  std::vector<float> weighting(static_cast<std::size_t>(sample.batch.visit_count()));
  for (float& weight : weighting) weight = static_cast<float>(2 * rng.uniform() - 1);
  ExplorerNetwork network;
  network.set_parameters(parameters);
  std::vector<float> shortfall(weighting.size());
  network.forward(sample.batch, shortfall, /*keep=*/true);
  ExplorerParameters grad;
  network.backward(sample.batch, weighting, grad);
  const auto loss = [&] {
    const std::vector<float> score = scores(parameters, sample.batch);
    return std::inner_product(score.begin(), score.end(), weighting.begin(), 0.0);
  };
  // Along a random direction within each tensor; single values would drown in float32's rounding.
  for (const TensorSpec& spec : ExplorerParameters::specs()) {
    std::vector<float> direction(spec.size);
    double expected = 0;
    for (std::size_t i = 0; i < spec.size; ++i) {
      direction[i] = rng.below(2) == 0 ? 1.0f : -1.0f;
      expected += double{direction[i]} * grad.values()[spec.offset + i];
    }
    const std::vector<float> kept(parameters.values().begin(), parameters.values().end());
    const auto loss_at = [&](float step) {
      for (std::size_t i = 0; i < spec.size; ++i) {
        parameters.values()[spec.offset + i] = kept[spec.offset + i] + step * direction[i];
      }
      return loss();
    };
    constexpr float kStep = 3e-4f;
    const double slope = (loss_at(kStep) - loss_at(-kStep)) / (2 * kStep);
    loss_at(0);
    EXPECT_NEAR(slope, expected, 5e-2 * (0.1 + std::abs(expected))) << spec.name;
  }
}

TEST(ExplorerParameters, SurviveTheirPolicyFile) {
  const TemporaryFolder folder;
  Rng rng(5);
  const ExplorerParameters parameters(rng);
  write_policy_file(folder / "policy", parameters);
  const ExplorerParameters read = read_explorer(Safetensors::read(folder / "policy"));
  EXPECT_TRUE(std::ranges::equal(read.values(), parameters.values()));
  EXPECT_LT(std::filesystem::file_size(folder / "policy"), 1'000'000u);
}

}  // namespace
}  // namespace graphdrl
