#include <fmt/format.h>

#include <memory>

#include "graphdrl/answer/answer.h"
#include "graphdrl/base/error.h"
#include "graphdrl/cli/commands.h"
#include "graphdrl/cli/machine.h"
#include "graphdrl/cli/program.h"
#include "graphdrl/env/load_worlds.h"
#include "graphdrl/eval/comparison.h"
#include "graphdrl/live/edge_exploration.h"
#include "graphdrl/planners/registry.h"

namespace graphdrl {
namespace {

const std::vector<std::string> kLadder = {"random", "dfs", "nearest", "explorer", "guided", "search", "exact"};
const std::vector<std::string> kOnlineLadder = {"random-walk", "dfs", "nearest", "pocket", "open", "explorer"};
const std::vector<std::string> kEdgeLadder = {"search"};
const std::vector<std::string> kOnlineEdgeLadder = {"random-walk", "dfs", "nearest", "novelty"};
const std::vector<std::string> kUntilCoveredLadder(kOnlineLadder.begin() + 1, kOnlineLadder.end());  // all end

struct EvaluateOptions {
  std::vector<std::string> maps = {"paper"};
  MapOptions reading;
  std::string budget;
  ComparisonOptions comparison = {.policies = kLadder};
  std::string reveal = "all";
  std::string score = "visited";
  std::string until;
  std::vector<std::string> believed;
  CoverText cover;
  std::string out;
  ShareText share;
  bool json = false;
};

// {mean, ci95} or null.
Json mean_json(const std::optional<Summary>& summary) {
  if (!summary) return {};
  return {{"mean", summary->mean}, {"ci95", summary->ci95 ? Json({summary->ci95->low, summary->ci95->high}) : Json()}};
}

Json to_json(const Comparison& comparison) {
  const bool hidden = !comparison.options.reveal.all();
  Json rows = Json::array();
  for (const ComparisonRow& row : comparison.rows) {
    Json json;
    json["map"] = row.map;
    json["policy"] = row.policy;
    json["valid_nodes"] = row.valid_nodes;
    json["budget"] = comparison.options.until_covered ? Json() : Json(row.budget);
    json["episodes"] = row.episodes;
    const auto coverage = row.coverage;
    json["mean"] = coverage ? Json(coverage->mean) : Json();
    json["std"] = coverage ? or_null(coverage->std) : Json();
    json["best"] = coverage && !comparison.options.until_covered ? Json(coverage->best) : Json();
    json["ci95"] = coverage && coverage->ci95 ? Json({coverage->ci95->low, coverage->ci95->high}) : Json();
    json["optimum"] = or_null(row.optimum);
    json["paper"] = Json();
    if (row.paper) json["paper"] = {{"mean", row.paper->mean}, {"std", row.paper->std}, {"best", row.paper->best}};
    if (hidden) {
      json["known"] = mean_json(row.known);
      json["price_of_ignorance"] = mean_json(row.price);
    }
    rows.push_back(std::move(json));
  }
  Json overall = Json::array();
  for (const ComparisonOverall& line : comparison.overall) {
    overall.push_back({{"policy", line.policy},
                       {"maps", line.maps},
                       {"mean", or_null(line.mean)},
                       {"ratio_to_optimum", or_null(line.ratio_to_optimum)}});
  }
  Json document = {{"rows", rows}, {"overall", overall}};
  if (!hidden) return document;
  Json& families = document["families"] = Json::array();
  for (const FamilyRow& row : comparison.families) {
    families.push_back({{"family", row.family},
                        {"policy", row.policy},
                        {"maps", row.maps},
                        {comparison.options.until_covered ? "cost" : "coverage", mean_json(row.coverage)},
                        {"known", mean_json(row.known)},
                        {"price_of_ignorance", mean_json(row.price)}});
  }
  return document;
}

// What the results come from: the options, and the files of maps and policies.
Json origin_of(const EvaluateOptions& options, const std::vector<std::string>& policies, const CLI::App& command) {
  std::vector<std::string> maps = options.maps;
  maps.insert(maps.end(), options.believed.begin(), options.believed.end());
  return {{"options", given_options(command, {"--out", "--task", "--merge", "--threads", "--memory-limit", "--json"})},
          {"files", checksums_of(maps, policies)}};
}

// What is asked for, but for what comes with the maps.
ComparisonOptions comparison_of(const EvaluateOptions& options) {
  ComparisonOptions comparison = options.comparison;
  if (!options.budget.empty()) comparison.budget = Budget::parse(options.budget);
  comparison.reveal = Reveal::parse(options.reveal);
  comparison.score = parse_score(options.score);
  comparison.until_covered = !options.until.empty();
  const bool edges = parse_cover(options.cover.cover) == Cover::kEdges;
  if (comparison.policies == kLadder && edges) {
    comparison.policies = comparison.reveal.all() ? kEdgeLadder : kOnlineEdgeLadder;
    if (comparison.until_covered) std::erase(comparison.policies, "random-walk");  // which may never end
  } else if (comparison.policies == kLadder && !comparison.reveal.all()) {
    comparison.policies = comparison.until_covered ? kUntilCoveredLadder : kOnlineLadder;
  }
  if (edges) {
    if (!options.believed.empty()) throw Error({.what = "old maps go with nodes", .got = "--cover edges"});
    compare_edges(comparison, options.cover.reset_cost);
  } else if (options.cover.reset_cost) {
    throw Error({.what = "resets go with --cover edges"});
  }
  if (!options.believed.empty() && comparison.policies == kOnlineLadder) {
    comparison.policies.emplace_back(kBelievingPolicy);
  }
  return comparison;
}

// The worlds, with the families and old maps that a comparison has of them.
std::vector<World> load_arenas(const EvaluateOptions& options, ComparisonOptions& comparison) {
  std::vector<World> worlds;
  for (const std::string& maps : options.maps) {
    const std::vector<World> more = load_worlds({maps}, options.reading);
    worlds.insert(worlds.end(), more.begin(), more.end());
    if (!comparison.reveal.all()) comparison.families.resize(worlds.size(), maps);
  }
  if (options.believed.empty()) return worlds;
  const std::vector<World> old = load_worlds(options.believed, options.reading);
  if (old.size() != worlds.size()) {
    throw Error({.what = "bad number of believed maps",
                 .expected = std::to_string(worlds.size()),
                 .got = std::to_string(old.size())});
  }
  for (std::size_t i = 0; i < old.size(); ++i) comparison.believed.push_back(believe(old[i], worlds[i]));
  return worlds;
}

void evaluate(const EvaluateOptions& options, const CLI::App& command, Ranks& ranks) {
  const TaskWorkers workers{.ranks = ranks, .share = options.share.share()};
  if (options.out.empty() && !workers.share.all()) {
    throw Error({.what = "shares meet in a folder", .expected = "--out FOLDER with --task and --merge"});
  }
  ComparisonOptions comparison = comparison_of(options);
  const std::vector<World> worlds = load_arenas(options, comparison);
  std::optional<TaskFolder> folder;
  if (!options.out.empty() || !ranks.alone()) {
    const Json origin = origin_of(options, comparison.policies, command);
    ranks.require_same("files", origin.dump(-1, ' ', false, Json::error_handler_t::replace));
    if (!options.out.empty()) {
      claim_folder(std::filesystem::path(options.out) / "evaluation.json", origin, ranks);
      folder.emplace(std::filesystem::path(options.out) / "results");
    }
  }
  const auto result = compare(worlds, comparison, workers, folder ? &*folder : nullptr);
  if (!options.share.task.empty()) return print_share_done(workers.share);
  if (!result) {
    throw Error({.what = "results are lacking", .expected = "all shares of them done by --task", .where = options.out});
  }
  if (options.json) {
    print_json(to_json(*result));
  } else {
    print_text(format_comparison(*result));
  }
  if (folder) require_none_left_out(*folder);
}

// Those of maps that are not known, and what counts.
void add_unknown_options(CLI::App& command, EvaluateOptions& options) {
  CLI::Option* const reveal = add_text_option(command, "--reveal", options.reveal, "R",
                                              "What is known of a map: all of it, or what visits show, edges, radius:R "
                                              "or sight:R, as of explore; then a table by "
                                              "what --maps names");
  reveal->capture_default_str();
  command.add_option("--score", options.score, "What counts of unknown maps: nodes visited, or nodes seen")
      ->check(CLI::IsMember({"visited", "seen"}))
      ->needs(reveal)
      ->capture_default_str();
  add_cover_options(command, options.cover);
  command
      .add_option("--believed", options.believed,
                  "Old maps for the policies that plan: as of --maps, as many and in the same order")
      ->needs(reveal)
      ->type_name("OLD");
  command
      .add_option("--until", options.until,
                  "Instead of a budget: covered, until nothing is left that is known; costs are compared then")
      ->check(CLI::IsMember({"covered"}))
      ->excludes(command.get_option("--budget"));
  command
      .add_option(
          "--price", options.comparison.price_s,
          "The price of ignorance where the optimum is not computed, of maps of more than 25 nodes and of costs: "
          "seconds that search has for each walk that knows the map")
      ->check(CLI::PositiveNumber)
      ->needs(reveal)
      ->type_name("S");
}

}  // namespace

void add_evaluate_command(CLI::App& app, Ranks& ranks) {
  CLI::App& command = *app.add_subcommand("evaluate", "Compare policies on maps: the paper's Table 2 and the optimum");
  const auto options = std::make_shared<EvaluateOptions>();
  command.add_option("--policy", options->comparison.policies, policy_names() + "; may be given again")
      ->type_name("P")
      ->capture_default_str();
  command.add_option("--maps", options->maps, "paper, paper:a to paper:j, a file, or a folder; may be given again")
      ->type_name("M")
      ->capture_default_str();
  add_text_option(
      command, "--budget", options->budget, "B",
      "What an episode may cost, or a multiple of the valid nodes, as 1.1x. The default is the file's, else "
      "25");
  CLI::Option* const start =
      add_text_option(command, "--start", options->comparison.start, "S",
                      "Where all episodes begin, as of plan. The default is the file's, else random ones");
  add_text_option(command, "--end", options->comparison.end, "E",
                  "Where walks must end: anywhere, start, or a node. The default is the file's, else anywhere");
  CLI::Option* const episodes = command.add_option("--episodes", options->comparison.episodes, "Episodes per map")
                                    ->type_name("K")
                                    ->capture_default_str();
  command.add_flag("--all-starts", options->comparison.all_starts, "Instead: one episode from every valid node")
      ->excludes(episodes)
      ->excludes(start);
  add_unknown_options(command, *options);
  add_seed_option(command, options->comparison.seed, "For the starts and for random policies");
  add_text_option(command, "--out", options->out, "FOLDER",
                  "Keep each result in this folder: the same command again computes what is missing");
  add_share_options(command, options->share);
  command.add_flag("--json", options->json, "Print one JSON document");
  add_map_options(command, options->reading);
  add_threads_option(command);
  add_memory_limit_option(command);
  command.callback([options, &command, &ranks] { evaluate(*options, command, ranks); });
}

}  // namespace graphdrl
