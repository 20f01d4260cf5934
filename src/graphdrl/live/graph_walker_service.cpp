#include "graphdrl/live/graph_walker_service.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <queue>
#include <utility>

#include "graphdrl/base/error.h"
#include "graphdrl/graph/postman.h"
#include "graphdrl/io/utf8.h"

namespace graphdrl {
namespace {

using nlohmann::ordered_json;
using Kind = StopCondition::Kind;

constexpr double kAll = 100;  // percent

double percent(int part, std::size_t all) {
  return all == 0 ? kAll : kAll * part / static_cast<double>(all);
}

HttpAnswer ok(ordered_json answer = ordered_json::object()) {
  answer["result"] = "ok";
  return {.type = "application/json", .body = std::make_shared<const std::string>(answer.dump())};
}

HttpAnswer not_ok(const std::string& error) {
  return {.type = "application/json",
          .body = std::make_shared<const std::string>(ordered_json{{"result", "nok"}, {"error", error}}.dump())};
}

// What stands in a path behind /graphwalker/COMMAND/. Each %XX stands for a byte.
std::string argument_of(const HttpRequest& request) {
  constexpr int kSlashesBefore = 3;
  std::size_t begin = 0;
  for (int slash = 0; slash < kSlashesBefore; ++slash) begin = request.path.find('/', begin) + 1;
  const std::string_view part = std::string_view(request.path).substr(begin);
  std::string text;
  for (std::size_t i = 0; i < part.size(); ++i) {
    const std::string digits(part.substr(i + 1, 2));
    if (part[i] == '%' && digits.find_first_not_of("0123456789abcdefABCDEF") == std::string::npos &&
        digits.size() == 2) {
      text += static_cast<char>(std::stoi(digits, nullptr, 16));
      i += 2;
    } else {
      text += part[i];
    }
  }
  return text;
}

}  // namespace

ModelWalk::ModelWalk(WalkerModel model)
    : model_(std::move(model)),
      leaving_(model_.vertices.size()),
      walked_(model_.edges.size()),
      visited_(model_.vertices.size()) {
  for (int edge = 0; edge < static_cast<int>(model_.ends.size()); ++edge) {
    if (model_.ends[edge].a == kNoNode) continue;
    leaving_[model_.ends[edge].a].push_back(std::ssize(graph_.edges));
    graph_.edges.push_back(model_.ends[edge]);
    number_of_.push_back(edge);
  }
}

bool ModelWalk::holds(const StopCondition::Term& term) const {
  constexpr double kRounding = 1e-9;
  switch (term.kind) {
    case Kind::kEdgeCoverage:
      return percent(walked_count_, model_.edges.size()) >= term.value - kRounding;
    case Kind::kVertexCoverage:
      return percent(visited_count_, model_.vertices.size()) >= term.value - kRounding;
    case Kind::kLength:
      return static_cast<double>(pairs_) >= term.value;
    case Kind::kTimeDuration:
      return std::chrono::duration<double>(std::chrono::steady_clock::now() - since_).count() >= term.value;
    case Kind::kReachedVertex:
      return position_ != kNoNode && model_.vertices[position_].name == term.name;
    case Kind::kReachedEdge:
      for (std::size_t edge = 0; edge < walked_.size(); ++edge) {
        if (walked_[edge] && model_.edges[edge].name == term.name) return true;
      }
      return false;
    case Kind::kNever:
      break;
  }
  return false;
}

bool ModelWalk::fulfilled() const {
  return std::ranges::any_of(model_.generator.stop.any_of, [&](const auto& terms) {
    return std::ranges::all_of(terms, [&](const auto& term) { return holds(term); });
  });
}

bool ModelWalk::has_next() {
  if (failed_) return false;
  if (edge_ >= 0 || steps_ == 0) return true;  // an edge is walked to its end
  return !fulfilled() && (!ahead_.empty() || plan());
}

ModelWalk::Element ModelWalk::next() {
  ++steps_;
  if (steps_ == 1 && model_.start_edge < 0) {
    position_ = model_.start_vertex;
  } else if (edge_ < 0) {
    edge_ = model_.start_edge;
    if (steps_ > 1) {
      edge_ = number_of_[ahead_.back()];
      ahead_.pop_back();
    }
    walked_count_ += !walked_[edge_];
    walked_[edge_] = true;
    return {.edge = true, .number = edge_};
  } else {
    position_ = model_.ends[edge_].b;
    edge_ = -1;
    ++pairs_;
  }
  visited_count_ += !visited_[position_];
  visited_[position_] = true;
  return {.edge = false, .number = position_};
}

// By the shortest way over the first edge that is aimed at.
template <typename Aim>
void ModelWalk::plan_to(const Aim& aimed_at) {
  std::vector<std::int64_t> came_by(model_.vertices.size(), -1);
  std::vector<bool> met(model_.vertices.size());
  std::queue<NodeId> queue;
  queue.push(position_);
  met[position_] = true;
  while (!queue.empty()) {
    const NodeId here = queue.front();
    queue.pop();
    for (const std::int64_t edge : leaving_[here]) {
      const NodeId next = graph_.edges[edge].b;
      if (aimed_at(edge)) {
        ahead_.push_back(edge);
        for (NodeId at = here; at != position_; at = graph_.edges[came_by[at]].a) ahead_.push_back(came_by[at]);
        return;
      }
      if (met[next]) continue;
      met[next] = true;
      came_by[next] = edge;
      queue.push(next);
    }
  }
}

// What comes next, from where the walk stands, for the list of terms that lacks least. False where it cannot go on.
bool ModelWalk::plan() {
  const auto lacks = [&](const auto& terms) {
    return std::ranges::count_if(terms, [&](const auto& term) { return !holds(term); });
  };
  const auto& terms = *std::ranges::min_element(model_.generator.stop.any_of, {}, lacks);
  for (const StopCondition::Term& term : terms) {
    if (!ahead_.empty()) break;
    if (holds(term)) continue;
    if (term.kind == Kind::kEdgeCoverage) plan_over_edges(/*again=*/false);
    if (term.kind == Kind::kVertexCoverage) plan_to([&](std::int64_t edge) { return !visited_[graph_.edges[edge].b]; });
    if (term.kind == Kind::kReachedVertex) {
      plan_to([&](std::int64_t edge) { return model_.vertices[graph_.edges[edge].b].name == term.name; });
    }
    if (term.kind == Kind::kReachedEdge) {
      plan_to([&](std::int64_t edge) { return model_.edges[number_of_[edge]].name == term.name; });
    }
  }
  const bool for_long = std::ranges::any_of(terms, [&](const auto& term) {
    return !holds(term) &&
           (term.kind == Kind::kLength || term.kind == Kind::kTimeDuration || term.kind == Kind::kNever);
  });
  if (ahead_.empty() && for_long) {
    plan_over_edges(/*again=*/true);
    // All that can be reached from here has been walked: on by any edge.
    const auto& leaving = leaving_[position_];
    if (ahead_.empty() && !leaving.empty())
      ahead_.push_back(leaving[static_cast<std::size_t>(pairs_) % leaving.size()]);
  }
  return !ahead_.empty();
}

// By the shortest walk over all edges where none has been walked, or all have and are to be walked again; else to the
// nearest edge left.
void ModelWalk::plan_over_edges(bool again) {
  const auto walked = [&](int edge) { return walked_[edge]; };
  if (std::ranges::none_of(number_of_, walked) || (again && std::ranges::all_of(number_of_, walked))) {
    const auto vertices = static_cast<NodeId>(model_.vertices.size());
    if (auto found = postman_walk(graph_, EdgeKind::kDirected, vertices, position_, {})) {
      ahead_ = std::move(found->walk.edges);
      std::ranges::reverse(ahead_);
      return;
    }
  }
  plan_to([&](std::int64_t edge) { return !walked_[number_of_[edge]]; });
}

GraphWalkerService::GraphWalkerService(HttpServer& server, std::vector<WalkerModel> models)
    : models_(std::move(models)) {
  begin();
  const auto on = [&](const char* method, const char* path,
                      HttpAnswer (GraphWalkerService::*answer)(const HttpRequest&)) {
    server.on(method, std::string("/graphwalker/") + path, [this, answer](const HttpRequest& request) {
      try {
        return (this->*answer)(request);
      } catch (const Error& error) {
        return not_ok(error.what());
      }
    });
  };
  on("POST", "load", &GraphWalkerService::load);
  on("GET", "hasNext", &GraphWalkerService::has_next);
  on("GET", "getNext", &GraphWalkerService::get_next);
  on("GET", "getData", &GraphWalkerService::get_data);
  on("PUT", "setData/*", &GraphWalkerService::set_data);
  on("PUT", "restart", &GraphWalkerService::restart);
  on("PUT", "fail/*", &GraphWalkerService::fail);
  on("GET", "getStatistics", &GraphWalkerService::statistics);
}

void GraphWalkerService::begin() {
  walks_.clear();
  for (const WalkerModel& model : models_) walks_.emplace_back(model);
  current_ = 0;
  data_.clear();
}

// The walk that goes on; null where all are at their end.
ModelWalk* GraphWalkerService::current() {
  while (current_ < walks_.size() && !walks_[current_].has_next()) ++current_;
  return current_ < walks_.size() ? &walks_[current_] : nullptr;
}

HttpAnswer GraphWalkerService::load(const HttpRequest& request) {
  std::vector<WalkerModel> models = parse_walker_models(request.body, "the models");
  models_ = std::move(models);
  begin();
  return ok({{"note", fmt::format("{} is replaced: walks are planned", models_.front().generator.name)}});
}

HttpAnswer GraphWalkerService::has_next(const HttpRequest& /*request*/) {
  if (walks_.empty()) return not_ok("no model is loaded");
  return ok({{"hasNext", current() != nullptr ? "true" : "false"}});
}

HttpAnswer GraphWalkerService::get_next(const HttpRequest& /*request*/) {
  if (walks_.empty()) return not_ok("no model is loaded");
  ModelWalk* const walk = current();
  if (walk == nullptr) return not_ok("there is no next step");
  const auto [edge, number] = walk->next();
  const WalkerModel& model = walk->model();
  const WalkerModel::Element& element = edge ? model.edges[number] : model.vertices[number];
  return ok({{"currentElementID", element.id},
             {"currentElementName", element.name},
             {"modelName", model.name},
             {"data", ordered_json::array()},
             {"properties", ordered_json::parse(element.properties)}});
}

HttpAnswer GraphWalkerService::get_data(const HttpRequest& /*request*/) {
  if (walks_.empty()) return not_ok("no model is loaded");
  ordered_json data = ordered_json::object();
  for (const auto& [key, value] : data_) data[key] = value;
  return ok({{"data", std::move(data)}});
}

HttpAnswer GraphWalkerService::set_data(const HttpRequest& request) {
  if (walks_.empty()) return not_ok("no model is loaded");
  const std::string text = argument_of(request);
  if (text != valid_utf8(text)) return not_ok("expected UTF-8");
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0) return not_ok("expected setData/KEY=VALUE");
  std::string value = text.substr(equals + 1);
  if (value.size() >= 2 && value.front() == '"' && value.back() == '"') value = value.substr(1, value.size() - 2);
  data_[text.substr(0, equals)] = std::move(value);
  return ok();
}

