#include <fmt/format.h>
#include <httplib.h>

#include <filesystem>
#include <memory>
#include <set>

#include "graphdrl/base/error.h"
#include "graphdrl/cli/commands.h"
#include "graphdrl/cli/program.h"
#include "graphdrl/env/load_worlds.h"
#include "graphdrl/io/file.h"
#include "graphdrl/io/file_check.h"
#include "graphdrl/io/json.h"
#include "graphdrl/report/report_page.h"

namespace graphdrl {
namespace {

constexpr int kMostPort = 65535;

struct ReportOptions {
  std::vector<std::string> inputs;
  std::string map;
  MapOptions reading;
  std::string scores;
  std::string title = "GraphDRL report";
  std::string out;
  bool watch = false;
  int port = 8000;
};

// Evaluations and plans are told apart by their content.
std::optional<nlohmann::json> read_evaluation(const std::string& file) {
  const std::string text = read_file(file);
  if (!text.starts_with('{')) return std::nullopt;
  nlohmann::json document = parse_json(text, file);
  if (!document.contains("rows")) return std::nullopt;
  return document;
}

// page: one with nothing on it yet.
ReportPage make_page(const ReportOptions& options, const std::optional<World>& world, ReportPage page) {
  std::set<std::string> taken;
  // What the page calls a run or an evaluation: the last part of the path, or the whole path if that name is taken.
  const auto name_of = [&](const std::filesystem::path& path) {
    const std::filesystem::path last = path.has_filename() ? path.filename() : path.parent_path().filename();
    return taken.insert(last.stem().string()).second ? last.stem().string() : path.string();
  };
  for (const std::string& input : options.inputs) {
    if (std::filesystem::is_directory(input)) {
      page.add_run(name_of(input), input);
    } else if (const auto evaluation = read_evaluation(input)) {
      page.add_evaluation(name_of(input), *evaluation);
    } else if (world) {
      const Answer plan = read_plan(*world, input);
      check_walk(plan, input);
      page.add_plan(plan, options.scores.empty() ? std::nullopt : std::optional(scores_along(plan, options.scores)));
    } else {
      throw Error({.what = "a plan needs its map", .expected = "--map MAP", .where = input});
    }
  }
  return page;
}

// Serves the page to this machine alone, until a signal ends the program.
void serve(const ReportOptions& options, const std::optional<World>& world) {
  httplib::Server server;
  // The library's own socket options would let two programs share a port.
  server.set_socket_options([](socket_t socket) {
    const int yes = 1;
    setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes));
  });
  // Reads the input now, so that errors show before a page is opened, and the map is laid out once.
  const ReportPage blank = make_page(options, world, ReportPage(options.title, /*watch=*/true)).emptied();
  const auto answer = [&](auto content_of, const char* type) {
    return [&options, &world, &blank, content_of, type](const httplib::Request& request, httplib::Response& response) {
      // A page of another site whose name resolves to this machine must not read this one.
      const std::string host = request.get_header_value("Host");
      if (!host.starts_with("127.0.0.1:") && !host.starts_with("localhost:")) {
        response.status = 403;
        return;
      }
      response.set_header("Cache-Control", "no-store");
      try {
        response.set_content(content_of(make_page(options, world, blank)), type);
      } catch (const Error& error) {
        response.status = 500;
        response.set_content(error.what(), "text/plain");
      }
    };
  };
  server.Get("/", answer([](const ReportPage& page) { return page.html(); }, "text/html; charset=utf-8"));
  server.Get("/data.json", answer([](const ReportPage& page) { return page.data(); }, "application/json"));
  const int port = options.port == 0                                ? server.bind_to_any_port("127.0.0.1")
                   : server.bind_to_port("127.0.0.1", options.port) ? options.port
                                                                    : -1;
  if (port < 0) {
    throw Error({.what = "the port cannot be used", .got = std::to_string(options.port), .where = "--port"});
  }
  print_text(fmt::format("watching: http://127.0.0.1:{}/  (Ctrl-C ends it)\n", port));
  server.listen_after_bind();
}

void report(const ReportOptions& options) {
  if (options.watch != options.out.empty()) {
    throw Error({.what = options.watch ? "--watch writes no file" : "nowhere to put the page",
                 .expected = "either --out FILE or --watch"});
  }
  if (options.port < 0 || options.port > kMostPort) {
    throw Error({.what = "bad port",
                 .expected = fmt::format("0 to {}", kMostPort),
                 .got = std::to_string(options.port),
                 .where = "--port"});
  }
  if (!options.scores.empty() && options.map.empty()) {
    throw Error({.what = "scores are of the moves of plans", .expected = "--map MAP", .where = "--scores"});
  }
  if (!options.out.empty()) check_writable(options.out);
  std::optional<World> world;
  if (!options.map.empty()) world = load_one_world(options.map, options.reading);
  if (options.watch) {
    serve(options, world);
  } else {
    write_file(options.out, make_page(options, world, ReportPage(options.title)).html());
  }
}

}  // namespace

void add_report_command(CLI::App& app) {
  CLI::App& command = *app.add_subcommand(
      "report", "Make a page of plans, trainings and evaluations: replays, curves, tables, in one HTML file");
  const auto options = std::make_shared<ReportOptions>();
  command
      .add_option("inputs", options->inputs,
                  "Plans that `plan --out` wrote (JSON or CSV), folders of `train`, and what `evaluate --json` printed")
      ->required()
      ->type_name("INPUTS");
  add_text_option(command, "-o,--out", options->out, "FILE", "The page to write");
  add_text_option(command, "--map", options->map, "MAP", "The map of the plans: paper:a to paper:j, or a file");
  add_text_option(command, "--scores", options->scores, "POLICY",
                  "Show what this policy thinks of the possible moves at every step of the plans: explorer, or a "
                  "policy file");
  add_text_option(command, "--title", options->title, "TEXT", "The title of the page")->capture_default_str();
  command.add_flag("--watch", options->watch,
                   "Instead of writing a file, serve the page on 127.0.0.1 and keep it up to date");
  command.add_option("--port", options->port, "Where to serve it; 0 takes any free port")
      ->type_name("N")
      ->capture_default_str();
  add_map_options(command, options->reading);
  add_threads_option(command);
  command.callback([options] { report(*options); });
}

}  // namespace graphdrl
