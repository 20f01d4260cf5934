#include "graphdrl/live/transcript.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "graphdrl/base/error.h"
#include "graphdrl/io/json.h"
#include "graphdrl/io/text.h"

namespace graphdrl {
namespace {

constexpr std::string_view kBegin = "{\"live\":";

AppendedFile new_file(const std::filesystem::path& path) {
  std::optional<AppendedFile> file = AppendedFile::create(path);
  if (!file) {
    throw Error({.what = "the transcript is there already",
                 .expected = "a new file, or --resume",
                 .where = escaped(path.string())});
  }
  return *std::move(file);
}

AppendedFile cut_file(const std::filesystem::path& path) {
  const std::string text = read_file(path);
  const std::size_t end = text.rfind('\n') + 1;
  if (!is_transcript(text) || end == 0) {
    throw Error({.what = "no transcript", .where = escaped(path.string())});
  }
  std::error_code error;
  if (end < text.size()) std::filesystem::resize_file(path, end, error);
  if (error) fail_file(path, "cannot cut off a line that is not whole", error.value());
  return AppendedFile(path);
}

}  // namespace

std::string transcript_head(const LiveOptions& options) {
  return fmt::format("{}{},\"options\":{}}}\n", kBegin, kLiveProtocol, live_options_json(options).dump());
}

std::string transcript_line(std::string_view message, std::string_view answer) {
  return fmt::format("{{\"message\":{},\"answer\":{}}}\n", message, answer);
}

Transcript::Transcript(const std::filesystem::path& file, const LiveOptions& options, bool sync)
    : file_(new_file(file)), sync_(sync) {
  file_.append(transcript_head(options));
  if (sync_) file_.sync();
}

Transcript::Transcript(const std::filesystem::path& file, bool sync) : file_(cut_file(file)), sync_(sync) {}

void Transcript::add(std::string_view message, std::string_view answer) {
  file_.append(transcript_line(message, answer));
  if (sync_) file_.sync();
}

bool is_transcript(std::string_view text) {
  return text.starts_with(kBegin);
}

std::string LiveRun::note() const {
  if (turns == 0 && !torn) return "";
  std::string text = fmt::format("went on after {} message{}", turns, turns == 1 ? "" : "s");
  if (torn) text += "; the last line was not whole, and is left out";
  if (other_turn > 0) {
    text +=
        fmt::format("; the policy would now choose otherwise from message {} on: what is written holds", other_turn);
  }
  return text;
}

namespace {

LiveRun replay(const std::filesystem::path& path, const LiveSession::Record& record) {
  const std::string source = escaped(path.string());
  const std::string text = read_file(path);
  if (!is_transcript(text)) throw Error({.what = "no transcript", .where = source});
  LiveRun run;
  std::string_view rest = text;
  for (int line = 1; !rest.empty(); ++line) {
    const std::size_t end = rest.find('\n');
    if (end == std::string_view::npos) {
      run.torn = true;
      break;
    }
    const std::string where = fmt::format("{}, line {}", source, line);
    parse_json(rest.substr(0, end), where);  // throws what there is to say
    const auto turn = nlohmann::ordered_json::parse(rest.substr(0, end));
    rest.remove_prefix(end + 1);
    const char* const expected = line == 1 ? "options" : "message";
    if (!turn.is_object() || !turn.contains(expected) || (line > 1 && !turn.contains("answer"))) {
      throw Error({.what = "no line of a transcript", .where = where});
    }
    try {
      if (line == 1) {
        if (turn.at("live") != kLiveProtocol) {
          throw Error({.what = "a transcript of another protocol",
                       .expected = fmt::format("{}", kLiveProtocol),
                       .got = shortened(turn.at("live"))});
        }
        run.session = std::make_unique<LiveSession>(parse_live_options(turn.at("options"), LiveOptions()), record);
        continue;
      }
      ++run.turns;
      const bool same = run.session->replay(turn.at("message").dump(), turn.at("answer").dump());
      if (!same && run.other_turn == 0) run.other_turn = run.turns;
    } catch (const Error& error) {
      throw Error({.what = error.what(), .where = where});
    }
  }
  if (run.session == nullptr) throw Error({.what = "no transcript", .where = source});
  return run;
}

}  // namespace

LiveRun begin_live(const LiveOptions& options, const TranscriptOptions& wanted) {
  const LiveExploration trial(options);  // throws now what it would throw later
  // The session writes to it; it is there once the session has been played up to its end.
  const auto transcript = std::make_shared<std::optional<Transcript>>();
  const LiveSession::Record record = [transcript](std::string_view message, std::string_view answer) {
    if (*transcript) (*transcript)->add(message, answer);
  };
  LiveRun run;
  // A kill before the first line was whole leaves nothing to go on with.
  const std::string there = wanted.resume ? read_file(wanted.file) : "";
  const bool begun =
      there.find('\n') != std::string::npos || !std::string_view(kBegin).starts_with(there.substr(0, kBegin.size()));
  if (wanted.resume && !begun) std::filesystem::remove(wanted.file);
  if (wanted.resume && begun) {
    run = replay(wanted.file, record);
    transcript->emplace(wanted.file, wanted.sync);
    return run;
  }
  run.session = std::make_unique<LiveSession>(options, record);
  if (!wanted.file.empty()) transcript->emplace(wanted.file, options, wanted.sync);
  return run;
}

LiveRun replay_transcript(const std::filesystem::path& file) {
  return replay(file, {});
}

}  // namespace graphdrl
