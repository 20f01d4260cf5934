#include "graphdrl/live/session.h"

#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <utility>

#include "graphdrl/io/json.h"

namespace graphdrl {
namespace {

using nlohmann::json;
using nlohmann::ordered_json;

void check_fields(const json& object, std::initializer_list<std::string_view> known, const std::string& what) {
  if (!object.is_object()) {
    throw FieldError(what, {.what = "not an object", .got = shortened(object)});
  }
  for (const auto& item : object.items()) {
    if (std::ranges::find(known, item.key()) != known.end()) continue;
    throw FieldError(escaped(item.key()),
                     {.what = "an unknown field", .expected = fmt::format("{}", fmt::join(known, ", "))});
  }
}

std::string text_of(const json& object, const char* field) {
  const json& value = object.at(field);
  if (!value.is_string()) throw FieldError(field, {.what = "bad value", .expected = "a text", .got = shortened(value)});
  return value.get<std::string>();
}

double amount_of(const json& object, const char* field) {
  const json& value = object.at(field);
  const bool good = value.is_number() && value.get<double>() >= 0;
  if (!good) {
    throw FieldError(field, {.what = "bad value", .expected = "a number of at least 0", .got = shortened(value)});
  }
  return value.get<double>();
}

bool truth_of(const json& object, const char* field) {
  const json& value = object.at(field);
  if (!value.is_boolean()) {
    throw FieldError(field, {.what = "bad value", .expected = "true or false", .got = shortened(value)});
  }
  return value.get<bool>();
}

std::vector<OfferedMove> moves_of(const json& moves) {
  if (!moves.is_array())
    throw FieldError("moves", {.what = "bad value", .expected = "a list", .got = shortened(moves)});
  std::vector<OfferedMove> offered;
  offered.reserve(moves.size());
  for (const json& move : moves) {
    if (move.is_string()) {
      offered.push_back({.name = move.get<std::string>()});
      continue;
    }
    check_fields(move, {"move", "to", "cost", "tried"}, "moves");
    if (!move.contains("move")) throw FieldError("moves", {.what = "a move has no name", .got = shortened(move)});
    OfferedMove one{.name = text_of(move, "move")};
    if (move.contains("to")) one.to = text_of(move, "to");
    if (move.contains("cost")) one.cost = amount_of(move, "cost");
    if (move.contains("tried")) one.tried = truth_of(move, "tried");
    offered.push_back(std::move(one));
  }
  return offered;
}

double number_of(const json& object, const char* field) {
  const json& value = object.at(field);
  if (!value.is_number()) {
    throw FieldError(field, {.what = "bad value", .expected = "a number", .got = shortened(value)});
  }
  return value.get<double>();
}

Point point_of(const json& object, const char* field) {
  const json& value = object.at(field);
  const bool good = value.is_array() && value.size() == 2 && value[0].is_number() && value[1].is_number();
  if (!good) throw FieldError(field, {.what = "bad value", .expected = "[x, y]", .got = shortened(value)});
  return {value[0].get<double>(), value[1].get<double>()};
}

int count_of(const json& object, const char* field) {
  const json& value = object.at(field);
  if (!value.is_number_unsigned() || value.get<std::uint64_t>() > CellGraph::kMostCells) {
    throw FieldError(field, {.what = "bad value",
                             .expected = fmt::format("a whole number from 0 to {}", CellGraph::kMostCells),
                             .got = shortened(value)});
  }
  return value.get<int>();
}

CellPatch patch_of(const json& cells) {
  check_fields(cells, {"origin", "resolution", "width", "height", "data"}, "cells");
  for (const char* const field : {"origin", "resolution", "width", "height", "data"}) {
    if (!cells.contains(field)) throw FieldError("cells", {.what = fmt::format("{} is missing", field)});
  }
  CellPatch patch{.origin = point_of(cells, "origin"),
                  .resolution = number_of(cells, "resolution"),
                  .width = count_of(cells, "width"),
                  .height = count_of(cells, "height")};
  const json& data = cells.at("data");
  if (!data.is_array()) throw FieldError("data", {.what = "bad value", .expected = "a list", .got = shortened(data)});
  patch.data.reserve(data.size());
  for (const json& value : data) {
    const bool good = value.is_number_integer() && value >= -1 && value <= 100;
    if (!good) {
      throw FieldError("data",
                       {.what = "bad value", .expected = "whole numbers from -1 to 100", .got = shortened(value)});
    }
    patch.data.push_back(value.get<std::int8_t>());
  }
  return patch;
}

LiveObservation observation_of(const json& message) {
  if (message.is_object() && message.contains("at")) {
    check_fields(message, {"id", "at", "cells", "cost", "failed", "explorer"}, "");
  } else {
    check_fields(message, {"id", "state", "cost", "prize", "moves", "failed", "explorer"}, "");
    if (!message.contains("state")) {
      throw FieldError("state", {.what = "a message says where the client is, or opens"});
    }
  }
  LiveObservation seen;
  if (message.contains("state")) seen.state = text_of(message, "state");
  if (message.contains("at")) seen.at = point_of(message, "at");
  if (message.contains("cells")) seen.cells = patch_of(message.at("cells"));
  if (message.contains("cost")) seen.cost = amount_of(message, "cost");
  if (message.contains("prize")) seen.prize = amount_of(message, "prize");
  if (message.contains("failed")) seen.failed = truth_of(message, "failed");
  if (message.contains("moves")) seen.moves = moves_of(message.at("moves"));
  if (message.contains("explorer") && message.at("explorer") != 0) {
    throw FieldError("explorer",
                     {.what = "there is one explorer", .expected = "0", .got = shortened(message.at("explorer"))});
  }
  return seen;
}

ordered_json error_json(const std::string& text, const std::string& field) {
  ordered_json answer{{"error", text}};
  if (!field.empty()) answer["field"] = field;
  return answer;
}

// A step as an answer tells it.
LiveStep step_of(const json& answer) {
  LiveStep step;
  if (answer.contains("move")) {
    step.kind = LiveStep::Kind::kMove;
    step.move = text_of(answer, "move");
  } else if (answer.contains("reset")) {
    step.kind = LiveStep::Kind::kReset;
  } else if (answer.contains("goto")) {
    step.kind = LiveStep::Kind::kGoto;
    for (const json& point : answer.at("goto")) step.way.push_back(point_of({{"goto", point}}, "goto"));
  } else {
    if (!answer.contains("done")) throw Error({.what = "an answer without a step"});
    const std::string done = text_of(answer, "done");
    for (const auto why : {LiveStep::Done::kCovered, LiveStep::Done::kBudget, LiveStep::Done::kUnreachable}) {
      if (done == name_of(why)) step.done = why;
    }
  }
  if (answer.contains("expects")) step.expects = text_of(answer, "expects");
  return step;
}

}  // namespace

LiveOptions parse_live_options(const json& open, const LiveOptions& defaults) {
  check_fields(open,
               {"protocol", "cover", "score", "connectivity", "directed", "budget", "end", "reset_cost", "policy",
                "think_time", "seed", "explorers"},
               "open");
  LiveOptions options = defaults;
  const auto only = [&](const char* field, const json& value) {
    if (!open.contains(field) || open.at(field) == value) return;
    throw FieldError(field, {.what = "bad value", .expected = value.dump(), .got = shortened(open.at(field))});
  };
  only("protocol", kLiveProtocol);
  only("explorers", 1);
  if (open.contains("cover")) options.cover = parse_cover(text_of(open, "cover"));
  if (open.contains("directed")) options.directed = truth_of(open, "directed");
  if (open.contains("score")) {
    options.score.reset();
    if (!open.at("score").is_null()) options.score = parse_score(text_of(open, "score"));
  }
  if (open.contains("connectivity")) {
    const json& count = open.at("connectivity");
    if (count != 4 && count != 8) {
      throw FieldError("connectivity", {.what = "bad value", .expected = "4 or 8", .got = shortened(count)});
    }
    options.connectivity = count.get<int>();
  }
  if (open.contains("budget")) {
    options.budget = open.at("budget").is_null() ? kNoLimit : amount_of(open, "budget");
  }
  if (open.contains("end")) {
    const std::string end = text_of(open, "end");
    if (end != "start" && end != "anywhere") {
      throw FieldError("end", {.what = "bad value", .expected = "anywhere or start", .got = in_quotes(end)});
    }
    options.end_at_start = end == "start";
  }
  if (open.contains("reset_cost")) {
    if (open.at("reset_cost").is_null()) {
      options.reset_cost.reset();
    } else {
      options.reset_cost = amount_of(open, "reset_cost");
    }
  }
  if (open.contains("policy")) options.policy = text_of(open, "policy");
  if (open.contains("think_time")) {
    options.think_s = open.at("think_time").is_null() ? kNoLimit : amount_of(open, "think_time");
  }
  if (open.contains("seed")) {
    const json& seed = open.at("seed");
    if (!seed.is_number_unsigned()) {
      throw FieldError("seed", {.what = "bad value", .expected = "a whole number from 0", .got = shortened(seed)});
    }
    options.seed = seed.get<std::uint64_t>();
  }
  return options;
}

ordered_json live_options_json(const LiveOptions& options) {
  const auto limit = [](double value) { return value == kNoLimit ? ordered_json() : ordered_json(value); };
  ordered_json score;
  if (options.score) score = *options.score == Score::kSeen ? "seen" : "visited";
  return {{"protocol", kLiveProtocol},
          {"cover", options.cover == Cover::kNodes ? "nodes" : "edges"},
          {"directed", options.directed},
          {"score", score},
          {"connectivity", options.connectivity},
          {"budget", limit(options.budget)},
          {"end", options.end_at_start ? "start" : "anywhere"},
          {"reset_cost", options.reset_cost ? ordered_json(*options.reset_cost) : ordered_json()},
          {"policy", options.policy},
          {"think_time", limit(options.think_s)},
          {"seed", options.seed}};
}

namespace {

ordered_json point_json(const Point& point) {
  return ordered_json::array({point.x, point.y});
}

ordered_json cells_report_json(const LiveReport& report) {
  const LiveCellReport& cells = *report.cells;
  ordered_json failed = ordered_json::array();
  for (const auto& [goal, failures] : cells.failed) {
    failed.push_back({{"goto", point_json(goal)}, {"failures", failures}});
  }
  return {{"steps", report.steps},    {"cost", report.cost},        {"at", point_json(cells.at)},
          {"seen", cells.seen},       {"visited", cells.visited},   {"left", cells.left},
          {"changed", cells.changed}, {"failed", std::move(failed)}};
}

}  // namespace

ordered_json live_report_json(const LiveReport& report) {
  if (report.cells) return cells_report_json(report);
  ordered_json failed = ordered_json::array();
  for (const auto& [state, move, failures] : report.failed) {
    if (move.empty()) {
      failed.push_back({{"reset", true}, {"failures", failures}});
    } else {
      failed.push_back({{"state", state}, {"move", move}, {"failures", failures}});
    }
  }
  ordered_json surprises = ordered_json::array();
  for (const Surprise& one : report.surprises) {
    ordered_json surprise{{"step", one.step}, {"state", one.state}};
    if (one.move.empty()) {
      surprise["reset"] = true;
    } else {
      surprise["move"] = one.move;
    }
    surprise["expected"] = one.expected;
    surprise["got"] = one.got;
    surprises.push_back(std::move(surprise));
  }
  return {{"steps", report.steps},
          {"cost", report.cost},
          {"state", report.state},
          {"states", report.states},
          {"transitions", report.transitions},
          {"resets", report.resets},
          {"failed", std::move(failed)},
          {"surprises", std::move(surprises)},
          {"surprise_count", report.surprise_count},
          {"unreachable", report.unreachable}};
}

LiveSession::LiveSession(LiveOptions defaults, Record record)
    : defaults_(std::move(defaults)), record_(std::move(record)) {}

void LiveSession::open(const json& options) {
  if (exploration_ && exploration_->observed()) throw FieldError("open", {.what = "the exploration has begun"});
  exploration_.emplace(parse_live_options(options, defaults_));
}

ordered_json LiveSession::step_json(const LiveStep& step) const {
  ordered_json answer;
  switch (step.kind) {
    case LiveStep::Kind::kMove:
      answer["move"] = step.move;
      break;
    case LiveStep::Kind::kReset:
      answer["reset"] = true;
      break;
    case LiveStep::Kind::kGoto:
      answer["goto"] = ordered_json::array();
      for (const Point& point : step.way) answer["goto"].push_back(point_json(point));
      break;
    case LiveStep::Kind::kDone:
      answer["done"] = name_of(step.done);
      answer["report"] = live_report_json(exploration_->report());
      break;
  }
  if (step.expects) answer["expects"] = *step.expects;
  return answer;
}

ordered_json LiveSession::take(const json& message) {
  if (message.is_object() && message.contains("open")) {
    check_fields(message, {"id", "open"}, "");
    open(message.at("open"));
    return {{"ok", true}, {"protocol", kLiveProtocol}};
  }
  const LiveObservation seen = observation_of(message);
  if (!exploration_) open(json::object());
  exploration_->observe(seen);  // throws before anything changes
  broken_ = "the exploration has failed";
  const LiveStep& step = exploration_->next();
  broken_.clear();
  done_ = step.kind == LiveStep::Kind::kDone;
  return step_json(step);
}

const std::string* LiveSession::answered(const std::string& id) const {
  if (id.empty()) return nullptr;
  const auto found = std::ranges::find(answered_, id, &Answered::id);
  return found == answered_.end() ? nullptr : &found->answer;
}

void LiveSession::keep(const std::string& id, const std::string& answer) {
  if (id.empty()) return;
  answered_.push_back({.id = id, .answer = answer});
  if (answered_.size() > kAnswersKept) answered_.pop_front();
}

std::string LiveSession::answer(std::string_view text) {
  std::string id;
  ordered_json answer;
  bool taken = false;
  const bool begun = exploration_.has_value();
  try {
    if (!broken_.empty()) throw Error({.what = broken_});
    const json message = parse_json(text, "", "an object");
    if (message.is_object() && message.contains("id")) {
      const json& named = message.at("id");
      const bool good = named.is_number_integer() || named.is_string();
      const std::string written = good ? named.dump() : "";
      if (written.empty() || written.size() > kLongestId) {
        throw FieldError("id", {.what = "bad value",
                                .expected = "a whole number, or a text of at most 256 bytes",
                                .got = shortened(named)});
      }
      id = written;
      refused_ = false;
      if (const std::string* const before = answered(id)) return *before;
    }
    answer = take(message);
    taken = true;
  } catch (const FieldError& error) {
    answer = error_json(error.what(), error.field());
  } catch (const std::exception& error) {
    answer = error_json(error.what(), "");
  }
  if (!taken && !begun && exploration_ && !exploration_->observed()) exploration_.reset();
  if (!id.empty()) {
    ordered_json with_id{{"id", json::parse(id)}};
    with_id.update(answer);
    answer = std::move(with_id);
  }
  std::string line = answer.dump();
  refused_ = !taken;
  if (!taken) return line;
  // What cannot be written down would be missing when it is played again.
  broken_ = "the transcript could not be written";
  // What came on several lines goes down as one.
  if (record_) record_(text.find('\n') == std::string_view::npos ? text : json::parse(text).dump(), line);
  broken_.clear();
  keep(id, line);
  last_answer_ = line;
  return line;
}

bool LiveSession::replay(std::string_view text, std::string_view told) {
  const json message = parse_json(text, "");
  const json answer = parse_json(told, "");
  if (!answer.is_object() || !message.is_object()) throw Error({.what = "no message with its answer"});
  std::string id;
  if (message.contains("id")) id = message.at("id").dump();
  keep(id, std::string(told));
  last_answer_ = told;
  if (message.contains("open")) {
    take(message);
    return true;
  }
  const LiveStep step = step_of(answer);
  if (!exploration_) open(json::object());
  exploration_->observe(observation_of(message));
  done_ = step.kind == LiveStep::Kind::kDone;
  const bool chooses = exploration_->options().think_s == kNoLimit;  // as it did then
  const bool same = chooses && exploration_->next().kind == step.kind && exploration_->next().move == step.move &&
                    exploration_->next().way == step.way;
  if (!same) exploration_->next_was(step);
  return same || !chooses;
}

std::optional<std::string> LiveSession::close() const {
  return done_ ? std::nullopt : std::optional(report());
}

std::string LiveSession::report() const {
  const LiveReport report = exploration_ ? exploration_->report() : LiveReport();
  return ordered_json{{"done", name_of(LiveStep::Done::kClosed)}, {"report", live_report_json(report)}}.dump();
}

}  // namespace graphdrl
