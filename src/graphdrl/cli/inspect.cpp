#include <fmt/format.h>

#include <memory>

#include "graphdrl/base/error.h"
#include "graphdrl/cli/commands.h"
#include "graphdrl/cli/program.h"
#include "graphdrl/env/episode.h"
#include "graphdrl/env/load_worlds.h"
#include "graphdrl/env/task.h"
#include "graphdrl/planners/paper_policy.h"
#include "graphdrl/planners/registry.h"

namespace graphdrl {
namespace {

struct InspectOptions {
  std::string policy;
  std::string map;
  std::vector<NodeId> walk;
  std::string budget = "1.1x";
  bool budget_given = false;
  bool json = false;
};

// What the policy sees and thinks at one node of the walk.
struct InspectedStep {
  NodeId position;
  std::vector<float> features;           // [N, F]
  std::array<float, kActionCount> q;     // raw
  std::array<bool, kActionCount> legal;  // false if the move would be blocked
};

std::vector<InspectedStep> inspect_walk(PaperPolicy& policy, const InspectOptions& options) {
  const World world = load_one_world(options.map);
  Episode episode(world, {.budget = static_cast<double>(options.walk.size())});
  std::vector<InspectedStep> steps;
  follow_walk(episode, options.walk, [&](const Observation& observation) {
    InspectedStep step{.position = observation.position, .features = {}, .q = {}, .legal = {}};
    step.features.resize(static_cast<std::size_t>(world.node_count()) * kPaperFeatureCount);
    policy.encoder_for(observation.view()).encode(observation.position, observation.visits, std::span(step.features));
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
    for (std::size_t row = 0; row < step.features.size(); row += kPaperFeatureCount) {
      features.push_back(std::vector(&step.features[row], &step.features[row] + kPaperFeatureCount));
    }
    json.push_back({{"position", step.position}, {"features", features}, {"q", step.q}, {"legal", step.legal}});
  }
  return json;
}

// What an explorer sees and thinks at one node of the walk.
struct ExplorerStep {
  NodeId position;
  std::vector<FirstVisit> visits;
  ExplorerBatch seen;            // this state alone
  std::vector<float> shortfall;  // [C]
  std::size_t choice = 0;        // the index of the first visit that it makes
};

std::vector<ExplorerStep> inspect_walk(ExplorerScorer& scorer, const World& world, const InspectOptions& options) {
  const double budget = Budget::parse(options.budget).cost_in(world);
  Episode episode(world, {.budget = budget, .action_space = action_space_of(world)});
  ExplorerScratch scratch;
  std::vector<ExplorerStep> steps;
  follow_walk(episode, options.walk, [&](const Observation& observation) {
    const NodeSet ground = observation.ground();
    steps.push_back({.position = observation.position, .visits = {}, .seen = {}, .shortfall = {}});
    ExplorerStep& step = steps.back();
    const auto visits = encode(Exploration(observation, ground), scratch, step.seen).visits;
    step.visits.assign(visits.begin(), visits.end());
    if (visits.empty()) return;
    scorer.shortfalls(step.seen, step.shortfall);
    step.choice = scorer.choose(*observation.task, step.seen, visits);
  });
  return steps;
}

Json to_json(const std::vector<ExplorerStep>& steps) {
  Json json = Json::array();
  for (const ExplorerStep& step : steps) {
    const auto named = [](const float* row, const auto& features) {
      Json values;
      for (std::size_t f = 0; f < features.size(); ++f) values[std::string(features[f].name)] = row[f];
      return values;
    };
    Json nodes = Json::array();
    for (std::size_t row = 0; row < step.seen.node_x.size(); row += kExplorerNodeFeatureCount) {
      nodes.push_back(named(&step.seen.node_x[row], kExplorerNodeFeatures));
    }
    Json visits = Json::array();
    for (std::size_t i = 0; i < step.visits.size(); ++i) {
      visits.push_back(
          {{"node", step.visits[i].node},
           {"cost", step.visits[i].cost},
           {"shortfall", step.shortfall[i]},
           {"features", named(&step.seen.visit_x[i * kExplorerVisitFeatureCount], kExplorerVisitFeatures)}});
    }
    json.push_back({{"position", step.position},
                    {"ceiling", step.seen.ceiling[0]},
                    {"choice", step.visits.empty() ? Json() : Json(step.visits[step.choice].node)},
                    {"first_visits", visits},
                    {"nodes", nodes}});
  }
  return json;
}

std::string format_steps(const std::vector<ExplorerStep>& steps) {
  std::string text;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const ExplorerStep& step = steps[i];
    text +=
        fmt::format("\nstep {}, at node {}: {}\n", i, step.position,
                    step.visits.empty() ? "nothing left in reach"
                                        : fmt::format("at most {:g} more, less the shortfall", step.seen.ceiling[0]));
    if (step.visits.empty()) continue;
    text += "  first visit  shortfall";
    for (const ExplorerFeature& feature : kExplorerVisitFeatures) text += fmt::format("  {}", feature.name);
    text += '\n';
    for (std::size_t v = 0; v < step.visits.size(); ++v) {
      text += fmt::format("  {:>10}{}  {:9.3f}", step.visits[v].node, v == step.choice ? "*" : " ", step.shortfall[v]);
      for (int f = 0; f < kExplorerVisitFeatureCount; ++f) {
        text += fmt::format("  {:>{}.3g}", step.seen.visit_x[v * kExplorerVisitFeatureCount + f],
                            kExplorerVisitFeatures[f].name.size());
      }
      text += '\n';
    }
  }
  return text;
}

std::string format_tensors(const std::vector<TensorSpec>& specs) {
  std::string text =
      fmt::format("{} parameters\n\n{:22}  {:12}  {:>9}\n", trainable_count(specs), "tensor", "shape", "values");
  for (const TensorSpec& spec : specs) {
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
    for (const std::string_view name : kPaperFeatureNames) text += fmt::format("  {}", name);
    text += '\n';
    for (std::size_t row = 0; row < step.features.size(); row += kPaperFeatureCount) {
      text += fmt::format("  {:4}", row / kPaperFeatureCount);
      for (int f = 0; f < kPaperFeatureCount; ++f) {
        text += fmt::format("  {:>{}g}", step.features[row + f], kPaperFeatureNames[f].size());
      }
      text += '\n';
    }
  }
  return text;
}

template <typename Steps>
void print(const std::vector<TensorSpec>& specs, const Steps& steps, const InspectOptions& options) {
  if (!options.json) {
    print_text(format_tensors(specs) + format_steps(steps));
    return;
  }
  Json json;
  json["parameters"] = trainable_count(specs);
  json["tensors"] = Json::array();
  for (const TensorSpec& spec : specs) json["tensors"].push_back({{"name", spec.name}, {"shape", spec.shape}});
  if (!options.walk.empty()) json["steps"] = to_json(steps);
  print_json(json);
}

void inspect(const InspectOptions& options) {
  TrainedPolicy trained = read_policy(options.policy);
  if (const auto* const explorer = std::get_if<SharedExplorer>(&trained)) {
    std::vector<ExplorerStep> steps;
    if (!options.walk.empty()) {
      const World world = load_one_world(options.map);
      ExplorerScorer scorer(*explorer);
      steps = inspect_walk(scorer, world, options);
    }
    print(ExplorerParameters::specs(), steps, options);
    return;
  }
  if (options.budget_given) {
    throw Error({.what = "the paper's network looks at no budget", .where = "--budget"});
  }
  PaperPolicy policy(std::get<PaperParameters>(std::move(trained)));
  print(PaperParameters::specs(), options.walk.empty() ? std::vector<InspectedStep>() : inspect_walk(policy, options),
        options);
}

}  // namespace

void add_inspect_command(CLI::App& app) {
  CLI::App* const command =
      app.add_subcommand("inspect", "Show what a policy file holds, and what it sees and thinks along a walk");
  const auto options = std::make_shared<InspectOptions>();
  command->add_option("policy", options->policy, "A policy file, or explorer, the one in the program")
      ->required()
      ->type_name("POLICY");
  CLI::Option* const map = command->add_option("--map", options->map, "The map to walk on")->type_name("M");
  command->add_option("--walk", options->walk, "Node ids, as 0,1,1,2; a repeated id is a blocked move")
      ->delimiter(',')
      ->check(not_empty())
      ->type_name("IDS")
      ->needs(map);
  map->needs(command->get_option("--walk"));
  CLI::Option* const budget = command
                                  ->add_option("--budget", options->budget,
                                               "What the walk may cost in all: an explorer looks at what is left of it")
                                  ->type_name("B")
                                  ->capture_default_str()
                                  ->needs(map);
  command->add_flag("--json", options->json, "Print one JSON document");
  add_threads_option(*command);
  command->callback([options, budget] {
    options->budget_given = budget->count() > 0;
    inspect(*options);
  });
}

}  // namespace graphdrl
