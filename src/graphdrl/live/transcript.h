// A live exploration on disk, step by step: what was told and what was answered.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>

#include "graphdrl/io/file.h"
#include "graphdrl/live/session.h"

namespace graphdrl {

// Lines of JSON: the options, then a message with its answer each.
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

// A transcript played again.
struct Replayed {
  std::unique_ptr<LiveSession> session;
  std::int64_t turns = 0;       // messages
  std::int64_t other_turn = 0;  // the first one, from 1, at which the policy would now choose otherwise; 0: none
  bool torn = false;            // the last line was not whole, and is left out
};

// record: of the session that it gives, for messages to come. Throws Error, naming the line, on anything but a
// transcript.
Replayed replay_transcript(const std::filesystem::path& file, LiveSession::Record record = {});

// Whether a text begins as a transcript does.
bool is_transcript(std::string_view text);

}  // namespace graphdrl
