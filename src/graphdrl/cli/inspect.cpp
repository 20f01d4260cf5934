#include <fmt/format.h>

#include <memory>

#include "graphdrl/cli/commands.h"
#include "graphdrl/cli/program.h"
#include "graphdrl/env/load_worlds.h"
#include "graphdrl/env/walk.h"
#include "graphdrl/planners/network_policy.h"

namespace graphdrl {
namespace {

struct InspectOptions {
  std::string policy;
  std::string map;
  std::vector<NodeId> walk;
  bool json = false;
};

// What the policy sees and thinks at one node of the walk.
struct InspectedStep {
  NodeId position;
  std::vector<float> features;           // [N, F]
  std::array<float, kActionCount> q;     // raw
  std::array<bool, kActionCount> legal;  // false where the move would be blocked
};

std::vector<InspectedStep> inspect_walk(NetworkPolicy& policy, const InspectOptions& options) {
  const World world = load_one_world(options.map);
  Episode episode(world, {.budget = static_cast<double>(options.walk.size())});
  std::vector<InspectedStep> steps;
  follow_walk(episode, options.walk, [&](const Observation& observation) {
    InspectedStep step{.position = observation.position, .features = {}, .q = {}, .legal = {}};
    step.features.resize(static_cast<std::size_t>(world.graph().node_count()) * kFeatureCount);
    policy.encoder_for(world).encode(observation.position, observation.visits, std::span(step.features));
    policy.q_values({&observation, 1}, step.q);
    for (int action = 0; action < kActionCount; ++action) {
      step.legal[action] = observation.legal(action);
    }
    steps.push_back(std::move(step));
  });
  return steps;
}

Json to_json(const std::vector<InspectedStep>& steps) {
  Json json = Json::array();
  for (const InspectedStep& step : steps) {
    Json features = Json::array();
    for (std::size_t row = 0; row < step.features.size(); row += kFeatureCount) {
      features.push_back(std::vector(&step.features[row], &step.features[row] + kFeatureCount));
    }
    json.push_back({{"position", step.position}, {"features", features}, {"q", step.q}, {"legal", step.legal}});
  }
  return json;
}

std::string format_tensors() {
  std::string text = fmt::format("{} parameters\n\n{:22}  {:12}  {:>9}\n", PaperParameters::trainable_count(), "tensor",
                                 "shape", "values");
  for (const TensorSpec& spec : PaperParameters::specs()) {
    text += fmt::format("{:22}  {:12}  {:9}{}\n", spec.name, format_shape(spec.shape), spec.size,
                        spec.trainable ? "" : "  (statistics)");
  }
  return text;
}

std::string format_steps(const std::vector<InspectedStep>& steps) {
  std::string text;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const InspectedStep& step = steps[i];
    text += fmt::format("\nstep {}, at node {}\n  Q-values:", i, step.position);
    const int greedy = argmax(step.q);
    for (int action = 0; action < kActionCount; ++action) {
      text += fmt::format("  {} {:.4f}{}{}", kDirectionNames[action], step.q[action], action == greedy ? "*" : "",
                          step.legal[action] ? "" : " (blocked)");
    }
    text += "\n  node";
    for (const std::string_view name : kFeatureNames) text += fmt::format("  {}", name);
    text += '\n';
    for (std::size_t row = 0; row < step.features.size(); row += kFeatureCount) {
      text += fmt::format("  {:4}", row / kFeatureCount);
      for (int f = 0; f < kFeatureCount; ++f) {
        text += fmt::format("  {:>{}g}", step.features[row + f], kFeatureNames[f].size());
      }
      text += '\n';
    }
  }
  return text;
}

void inspect(const InspectOptions& options) {
  NetworkPolicy policy(read_policy_file(options.policy));
  std::vector<InspectedStep> steps;
  if (!options.walk.empty()) steps = inspect_walk(policy, options);
  if (!options.json) {
    print_text(format_tensors() + format_steps(steps));
    return;
  }
  Json json;
  json["parameters"] = PaperParameters::trainable_count();
  json["tensors"] = Json::array();
  for (const TensorSpec& spec : PaperParameters::specs()) {
    json["tensors"].push_back({{"name", spec.name}, {"shape", spec.shape}});
  }
  if (!options.walk.empty()) json["steps"] = to_json(steps);
  print_json(json);
}

}  // namespace

void add_inspect_command(CLI::App& app) {
  CLI::App* const command =
      app.add_subcommand("inspect", "Show what a policy file holds, and what it sees and thinks along a walk");
  const auto options = std::make_shared<InspectOptions>();
  command->add_option("policy", options->policy, "A policy file")->required()->type_name("POLICY");
  CLI::Option* const map = command->add_option("--map", options->map, "The map to walk on")->type_name("M");
  command->add_option("--walk", options->walk, "Node ids, as 0,1,1,2; a repeated id is a blocked move")
      ->delimiter(',')
      ->check(not_empty())
      ->type_name("IDS")
      ->needs(map);
  map->needs(command->get_option("--walk"));
  command->add_flag("--json", options->json, "Print one JSON document");
  add_threads_option(*command);
  command->callback([options] { inspect(*options); });
}

}  // namespace graphdrl
