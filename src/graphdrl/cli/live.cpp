#include "graphdrl/cli/live.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <functional>
#include <string_view>

#include "graphdrl/base/error.h"
#include "graphdrl/cli/program.h"
#include "graphdrl/live/transcript.h"
#include "graphdrl/report/live_files.h"

namespace graphdrl {
namespace {

// The lines of standard input. A line longer than kLongestLiveMessage is skipped: its text is then cut and `cut` true.
class InputLines {
 public:
  bool next() {
    line_.clear();
    cut_ = false;
    bool any = false;
    while (true) {
      if (at_ == filled_) {
        // What is there, without waiting for more as fread() does.
        const ssize_t got = ::read(STDIN_FILENO, buffer_.data(), buffer_.size());
        if (got < 0 && errno == EINTR) continue;
        at_ = 0;
        filled_ = got > 0 ? static_cast<std::size_t>(got) : 0;
        if (filled_ == 0) return any;
      }
      any = true;
      const std::string_view rest(buffer_.data() + at_, filled_ - at_);
      const std::size_t end = rest.find('\n');
      const std::string_view more = rest.substr(0, end);
      if (line_.size() + more.size() > kLongestLiveMessage) {
        cut_ = true;
      } else if (!cut_) {
        line_ += more;
      }
      at_ += end == std::string_view::npos ? rest.size() : end + 1;
      if (end != std::string_view::npos) return true;
    }
  }
  const std::string& line() const { return line_; }
  bool cut() const { return cut_; }

 private:
  std::vector<char> buffer_ = std::vector<char>(1 << 16);
  std::size_t at_ = 0;
  std::size_t filled_ = 0;
  std::string line_;
  bool cut_ = false;
};

LiveOptions options_of(const LiveRequest& request) {
  LiveOptions options{.cover = parse_cover(request.cover.cover), .reset_cost = request.cover.reset_cost};
  if (!request.budget.empty()) {
    const std::optional<double> budget = Budget::parse(request.budget).cost();
    if (!budget) {
      throw Error({.what = "how many states there are is not known",
                   .expected = "a budget in units of cost",
                   .got = in_quotes(request.budget),
                   .where = "--budget"});
    }
    options.budget = *budget;
  }
  if (!request.end.empty() && request.end != "anywhere" && request.end != "start") {
    throw Error({.what = "bad end", .expected = "anywhere or start", .got = in_quotes(request.end), .where = "--end"});
  }
  options.end_at_start = request.end == "start";
  if (!request.score.empty()) options.score = parse_score(request.score);
  options.connectivity = request.connectivity;
  options.policy = request.policy;
  if (request.think_s) options.think_s = *request.think_s;
  options.seed = request.seed;
  return options;
}

}  // namespace

void add_live_options(CLI::App& command, LiveArguments& live) {
  CLI::Option* const flag = command.add_flag(
      "--live", live.live,
      "No map: a client says on standard input where it is, and which moves it has there or which cells it sees, a "
      "JSON "
      "object a line, and is told on standard output what to do next (docs/live.md). The default policy of moves is "
      "novelty; cells seen count, and steps lead to eight others, unless --score and --connectivity say otherwise");
  const auto only_live = [&](CLI::Option* option) { option->needs(flag)->group(kWithLive); };
  CLI::Option* const transcript =
      add_text_option(command, "--transcript", live.transcript, "FILE", "Write down each message with its answer");
  only_live(transcript);
  only_live(command.add_flag("--sync", live.sync, "Have each line of it on the disk before the answer is given")
                ->needs(transcript));
  only_live(command.add_flag("--resume", live.resume, "Go on where a transcript ends")->needs(transcript));
}

void explore_live(const LiveArguments& arguments, const LiveRequest& request) {
  const LiveOptions options = options_of(request);
  for (const std::string& file : request.out) check_live_file(file);
  const LiveRun run =
      begin_live(options, {.file = arguments.transcript, .sync = arguments.sync, .resume = arguments.resume});
  if (const std::string note = run.note(); !note.empty()) {
    print_diagnostic(fmt::format("{}: {}\n", escaped(arguments.transcript), note));
  }
  LiveSession* const session = run.session.get();
  InputLines lines;
  while (lines.next()) {
    if (lines.cut()) {
      print_text(fmt::format("{{\"error\":\"a line of more than {} MiB\"}}\n", kLongestLiveMessage >> 20));
    } else if (lines.line().find_first_not_of(" \t\r") != std::string::npos) {
      print_text(session->answer(lines.line()) + '\n');
    }
  }
  if (const auto last = session->close()) print_text(*last + '\n');
  if (session->exploration() == nullptr) return;
  std::vector<std::function<void()>> outputs;
  for (const std::string& file : request.out) {
    outputs.emplace_back([&] { write_live(*session->exploration(), file); });
  }
  attempt_all(outputs);
}

}  // namespace graphdrl
