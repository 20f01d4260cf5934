#include "graphdrl/live/exploration_service.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <random>
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

bool is_error(const std::string& answer) {
  return nlohmann::json::parse(answer).contains("error");
}

// Nobody guesses another one's.
std::string new_name() {
  std::random_device device;
  return fmt::format("{:08x}{:08x}", device(), device());
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
  std::erase_if(running_, [&](const auto& one) { return one.second.last < before; });
}

ExplorationService::Running* ExplorationService::find(const HttpRequest& request) {
  const auto found = running_.find(request.path.substr(request.path.rfind('/') + 1));
  if (found == running_.end()) return nullptr;
  found->second.last = Clock::now();
  return &found->second;
}

HttpAnswer ExplorationService::begin(const HttpRequest& request) {
  if (running_.size() >= limits_.explorations) {
    return refusal(kTooMany, fmt::format("there are {} explorations already", running_.size()));
  }
  Running one{
      .session = {}, .transcript = std::make_shared<std::string>(transcript_head(defaults_)), .last = Clock::now()};
  one.session = std::make_unique<LiveSession>(
      defaults_, [lines = one.transcript, most = limits_.transcript_bytes](auto message, auto answer) {
        if (lines->size() <= most) *lines += transcript_line(message, answer);
      });
  if (!request.body.empty()) {
    const std::string answer = one.session->answer(request.body);
    if (is_error(answer)) return json_answer(kBadRequest, answer);
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
  const int status = is_error(answer) ? kBadRequest : HttpAnswer().status;
  return json_answer(status, std::move(answer));
}

HttpAnswer ExplorationService::transcript(const HttpRequest& request) {
  const Running* const one = find(request);
  if (one == nullptr) return refusal(kNotFound, "no such exploration");
  if (one->transcript->size() > limits_.transcript_bytes) return refusal(kTooLarge, "the transcript is too long");
  return {.type = "application/jsonl", .body = std::make_shared<const std::string>(*one->transcript)};
}

HttpAnswer ExplorationService::end(const HttpRequest& request) {
  const Running* const one = find(request);
  if (one == nullptr) return refusal(kNotFound, "no such exploration");
  const LiveExploration* const exploration = one->session->exploration();
  const LiveReport report = exploration == nullptr ? LiveReport() : exploration->report();
  running_.erase(request.path.substr(request.path.rfind('/') + 1));
  return json_answer(
      HttpAnswer().status,
      nlohmann::ordered_json{{"done", name_of(LiveStep::Done::kClosed)}, {"report", live_report_json(report)}}.dump());
}

}  // namespace graphdrl
