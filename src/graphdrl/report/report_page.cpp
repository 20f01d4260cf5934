#include "graphdrl/report/report_page.h"

#include <fmt/format.h>

#include <boost/algorithm/string/replace.hpp>
#include <cmath>
#include <random>

#include "graphdrl/base/error.h"
#include "graphdrl/io/file.h"
#include "graphdrl/io/json.h"
#include "graphdrl/io/text.h"
#include "graphdrl/report/encoding.h"
#include "graphdrl/report/layout.h"
#include "graphdrl/report/page_parts.h"

namespace graphdrl {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kDataVersion = 1;                      // page.js reads no other
constexpr std::int64_t kMostEdgesShown = 2'000'000;  // of a graph; more would hide the nodes
constexpr int kNonceBytes = 18;

// Node i is bit i % 8 of byte i / 8.
std::string bitset(const std::vector<bool>& bits) {
  std::string bytes((bits.size() + 7) / 8, '\0');
  for (std::size_t i = 0; i < bits.size(); ++i) {
    if (bits[i]) bytes[i / 8] = static_cast<char>(bytes[i / 8] | 1 << (i % 8));
  }
  return base64(bytes);
}

Json edges_of(const Graph& graph) {
  Json edges = Json::array();
  if (graph.is_complete() || graph.edge_count() > kMostEdgesShown) return edges;
  for (NodeId node = 0; node < graph.node_count(); ++node) {
    for (const NodeId neighbour : graph.neighbours(node)) {
      if (!graph.directed() && neighbour < node) continue;
      edges.push_back(node);
      edges.push_back(neighbour);
    }
  }
  return edges;
}

Json world_json(const World& world) {
  Json json = {{"name", world.name()},
               {"nodes", world.node_count()},
               {"valid", world.valid_count()},
               {"kind", world.has_cells() ? "grid" : "graph"},
               {"blocked", bitset(world.blocked())},
               {"directed", world.open().directed()}};
  if (world.has_cells()) {
    json["rows"] = world.map()->rows;
    json["cols"] = world.map()->cols;
  } else {
    json["edges"] = edges_of(world.graph());
    json["laid_out"] = !world.has_places();
    for (const Point& place : places_of(world)) {
      json["x"].push_back(place.x);
      json["y"].push_back(place.y);
    }
  }
  if (!world.labels().empty()) json["labels"] = world.labels();
  if (world.has_prizes()) json["prizes"] = world.prizes();
  return json;
}

Json plan_of(const Answer& answer) {
  Json json = {{"policy", answer.policy},
               {"walk", answer.plan.walk},
               {"visited", answer.plan.visited},
               {"budget", answer.until_covered ? Json() : Json(answer.task.budget())},
               {"optimal", answer.plan.optimal}};
  if (!answer.discovered.nodes.empty()) {
    json["reveal"] = answer.reveal.text();
    json["seen_nodes"] = answer.discovered.nodes;
    json["seen_after_step"] = answer.discovered.after_step;
  }
  if (answer.world.open().weighted()) json["costs"] = costs_so_far(answer);
  if (std::isfinite(answer.plan.bound)) json["upper_bound"] = answer.world.percent_of_all(answer.plan.bound);
  return json;
}

// One line of metrics.jsonl a line of the array.
Json metrics_of(const std::filesystem::path& file) {
  const std::string text = read_file(file);
  Json entries = Json::array();
  Lines lines{std::string_view(text).substr(0, text.rfind('\n') + 1)};
  while (lines.next()) {
    if (trimmed(lines.line()).empty()) continue;
    const nlohmann::json entry = parse_json_or_discard(lines.line());
    if (!entry.is_object()) {
      throw Error({.what = "bad line of metrics",
                   .expected = "a JSON object",
                   .got = in_quotes(lines.line()),
                   .where = fmt::format("{}:{}", file.string(), lines.number())});
    }
    entries.push_back(Json(entry));
  }
  return entries;
}

// A random word, unknown before the page is made.
std::string nonce() {
  std::random_device device;
  std::string bytes;
  for (int i = 0; i < kNonceBytes; ++i) bytes += static_cast<char>(device());
  return base64(bytes);
}

}  // namespace

ReportPage::ReportPage(const std::string& title, bool watch)
    : document_({{"version", kDataVersion},
                 {"title", title},
                 {"watch", watch},
                 {"replays", Json::array()},
                 {"runs", Json::array()},
                 {"evaluations", Json::array()}}) {}

void ReportPage::add_plan(const Answer& answer, const std::optional<MoveScores>& scores) {
  Json& replays = document_["replays"];
  Json* replay = nullptr;
  for (Json& one : replays) {
    if (one["world"]["name"] == answer.world.name()) replay = &one;
  }
  if (replay == nullptr) {
    const std::string& name = answer.world.name();
    if (!worlds_.contains(name)) worlds_[name] = world_json(answer.world);
    replays.push_back({{"title", name}, {"world", worlds_[name]}, {"plans", Json::array()}});
    replay = &replays.back();
  }
  Json plan = plan_of(answer);
  if (scores) {
    plan["scores_name"] = scores->name;
    plan["lower_is_better"] = scores->lower_is_better;
    plan["scores"] = Json::array();
    for (const std::vector<MoveScore>& step : scores->steps) {
      Json moves = Json::array();
      for (const MoveScore& move : step) {
        moves.push_back(move.node);
        moves.push_back(move.score);
      }
      plan["scores"].push_back(std::move(moves));
    }
  }
  (*replay)["plans"].push_back(std::move(plan));
}

void ReportPage::add_run(const std::string& name, const std::filesystem::path& folder) {
  document_["runs"].push_back({{"name", name}, {"lines", metrics_of(folder / "metrics.jsonl")}});
}

void ReportPage::add_evaluation(const std::string& name, const nlohmann::json& evaluation) {
  document_["evaluations"].push_back({{"name", name},
                                      {"rows", Json(evaluation.value("rows", nlohmann::json::array()))},
                                      {"overall", Json(evaluation.value("overall", nlohmann::json::array()))}});
}

ReportPage ReportPage::emptied() const {
  ReportPage page(document_["title"].get<std::string>(), document_["watch"].get<bool>());
  page.worlds_ = worlds_;
  return page;
}

std::string ReportPage::data() const {
  return document_.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string ReportPage::html() const {
  const std::string data_element = boost::replace_all_copy(data(), "<", "\\u003c");  // no text in it ends the element
  const std::string title = markup(document_["title"].get<std::string>());
  const std::string secret = nonce();
  const std::map<std::string_view, std::string_view> values = {{"title", title},
                                                               {"css", page_style()},
                                                               {"chart_library", chart_library()},
                                                               {"script", page_script()},
                                                               {"data", data_element},
                                                               {"nonce", secret},
                                                               {"connect", document_["watch"] ? "'self'" : "'none'"}};
  // In one pass: tokens within the text put in are not replaced.
  std::string page;
  std::string_view rest = page_template();
  for (std::size_t begin = rest.find("{{"); begin != std::string_view::npos; begin = rest.find("{{")) {
    const std::size_t end = rest.find("}}", begin);
    page += rest.substr(0, begin);
    page += values.at(rest.substr(begin + 2, end - begin - 2));
    rest.remove_prefix(end + 2);
  }
  page += rest;
  return page;
}

}  // namespace graphdrl
