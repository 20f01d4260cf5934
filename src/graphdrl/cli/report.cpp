#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <chrono>
#include <exception>
#include <filesystem>
#include <memory>
#include <set>

#include "graphdrl/base/error.h"
#include "graphdrl/cli/commands.h"
#include "graphdrl/cli/program.h"
#include "graphdrl/env/load_worlds.h"
#include "graphdrl/http/http_server.h"
#include "graphdrl/io/file.h"
#include "graphdrl/io/file_check.h"
#include "graphdrl/io/json.h"
#include "graphdrl/live/transcript.h"
#include "graphdrl/report/report_page.h"

namespace graphdrl {
namespace {

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
    } else if (is_transcript(read_file(input))) {
      const LiveRun run = replay_transcript(input);
      if (run.session->exploration() == nullptr) {
        throw Error({.what = "nothing was observed in the transcript", .where = input});
      }
      page.add_plan(run.session->exploration()->answer(name_of(input)));
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

// What changes when a file does: all zero where there is none. Nanoseconds, since 1970.
struct FileState {
  std::uint64_t kind = 0, file = 0;
  std::int64_t size = 0, written_ns = 0, changed_ns = 0;
  bool operator==(const FileState&) const = default;
};

FileState state_of(const std::string& path) {
  struct stat found = {};
  if (stat(path.c_str(), &found) != 0) return {};
  const auto ns = [](const timespec& time) { return std::int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec; };
  if (S_ISDIR(found.st_mode)) return {.kind = S_IFDIR};
  return {found.st_mode & S_IFMT, found.st_ino, found.st_size, ns(found.st_mtim), ns(found.st_ctim)};
}

// The page of the inputs as they are: made anew when they have changed, at most once a second. For one thread.
class WatchedPage {
 public:
  using Text = std::shared_ptr<const std::string>;

  WatchedPage(const ReportOptions& options, const std::optional<World>& world)
      : options_(options), world_(world), page_(options.title, /*watch=*/true) {}

  // Both throw Error where an input cannot be read.
  Text html() {
    return text(html_, [](const ReportPage& page) { return page.html(); });
  }
  Text data() {
    return text(data_, [](const ReportPage& page) { return page.data(); });
  }

 private:
  static constexpr std::chrono::seconds kBetweenLooks{1};
  // A file changed again this soon may still look the same: file systems count in steps, up to two seconds long.
  static constexpr std::chrono::seconds kSettled{2};

  template <typename Made>
  Text text(Text& kept, const Made& made) {
    look();
    if (failure_) std::rethrow_exception(failure_);
    if (!kept) kept = std::make_shared<const std::string>(made(page_));
    return kept;
  }

  void look() {
    if (std::chrono::steady_clock::now() < next_look_) return;
    const std::int64_t now_ns = std::chrono::nanoseconds(std::chrono::system_clock::now().time_since_epoch()).count();
    std::vector<FileState> states;
    for (const std::string& input : options_.inputs) {
      states.push_back(state_of(input));
      if (states.back().kind == S_IFDIR) states.push_back(state_of(input + "/metrics.jsonl"));
    }
    if (!options_.scores.empty()) states.push_back(state_of(options_.scores));
    if (!settled_ || states != states_) make();
    states_ = std::move(states);
    settled_ = std::all_of(states_.begin(), states_.end(), [&](const FileState& state) {
      return state.changed_ns < now_ns - std::chrono::nanoseconds(kSettled).count();
    });
    next_look_ = std::chrono::steady_clock::now() + kBetweenLooks;
  }

  void make() {
    html_.reset();
    data_.reset();
    failure_ = nullptr;
    try {
      page_ = make_page(options_, world_, page_.emptied());
    } catch (const Error&) {
      failure_ = std::current_exception();
    }
  }

  const ReportOptions& options_;
  const std::optional<World>& world_;
  ReportPage page_;
  std::exception_ptr failure_;
  Text html_, data_;               // of page_, once asked for
  std::vector<FileState> states_;  // that page_ was made of
  bool settled_ = false;
  std::chrono::steady_clock::time_point next_look_;
};

// Serves the page to this machine alone, until a signal ends the program.
void serve(const ReportOptions& options, const std::optional<World>& world) {
  WatchedPage page(options, world);
  page.data();  // so that errors show before a page is opened
  HttpServer server(options.port);
  server.on("GET", "/",
            [&](const HttpRequest&) { return HttpAnswer{.type = "text/html; charset=utf-8", .body = page.html()}; });
  server.on("GET", "/data.json",
            [&](const HttpRequest&) { return HttpAnswer{.type = "application/json", .body = page.data()}; });
  print_text(fmt::format("watching: http://127.0.0.1:{}/  (Ctrl-C ends it)\n", server.port()));
  server.run();
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
      .add_option(
          "inputs", options->inputs,
          "Plans that `plan --out` wrote (JSON or CSV), transcripts of `explore --live`, folders of `train`, and "
          "what `evaluate --json` printed")
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
