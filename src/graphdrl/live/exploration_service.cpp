#include "graphdrl/live/exploration_service.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <random>
#include <string_view>
#include <utility>

#include "graphdrl/live/transcript.h"

namespace graphdrl {
namespace {

constexpr int kCreated = 201;
constexpr int kBadRequest = 400;
constexpr int kNotFound = 404;
constexpr int kTooLarge = 413;
constexpr int kTooMany = 429;

HttpAnswer json_answer(int status, std::string json) {
  return {.status = status,
          .type = "application/json",
          .body = std::make_shared<const std::string>(std::move(json) + '\n')};
}

HttpAnswer refusal(int status, const std::string& text) {
  return json_answer(status, nlohmann::ordered_json{{"error", text}}.dump());
}

// A name that no other client guesses.
std::string new_name() {
  std::random_device device;
  return fmt::format("{:08x}{:08x}", device(), device());
}

std::string name_in(const HttpRequest& request) {
  return request.path.substr(request.path.rfind('/') + 1);
}

}  // namespace

ExplorationService::ExplorationService(HttpServer& server, LiveOptions defaults, const ExplorationLimits& limits)
    : defaults_(std::move(defaults)), limits_(limits) {
  const auto on = [&](const char* method, const char* path,
                      HttpAnswer (ExplorationService::*answer)(const HttpRequest&)) {
    server.on(method, path, [this, answer](const HttpRequest& request) {
      end_idle_ones();
      return (this->*answer)(request);
    });
  };
  on("POST", "/explorations", &ExplorationService::begin);
  on("POST", "/explorations/*", &ExplorationService::take);
  on("GET", "/explorations/*", &ExplorationService::transcript);
  on("DELETE", "/explorations/*", &ExplorationService::end);
}

void ExplorationService::end_idle_ones() {
  const auto before = Clock::now() - limits_.idle;
  for (auto one = running_.begin(); one != running_.end();) {
    if (one->second.last < before) {
      written_bytes_ -= one->second.written->lines.size();
      one = running_.erase(one);
    } else {
      ++one;
    }
  }
}

ExplorationService::Running* ExplorationService::find(const HttpRequest& request) {
  const auto found = running_.find(name_in(request));
  if (found == running_.end()) return nullptr;
  found->second.last = Clock::now();
  return &found->second;
}

// What is too much is dropped whole: half a transcript is of no use.
void ExplorationService::write(Written& written, std::string_view line) {
  if (written.dropped) return;
  if (written.lines.size() + line.size() > limits_.transcript_bytes ||
      written_bytes_ + line.size() > limits_.all_transcript_bytes) {
    written_bytes_ -= written.lines.size();
    written = {.lines = {}, .dropped = true};
    return;
  }
  written.lines += line;
  written_bytes_ += line.size();
}

HttpAnswer ExplorationService::begin(const HttpRequest& request) {
  if (running_.size() >= limits_.explorations) {
    return refusal(kTooMany, fmt::format("there are {} explorations already", running_.size()));
  }
  Running one{.session = {}, .written = std::make_shared<Written>(), .last = Clock::now()};
  write(*one.written, transcript_head(defaults_));
  one.session = std::make_unique<LiveSession>(
      defaults_, [this, written = one.written](std::string_view message, std::string_view answer) {
        write(*written, transcript_line(message, answer));
      });
  if (!request.body.empty()) {
    const std::string answer = one.session->answer(request.body);
    if (one.session->refused()) return json_answer(kBadRequest, answer);
    if (one.session->exploration() != nullptr) return refusal(kBadRequest, "a message that opens, or none, begins");
  }
  const std::string name = new_name();
  running_.emplace(name, std::move(one));
  return json_answer(kCreated, nlohmann::ordered_json{{"exploration", name}}.dump());
}

HttpAnswer ExplorationService::take(const HttpRequest& request) {
  Running* const one = find(request);
  if (one == nullptr) return refusal(kNotFound, "no such exploration");
  std::string answer = one->session->answer(request.body);
  return json_answer(one->session->refused() ? kBadRequest : HttpAnswer().status, std::move(answer));
}

HttpAnswer ExplorationService::transcript(const HttpRequest& request) {
  const Running* const one = find(request);
  if (one == nullptr) return refusal(kNotFound, "no such exploration");
  if (one->written->dropped) return refusal(kTooLarge, "the transcript is too long");
  return {.type = "application/jsonl", .body = std::make_shared<const std::string>(one->written->lines)};
}

HttpAnswer ExplorationService::end(const HttpRequest& request) {
  const Running* const one = find(request);
  if (one == nullptr) return refusal(kNotFound, "no such exploration");
  std::string report = one->session->report();
  written_bytes_ -= one->written->lines.size();
  running_.erase(name_in(request));
  return json_answer(HttpAnswer().status, std::move(report));
}

}  // namespace graphdrl
