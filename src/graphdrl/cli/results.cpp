#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "graphdrl/base/error.h"
#include "graphdrl/cli/commands.h"
#include "graphdrl/cli/program.h"
#include "graphdrl/env/load_worlds.h"
#include "graphdrl/eval/seed_distribution.h"
#include "graphdrl/io/file.h"
#include "graphdrl/io/file_check.h"
#include "graphdrl/report/curve_figure.h"
#include "graphdrl/train/finished_runs.h"

namespace graphdrl {
namespace {

constexpr std::size_t kWindow = 10;  // points that a curve averages: of ten episodes each, for the paper
constexpr std::string_view kBegin = "<!-- table -->\n";
constexpr std::string_view kEnd = "<!-- end of table -->";

struct ResultsOptions {
  std::vector<std::string> runs;
  std::vector<std::string> maps = {"paper"};
  std::string figure;
  std::string into;
  bool json = false;
};

struct PanelOfMetric {
  const char* name;
  const char* title;
  bool smooth = true;
  std::optional<double> low = {};
  std::optional<double> high = {};
};

// The panels of the paper's Figure 2; those of an explorer's training.
std::vector<PanelOfMetric> panels_of(const TrainOptions& options) {
  if (options.preset == kExplorerPreset) {
    return {{.name = "loss", .title = "loss"}, {.name = "regret", .title = "regret: nodes lost by a choice", .low = 0}};
  }
  return {{.name = "epsilon", .title = "exploration rate ε", .smooth = false, .low = 0, .high = 1},
          {.name = "loss", .title = "loss", .low = 0},
          {.name = "visited_nodes", .title = "nodes visited in an episode", .low = 0},
          {.name = "reward", .title = "reward of an episode"}};
}

void write_figure(const std::filesystem::path& path, const std::vector<FinishedRun>& runs) {
  const TrainOptions& options = runs.front().options;
  std::vector<CurvePanel> panels;
  for (const PanelOfMetric& metric : panels_of(options)) {
    CurvePanel panel{.title = metric.title, .curves = {}, .low = metric.low, .high = metric.high};
    for (const FinishedRun& run : runs) {
      std::vector<Point> curve = curve_of(run, metric.name);
      panel.curves.push_back(metric.smooth ? smoothed(std::move(curve), kWindow) : curve);
    }
    panels.push_back(std::move(panel));
  }
  const std::string note =
      runs.size() > 1
          ? fmt::format("The mean of {} seeds, and the range between the lowest and the highest; means of ten points",
                        runs.size())
          : fmt::format("Seed {}", options.seed);
  const Point size = curve_figure_size(panels.size());
  const auto canvas = path.extension() == ".png" ? make_png_canvas(size.x, size.y)
                                                 : make_svg_canvas(size.x, size.y, "Curves of " + options.preset, note);
  draw_curves(*canvas, panels, options.preset == kPaperPreset ? "episode" : "round", note);
  write_file(path, canvas->finish());
}

// The text of a file with a table between its marks. Throws Error if the marks are missing.
std::string with_table(const std::filesystem::path& path, const std::string& table) {
  const std::string text = read_file(path);
  const std::size_t begin = text.find(kBegin);
  const std::size_t end = text.find(kEnd, begin);
  if (begin == std::string::npos || end == std::string::npos) {
    throw Error({.what = "no place for a table",
                 .expected = "a line <!-- table --> and a line <!-- end of table -->",
                 .where = path.string()});
  }
  return text.substr(0, begin) + std::string(kBegin) + table + text.substr(end);
}

void check_outputs(const ResultsOptions& options) {
  if (!options.figure.empty()) check_writable(options.figure);
  if (options.into.empty()) return;
  check_writable(options.into);
  with_table(options.into, {});
}

Json to_json(const SeedDistribution& distribution, const std::vector<FinishedRun>& runs) {
  Json seeds = Json::array();
  for (const FinishedRun& run : runs) seeds.push_back(run.options.seed);
  Json rows = Json::array();
  for (const SeedRow& row : distribution.rows) {
    rows.push_back({{"map", row.name},
                    {"mean", row.over_seeds.mean},
                    {"std", or_null(row.over_seeds.std)},
                    {"min", row.lowest},
                    {"lower_quartile", row.lower_quartile},
                    {"median", row.median},
                    {"upper_quartile", row.upper_quartile},
                    {"max", row.over_seeds.best},
                    {"by_seed", row.means},
                    {"paper", or_null(row.paper)},
                    {"paper_z", or_null(row.paper_z)},
                    {"random_walk", row.random_walk},
                    {"dfs", row.depth_first},
                    {"nearest", row.nearest},
                    {"optimum", or_null(row.optimum)}});
  }
  return {{"seeds", seeds}, {"budget", distribution.budget}, {"rows", rows}};
}

void results(const ResultsOptions& options) {
  const std::string ending = std::filesystem::path(options.figure).extension();
  if (!options.figure.empty() && ending != ".svg" && ending != ".png") {
    throw Error(
        {.what = "bad name of a figure", .expected = "FILE.svg or FILE.png", .got = in_quotes(options.figure, 200)});
  }
  check_outputs(options);
  const std::vector<FinishedRun> runs = read_finished_runs(options.runs);
  const TrainOptions& trained = runs.front().options;
  if (trained.preset != kPaperPreset) {
    if (options.figure.empty() || options.json || !options.into.empty()) {
      throw Error({.what = "Table 2 is of the preset paper", .expected = "--figure FILE alone for an explorer's runs"});
    }
    return write_figure(options.figure, runs);
  }
  std::vector<std::string> policies;
  policies.reserve(runs.size());
  for (const FinishedRun& run : runs) policies.push_back(run.directory.policy().string());
  const SeedDistribution distribution =
      distribution_over_seeds(policies, load_worlds(options.maps), runs.front().maps, Budget::parse(trained.budget));
  attempt_all({[&] {
                 if (!options.figure.empty()) write_figure(options.figure, runs);
               },
               [&] {
                 if (options.into.empty()) return;
                 write_file(options.into, with_table(options.into, markdown_distribution(distribution)));
               },
               [&] {
                 if (options.json) return print_json(to_json(distribution, runs));
                 print_text(format_distribution(distribution));
               }});
}

}  // namespace

void add_results_command(CLI::App& app) {
  CLI::App& command = *app.add_subcommand(
      "results",
      "Compare trainings that differ in their seeds alone: the paper's Table 2 as a distribution, its curves");
  const auto options = std::make_shared<ResultsOptions>();
  command.add_option("runs", options->runs, "Run directories that are finished, and folders of many seeds")
      ->required()
      ->type_name("RUN");
  command.add_option("--maps", options->maps, "Maps to compare on")->type_name("MAP")->capture_default_str();
  add_text_option(command, "--figure", options->figure, "FILE",
                  "Draw the curves of Figure 2, with a band from the lowest to the highest seed: .svg, .png");
  add_text_option(
      command, "--into", options->into, "FILE.md",
      "Put the table, in Markdown, between the lines <!-- table --> and <!-- end of table --> of this file");
  command.add_flag("--json", options->json, "Print one JSON document");
  add_threads_option(command);
  command.callback([options] { results(*options); });
}

}  // namespace graphdrl
