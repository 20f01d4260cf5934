// A live exploration on disk, step by step: what was told and what was answered.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "graphdrl/io/file.h"
#include "graphdrl/live/session.h"

namespace graphdrl {

// Lines of JSON: the options, then a message with its answer each.
std::string transcript_head(const LiveOptions& options);
std::string transcript_line(std::string_view message, std::string_view answer);

// These in a file.
class Transcript {
 public:
  // A new file. Throws Error, also where the file is there. sync: each line is on the disk before its answer is given,
  // so that a power cut takes none.
  Transcript(const std::filesystem::path& file, const LiveOptions& options, bool sync);
  // Goes on with a file. What stands behind its last whole line is cut off. Throws Error where it is no transcript.
  Transcript(const std::filesystem::path& file, bool sync);

  void add(std::string_view message, std::string_view answer);

 private:
  AppendedFile file_;
  bool sync_;
};

// A session that may write a transcript. Not thread safe.
struct LiveRun {
  std::unique_ptr<LiveSession> session;
  // Of a session that goes on:
  std::int64_t turns = 0;       // messages taken before
  std::int64_t other_turn = 0;  // the first one, from 1, at which the policy would now choose otherwise; 0: none
  bool torn = false;            // the last line was not whole, and is left out

  // What a user should know of these; empty where nothing is to be said.
  std::string note() const;
};

struct TranscriptOptions {
  std::filesystem::path file;  // empty: none
  bool sync = false;
  bool resume = false;  // go on where it ends; then the options are those of the transcript
};

// Throws Error on bad options, on a file that is there or, to go on with, is no transcript, naming the line.
LiveRun begin_live(const LiveOptions& options, const TranscriptOptions& transcript = {});

// A transcript played again, without writing to it. Throws Error, naming the line, on anything but a transcript.
LiveRun replay_transcript(const std::filesystem::path& file);

// Whether a text begins as a transcript does.
bool is_transcript(std::string_view text);

}  // namespace graphdrl
