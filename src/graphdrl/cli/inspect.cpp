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

// What the paper's network sees and thinks at every node of the walk: features [N, F], unscaled; Q-values, raw; which
// moves would not be blocked.
Json inspect_walk(PaperPolicy& policy, const InspectOptions& options) {
  const World world = load_one_world(options.map);
  Episode episode(world, {.budget = static_cast<double>(options.walk.size())});
  Json steps = Json::array();
  follow_walk(episode, options.walk, [&](const Observation& observation) {
    std::vector<float> x(static_cast<std::size_t>(world.node_count()) * kPaperFeatureCount);
    policy.encoder_for(observation.view()).encode(observation.position, observation.visits, std::span(x));
    Json features = Json::array();
    for (std::size_t row = 0; row < x.size(); row += kPaperFeatureCount) {
      features.push_back(std::vector(&x[row], &x[row] + kPaperFeatureCount));
    }
    std::array<float, kActionCount> q = {};
    policy.q_values({&observation, 1}, q);
    std::array<bool, kActionCount> legal = {};
    for (int action = 0; action < kActionCount; ++action) legal[action] = observation.legal(action);
    steps.push_back({{"position", observation.position}, {"features", features}, {"q", q}, {"legal", legal}});
  });
  return steps;
}

std::string format_paper_steps(const Json& steps) {
  std::string text;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const Json& step = steps[i];
    text += fmt::format("\nstep {}, at node {}\n  Q-values:", i, step["position"].get<NodeId>());
    const auto q = step["q"].get<std::array<float, kActionCount>>();
    for (int action = 0; action < kActionCount; ++action) {
      text += fmt::format("  {} {:.4f}{}{}", kDirectionNames[action], q[action], action == argmax(q) ? "*" : "",
                          step["legal"][action].get<bool>() ? "" : " (blocked)");
    }
    text += "\n  node";
    for (const std::string_view name : kPaperFeatureNames) text += fmt::format("  {}", name);
    text += '\n';
    for (std::size_t node = 0; node < step["features"].size(); ++node) {
      text += fmt::format("  {:4}", node);
      for (int f = 0; f < kPaperFeatureCount; ++f) {
        text += fmt::format("  {:>{}g}", step["features"][node][f].get<float>(), kPaperFeatureNames[f].size());
      }
      text += '\n';
    }
  }
  return text;
}

// A row of features by their names.
template <typename Features>
Json named(const float* row, const Features& features) {
  Json values;
  for (std::size_t f = 0; f < features.size(); ++f) values[std::string(features[f].name)] = row[f];
  return values;
}

// What an explorer sees and thinks at every node of the walk. `choice`: the first visit that it makes, or null.
Json inspect_walk(ExplorerScorer& scorer, const InspectOptions& options) {
  const World world = load_one_world(options.map);
  const double budget = Budget::parse(options.budget).cost_in(world);
  Episode episode(world, {.budget = budget, .action_space = action_space_of(world)});
  ExplorerScratch scratch;
  Json steps = Json::array();
  follow_walk(episode, options.walk, [&](const Observation& observation) {
    const NodeSet ground = observation.ground();
    ExplorerBatch seen;  // this state alone
    const auto visits = encode(Exploration(observation, ground), scratch, seen).visits;
    std::vector<float> shortfall;  // [C]
    Json choice;
    if (!visits.empty()) {
      scorer.shortfalls(seen, shortfall);
      choice = visits[scorer.choose(*observation.task, seen, visits)].node;
    }
    Json first_visits = Json::array();
    for (std::size_t i = 0; i < visits.size(); ++i) {
      first_visits.push_back(
          {{"node", visits[i].node},
           {"cost", visits[i].cost},
           {"shortfall", shortfall[i]},
           {"features", named(&seen.visit_x[i * kExplorerVisitFeatureCount], kExplorerVisitFeatures)}});
    }
    Json nodes = Json::array();
    for (std::size_t row = 0; row < seen.node_x.size(); row += kExplorerNodeFeatureCount) {
      nodes.push_back(named(&seen.node_x[row], kExplorerNodeFeatures));
    }
    steps.push_back({{"position", observation.position},
                     {"ceiling", seen.ceiling[0]},
                     {"choice", choice},
                     {"first_visits", first_visits},
                     {"nodes", nodes}});
  });
  return steps;
}

