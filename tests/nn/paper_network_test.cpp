#include "graphdrl/nn/paper_network.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>

#include "graphdrl/io/file.h"
#include "graphdrl/nn/paper_features.h"
#include "safetensors_support.h"
#include "support.h"

namespace graphdrl {
namespace {

using ::testing::HasSubstr;

PaperParameters some_parameters(std::uint64_t seed = 1) {
  Rng rng(seed);
  return PaperParameters(rng);
}

TEST(PaperNetwork, CountsTheParametersOfTable1) {
  std::map<std::string, std::size_t> by_layer;
  for (const TensorSpec& spec : PaperParameters::specs()) {
    if (spec.trainable) by_layer[spec.name.substr(0, spec.name.find('.'))] += spec.size;
  }
  const std::map<std::string, std::size_t> expected = {{"conv1", 532}, {"bn1", 14},        {"conv2", 41'344},
                                                       {"bn2", 128},   {"conv3", 164'608}, {"fc1", 33'024},
                                                       {"fc2", 1'028}};
  EXPECT_EQ(by_layer, expected);
  EXPECT_EQ(PaperParameters::trainable_count(), 240'678u);
}

TEST(PaperNetwork, StartsAsPyTorchDoes) {
  const PaperParameters parameters = some_parameters();
  const auto largest = [&](const std::string& name, std::size_t size) {
    const std::span values(parameters.tensor(name), size);
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    EXPECT_NEAR(-*low, *high, 1e-3) << name;
    const double mean = std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(size);
    EXPECT_NEAR(mean, 0, 4 * *high / std::sqrt(3.0 * static_cast<double>(size))) << name;
    return *high;
  };
  // Uniform within ± a bound: the largest of many values is just below it.
  EXPECT_NEAR(largest("conv3.weight", 4 * 128 * 128), 1 / std::sqrt(128.0f), 1e-4);
  EXPECT_NEAR(largest("conv2.rnn.weight_hh", 192 * 64), 1 / std::sqrt(64.0f), 1e-3);
  EXPECT_NEAR(largest("fc1.weight", 256 * 128), 1 / std::sqrt(128.0f), 1e-4);
  EXPECT_NEAR(largest("fc2.weight", 4 * 256), 1 / std::sqrt(256.0f), 1e-3);
  EXPECT_EQ(parameters.tensor("bn2.weight")[63], 1);
  EXPECT_EQ(parameters.tensor("bn2.bias")[63], 0);
  EXPECT_EQ(parameters.tensor("bn1.running_mean")[0], 0);
  EXPECT_EQ(parameters.tensor("bn1.running_var")[6], 1);
}

TEST(PaperNetwork, GivesABatchWhatItGivesEachGraphAlone) {
  const PaperParameters parameters = some_parameters();
  PaperNetwork network;
  network.set_parameters(parameters);
  const std::vector<Graph> graphs = {Graph::grid(5, 5), Graph::grid(2, 3), Graph::grid(12, 12), Graph::grid(5, 5)};
  Rng rng(2);
  GraphBatch batch;
  std::vector<float> x;
  std::vector<float> expected;
  for (const Graph& graph : graphs) {
    batch.add(graph);
    GraphBatch single;
    single.add(graph);
    std::vector<float> own;
    for (int i = 0; i < graph.node_count() * kPaperFeatureCount; ++i) own.push_back(static_cast<float>(rng.below(5)));
    std::array<float, 4> q{};
    network.q_values(single, own, q);
    expected.insert(expected.end(), q.begin(), q.end());
    x.insert(x.end(), own.begin(), own.end());
  }
  std::vector<float> q(4 * graphs.size());
  network.q_values(batch, x, q);
  for (std::size_t i = 0; i < q.size(); ++i) EXPECT_NEAR(q[i], expected[i], 1e-4 * (1 + std::abs(expected[i])));
}

TEST(PolicyFile, RoundTripsAndHoldsNoOtherTensor) {
  const TemporaryFolder folder;
  const PaperParameters parameters = some_parameters();
  write_policy_file(folder / "p.safetensors", parameters);
  const PaperParameters copy = read_policy_file(folder / "p.safetensors");
  EXPECT_TRUE(std::equal(copy.values().begin(), copy.values().end(), parameters.values().begin()));
  const Safetensors file = Safetensors::read(folder / "p.safetensors");
  EXPECT_EQ(file.entries().size(), 27u);
  EXPECT_EQ(file.get<float>("conv1.rnn.weight_ih", {21, 7}).size(), 147u);
}

TEST(PolicyFile, SaysWhichWallItsNetworkSees) {
  const TemporaryFolder folder;
  PaperParameters parameters = some_parameters();
  // A file without the key, as all were before there was one, is of the border.
  write_policy_file(folder / "border", parameters);
  EXPECT_FALSE(policy_description(Safetensors::read(folder / "border")).contains("wall"));
  EXPECT_EQ(read_policy_file(folder / "border").wall(), PaperWall::kBorder);

  parameters.set_wall(PaperWall::kZeroOrNine);
  write_policy_file(folder / "author", parameters);
  EXPECT_EQ(policy_description(Safetensors::read(folder / "author"))["wall"], "zero_or_nine");
  EXPECT_EQ(read_policy_file(folder / "author").wall(), PaperWall::kZeroOrNine);

  nlohmann::json description = parameters.description();
  const auto described = [&](const nlohmann::json& wall) {
    description["wall"] = wall;
    write_safetensors(folder / "own", parameters.views(), {{"network", description.dump()}});
    return error_of([&] { EXPECT_EQ(read_policy_file(folder / "own").wall(), PaperWall::kBorder); });
  };
  EXPECT_EQ(described("border"), "");
  EXPECT_THAT(described("edge"),
              HasSubstr("own: unknown kind of the feature 'wall': expected border or zero_or_nine, got 'edge'"));
  EXPECT_THAT(described(9), HasSubstr("got '9'"));
  EXPECT_THAT(described("a\nb"), HasSubstr("got 'a\\x0ab'"));
}

TEST(PolicyFile, IsRefusedWhenItIsAnothersOrDamaged) {
  const TemporaryFolder folder;
  const PaperParameters parameters = some_parameters();
  write_policy_file(folder / "p", parameters);
  const std::string whole = read_file(folder / "p");
  const auto error_for = [&](const std::string& content) {
    write_file(folder / "bad", content);
    return error_of([&] { read_policy_file(folder / "bad"); });
  };
  const auto replaced = [&](const std::string& from, const std::string& to) {
    std::string content = whole;
    content.replace(content.find(from), from.size(), to);
    return with_checksum(content);
  };
  EXPECT_EQ(error_for(whole), "");
  std::string flipped = whole;
  flipped[whole.size() - 5] = static_cast<char>(flipped[whole.size() - 5] ^ 1);
  EXPECT_THAT(error_for(flipped), HasSubstr("the file is damaged"));
  EXPECT_THAT(error_for(replaced("\"layout\":\"2\"", "\"layout\":\"9\"")), HasSubstr("expected layout 2, got '9'"));
  EXPECT_THAT(error_for(whole.substr(0, whole.size() - 1)), HasSubstr("lies outside the file"));
  EXPECT_THAT(error_for(whole.substr(0, 100)), HasSubstr("not a whole safetensors file"));
  EXPECT_THAT(error_for(replaced("[4,7,7]", "[7,4,7]")), HasSubstr("wrong shape: expected [4, 7, 7], got [7, 4, 7]"));
  EXPECT_THAT(error_for(replaced("\"F32\"", "\"I32\"")), HasSubstr("wrong type: expected F32, got I32"));
  EXPECT_THAT(error_for(replaced("conv1.weight", "conv9.weight")), HasSubstr("'conv1.weight' is missing"));
  EXPECT_THAT(error_for(replaced("\\\"width\\\":64", "\\\"width\\\":63")), HasSubstr("policy of another network"));
  EXPECT_THAT(error_for(replaced("\"network\"", "\"notwork\"")), HasSubstr("not a policy file"));
  EXPECT_THAT(error_for(""), HasSubstr("not a safetensors file"));

  // A description of its own in a file that is whole otherwise.
  const auto described = [&](const std::string& description) {
    write_safetensors(folder / "own", parameters.views(), {{"network", description}});
    return error_of([&] { read_policy_file(folder / "own"); });
  };
  const std::string deep = std::string(1'000'000, '[') + std::string(1'000'000, ']');
  EXPECT_THAT(described("{\"kind\":" + deep + "}"), HasSubstr("nested too deeply"));
  EXPECT_THAT(described("{\"kind\""), HasSubstr("not JSON: expected a network's description"));
  EXPECT_THAT(described("{\"actions\":[[7]]}"), HasSubstr("got '[[7]]'"));

  PaperParameters broken = parameters;
  broken.tensor("fc1.bias")[3] = NAN;
  write_policy_file(folder / "nan", broken);
  EXPECT_THAT(error_of([&] { read_policy_file(folder / "nan"); }),
              HasSubstr("'fc1.bias' holds a value that no network"));

  std::vector<TensorView> more = parameters.views();
  const std::vector<float> extra = {1};
  more.emplace_back("extra", Shape{1}, std::span(extra));
  write_safetensors(folder / "more", more, Safetensors::read(folder / "p").metadata());
  EXPECT_THAT(error_of([&] { read_policy_file(folder / "more"); }), HasSubstr("expected 27 tensors, got 28"));
}

}  // namespace
}  // namespace graphdrl
