#include <fmt/format.h>

#include <chrono>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "graphdrl/base/error.h"
#include "graphdrl/cli/commands.h"
#include "graphdrl/cli/program.h"
#include "graphdrl/io/file.h"
#include "graphdrl/live/exploration_service.h"
#include "graphdrl/live/graph_walker_service.h"

namespace graphdrl {
namespace {

constexpr double kLongestIdle = 1e7;

struct ServeOptions {
  int port = 8887;
  std::vector<std::string> model;  // a file, and the generator
  double idle_s = 3600;
  std::size_t explorations = ExplorationLimits{}.explorations;
};

void serve(const ServeOptions& options) {
  std::vector<WalkerModel> models;
  if (!options.model.empty()) {
    models = parse_walker_models(read_file(options.model[0]), escaped(options.model[0]), options.model[1]);
  }
  HttpServer server(options.port, {.body_bytes = kLongestLiveMessage});
  const ExplorationService service(
      server, LiveOptions(),
      {.explorations = options.explorations,
       .idle = std::chrono::milliseconds(static_cast<std::int64_t>(options.idle_s * 1000))});
  const GraphWalkerService graph_walker(server, std::move(models));
  print_text(fmt::format("serving: http://127.0.0.1:{}/explorations  (Ctrl-C ends it)\n", server.port()));
  server.run();
}

}  // namespace

void add_serve_command(CLI::App& app) {
  CLI::App& command = *app.add_subcommand(
      "serve", "Serve live explorations over HTTP on this machine, any number side by side (docs/live.md)");
  const auto options = std::make_shared<ServeOptions>();
  command.add_option("--port", options->port, "Where on 127.0.0.1; 0 takes any free port")
      ->check(CLI::Range(0, kMostPort))
      ->type_name("N")
      ->capture_default_str();
  command
      .add_option("--model", options->model,
                  "Models that GraphWalker's service at /graphwalker holds from the beginning, and their generator, as "
                  "'random(edge_coverage(100))'")
      ->expected(2)
      ->type_name("FILE GENERATOR");
  command.add_option("--idle", options->idle_s, "Seconds after which an exploration ends that nobody asks for")
      ->check(CLI::Range(0.001, kLongestIdle))
      ->type_name("S")
      ->capture_default_str();
  command.add_option("--most", options->explorations, "How many explorations there may be at once")
      ->check(CLI::Range(1, 1'000'000))
      ->type_name("N")
      ->capture_default_str();
  add_threads_option(command);
  command.callback([options] { serve(*options); });
}

}  // namespace graphdrl