std::string format_explorer_steps(const Json& steps) {
  std::string text;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const Json& step = steps[i];
    const Json& visits = step["first_visits"];
    const float most = step["ceiling"].get<float>();
    text += fmt::format(
        "\nstep {}, at node {}: {}\n", i, step["position"].get<NodeId>(),
        visits.empty() ? "nothing left in reach" : fmt::format("at most {:g} more, less the shortfall", most));
    if (visits.empty()) continue;
    text += "  first visit  shortfall";
    for (const ExplorerFeature& feature : kExplorerVisitFeatures) text += fmt::format("  {}", feature.name);
    text += '\n';
    for (const Json& visit : visits) {
      text += fmt::format("  {:>10}{}  {:9.3f}", visit["node"].get<NodeId>(),
                          visit["node"] == step["choice"] ? "*" : " ", visit["shortfall"].get<float>());
      for (const auto& [name, value] : visit["features"].items()) {
        text += fmt::format("  {:>{}.3g}", value.get<float>(), name.size());
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

void inspect(const InspectOptions& options) {
  KnownMapPolicy trained = read_known_map_policy(options.policy);
  auto* const explorer = std::get_if<SharedExplorer>(&trained);
  if (explorer == nullptr && options.budget_given) {
    throw Error({.what = "the paper's network looks at no budget", .where = "--budget"});
  }
  const auto specs = explorer != nullptr ? ExplorerParameters::specs() : PaperParameters::specs();
  Json steps = Json::array();
  if (!options.walk.empty() && explorer != nullptr) {
    ExplorerScorer scorer(*explorer);
    steps = inspect_walk(scorer, options);
  } else if (!options.walk.empty()) {
    PaperPolicy policy(std::get<PaperParameters>(std::move(trained)));
    steps = inspect_walk(policy, options);
  }
  if (!options.json) {
    return print_text(format_tensors(specs) +
                      (explorer != nullptr ? format_explorer_steps(steps) : format_paper_steps(steps)));
  }
  Json json = {{"parameters", trainable_count(specs)}, {"tensors", Json::array()}};
  for (const TensorSpec& spec : specs) json["tensors"].push_back({{"name", spec.name}, {"shape", spec.shape}});
  if (!options.walk.empty()) json["steps"] = steps;
  print_json(json);
}

}  // namespace

void add_inspect_command(CLI::App& app) {
  CLI::App& command =
      *app.add_subcommand("inspect", "Show what a policy file holds, and what it sees and thinks along a walk");
  const auto options = std::make_shared<InspectOptions>();
  command.add_option("policy", options->policy, "A policy file, or explorer, the one in the program")
      ->required()
      ->type_name("POLICY");
  CLI::Option* const map = command.add_option("--map", options->map, "The map to walk on")->type_name("M");
  CLI::Option* const walk =
      add_text_option(command, "--walk", options->walk, "IDS", "Node ids, as 0,1,1,2; a repeated id is a blocked move")
          ->delimiter(',')
          ->needs(map);
  map->needs(walk);
  CLI::Option* const budget = command
                                  .add_option("--budget", options->budget,
                                              "What the walk may cost in all: an explorer looks at what is left of it")
                                  ->type_name("B")
                                  ->capture_default_str()
                                  ->needs(map);
  command.add_flag("--json", options->json, "Print one JSON document");
  add_threads_option(command);
  command.callback([options, budget] {
    options->budget_given = budget->count() > 0;
    inspect(*options);
  });
}

}  // namespace graphdrl