HttpAnswer GraphWalkerService::restart(const HttpRequest& /*request*/) {
  if (models_.empty()) return not_ok("no model is loaded");
  begin();
  return ok();
}

HttpAnswer GraphWalkerService::fail(const HttpRequest& /*request*/) {
  if (current_ >= walks_.size()) return not_ok("no model is being walked");
  walks_[current_].fail();
  return ok();
}

HttpAnswer GraphWalkerService::statistics(const HttpRequest& /*request*/) {
  if (walks_.empty()) return not_ok("no model is loaded");
  int completed = 0;
  int failed = 0;
  int begun = 0;
  int edges = 0;
  int vertices = 0;
  std::size_t all_edges = 0;
  std::size_t all_vertices = 0;
  ordered_json edges_left = ordered_json::array();
  ordered_json vertices_left = ordered_json::array();
  for (const ModelWalk& walk : walks_) {
    const WalkerModel& model = walk.model();
    failed += walk.failed();
    completed += walk.begun() && !walk.failed() && walk.fulfilled();
    begun += walk.begun();
    edges += walk.walked_count();
    vertices += walk.visited_count();
    all_edges += model.edges.size();
    all_vertices += model.vertices.size();
    for (std::size_t i = 0; i < model.edges.size(); ++i) {
      if (walk.walked(static_cast<int>(i))) continue;
      edges_left.push_back(
          {{"modelName", model.name}, {"edgeId", model.edges[i].id}, {"edgeName", model.edges[i].name}});
    }
    for (std::size_t i = 0; i < model.vertices.size(); ++i) {
      if (walk.visited(static_cast<NodeId>(i))) continue;
      vertices_left.push_back(
          {{"modelName", model.name}, {"vertexId", model.vertices[i].id}, {"vertexName", model.vertices[i].name}});
    }
  }
  const auto models = static_cast<int>(walks_.size());
  return ok({{"totalNumberOfModels", models},
             {"totalCompletedNumberOfModels", completed},
             {"totalFailedNumberOfModels", failed},
             {"totalIncompleteNumberOfModels", begun - completed - failed},
             {"totalNotExecutedNumberOfModels", models - begun},
             {"totalNumberOfEdges", all_edges},
             {"totalNumberOfVisitedEdges", edges},
             {"totalNumberOfUnvisitedEdges", all_edges - edges},
             {"edgeCoverage", static_cast<int>(percent(edges, all_edges))},
             {"edgesNotVisited", std::move(edges_left)},
             {"totalNumberOfVertices", all_vertices},
             {"totalNumberOfVisitedVertices", vertices},
             {"totalNumberOfUnvisitedVertices", all_vertices - vertices},
             {"vertexCoverage", static_cast<int>(percent(vertices, all_vertices))},
             {"verticesNotVisited", std::move(vertices_left)},
             {"totalNumberOfRequirement", 0}});
}

}  // namespace graphdrl
