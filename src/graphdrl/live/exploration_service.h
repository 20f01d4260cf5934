// Live explorations over HTTP, any number side by side.
#pragma once

#include <chrono>
#include <cstddef>
#include <map>
#include <memory>
#include <string>
#include <string_view>

#include "graphdrl/http/http_server.h"
#include "graphdrl/live/session.h"

namespace graphdrl {

struct ExplorationLimits {
  std::size_t explorations = 1000;           // at once
  std::chrono::milliseconds idle{3600'000};  // then an exploration ends
  // Of one transcript, and of all together; those that grow longer are dropped.
  std::size_t transcript_bytes = std::size_t{64} << 20;
  std::size_t all_transcript_bytes = std::size_t{1} << 30;
};

// POST /explorations begins one: the body is empty, or a message that opens; 201 with its name.
// POST /explorations/NAME takes a message and gives the answer; 400 where that is an error.
// GET /explorations/NAME gives the transcript, DELETE ends the exploration and gives its report.
// What is refused: 404 no such exploration, 413 a transcript too long, 429 too many explorations.
class ExplorationService {
 public:
  // defaults: of explorations that are not opened with other options. Adds its handlers to a server, which must not run
  // yet and not outlive it.
  ExplorationService(HttpServer& server, LiveOptions defaults, const ExplorationLimits& limits = {});

 private:
  using Clock = std::chrono::steady_clock;

  struct Written {
    std::string lines;     // of a transcript
    bool dropped = false;  // it grew too long
  };
  struct Running {
    std::unique_ptr<LiveSession> session;
    std::shared_ptr<Written> written;
    Clock::time_point last;  // that it was asked
  };

  HttpAnswer begin(const HttpRequest& request);
  HttpAnswer take(const HttpRequest& request);
  HttpAnswer transcript(const HttpRequest& request);
  HttpAnswer end(const HttpRequest& request);
  void end_idle_ones();
  void write(Written& written, std::string_view line);
  Running* find(const HttpRequest& request);

  LiveOptions defaults_;
  ExplorationLimits limits_;
  std::map<std::string, Running> running_;  // by name
  std::size_t written_bytes_ = 0;           // of all transcripts
};

}  // namespace graphdrl
