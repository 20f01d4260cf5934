#include "graphdrl/report/plan_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <boost/algorithm/string/replace.hpp>
#include <cmath>
#include <nlohmann/json.hpp>

#include "graphdrl/base/error.h"
#include "graphdrl/io/file.h"
#include "graphdrl/io/file_check.h"
#include "graphdrl/io/readers.h"
#include "graphdrl/report/picture.h"
#include "graphdrl/report/report_page.h"

namespace graphdrl {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::int64_t kMostEdges = 10'000'000;  // written to a file
constexpr int kLongestTitle = 60;

bool has_coordinates(const World& world) {
  return world.has_places() && !(world.has_cells() && !world.map()->frame);
}

// The document on one line.
std::string dumped(const Json& document) {
  return document.dump(-1, ' ', false, Json::error_handler_t::replace) + '\n';
}

std::string plan_csv(const Answer& answer) {
  const World& world = answer.world;
  const bool labels = !world.labels().empty();
  const bool cells = world.has_cells();
  const bool places = has_coordinates(world);
  std::string text = "step,node";
  if (labels) text += ",label";
  if (cells) text += ",row,column";
  if (places) text += ",x,y";
  text += ",cost,visited\n";
  const std::vector<double> costs = costs_so_far(answer);
  std::vector<bool> seen(world.node_count());
  int visited = 0;
  for (std::size_t step = 0; step < answer.plan.walk.size(); ++step) {
    const NodeId node = answer.plan.walk[step];
    if (!seen[node]) ++visited;
    seen[node] = true;
    text += fmt::format("{},{}", step, node);
    if (labels) text += fmt::format(",{}", csv_field(world.labels()[node]));
    if (cells) text += fmt::format(",{},{}", world.map()->cell(node).row, world.map()->cell(node).col);
    if (places) text += fmt::format(",{},{}", world.place(node).x, world.place(node).y);
    text += fmt::format(",{},{}\n", costs[step], visited);
  }
  return text;
}

// The graph, and the step at which each node was first visited, empty if never.
std::string plan_graph(const Answer& answer, std::string (*format)(const GraphMap&, const NodeColumn&)) {
  const World& world = answer.world;
  if (world.graph().edge_count() > kMostEdges) {
    throw Error({.what = "a graph with too many edges for this format",
                 .expected = fmt::format("at most {}", kMostEdges),
                 .got = std::to_string(world.graph().edge_count()),
                 .where = world.name()});
  }
  std::vector<std::string> order;
  for (const int step : first_visits(world, answer.plan.walk)) order.push_back(step < 0 ? "" : std::to_string(step));
  return format(world.to_map(), {.name = "visit_order", .values = std::move(order)});
}

// A line, and a point for every valid node [RFC 7946].
std::string plan_geojson(const Answer& answer) {
  const World& world = answer.world;
  const auto position = [&](NodeId node) { return Json::array({world.place(node).x, world.place(node).y}); };
  Json line = Json::array();
  for (const NodeId node : answer.plan.walk) line.push_back(position(node));
  if (line.size() == 1) line.push_back(line[0]);  // a line has two positions
  Json features = Json::array();
  features.push_back({{"type", "Feature"},
                      {"geometry", {{"type", "LineString"}, {"coordinates", line}}},
                      {"properties",
                       {{"policy", answer.policy},
                        {"visited", answer.plan.visited},
                        {"cost", answer.plan.cost},
                        {"budget", answer.task.budget()}}}});
  const std::vector<int> order = first_visits(world, answer.plan.walk);
  for (const NodeId node : world.valid_nodes()) {
    features.push_back({{"type", "Feature"},
                        {"geometry", {{"type", "Point"}, {"coordinates", position(node)}}},
                        {"properties",
                         {{"node", node},
                          {"label", world.labels().empty() ? std::to_string(node) : world.labels()[node]},
                          {"visit_order", order[node] < 0 ? Json() : Json(order[node])}}}});
  }
  return dumped({{"type", "FeatureCollection"}, {"features", features}});
}

// A message nav_msgs/Path [docs.ros.org], as `rostopic pub -f` and `ros2 topic pub` take it. Every pose faces the
// next one.
std::string plan_ros_path(const Answer& answer) {
  std::string text = "header:\n  frame_id: map\nposes:\n";
  const std::vector<NodeId>& walk = answer.plan.walk;
  double heading = 0;
  for (std::size_t i = 0; i < walk.size(); ++i) {
    const Point at = answer.world.place(walk[i]);
    if (i + 1 < walk.size() && walk[i + 1] != walk[i]) {
      const Point next = answer.world.place(walk[i + 1]);
      heading = std::atan2(next.y - at.y, next.x - at.x);
    }
    text += fmt::format(
        "  - header: {{frame_id: map}}\n    pose:\n      position: {{x: {}, y: {}, z: 0.0}}\n      orientation: {{x: "
        "0.0, y: 0.0, "
        "z: {}, w: {}}}\n",
        at.x, at.y, std::sin(heading / 2), std::cos(heading / 2));
  }
  return text;
}

std::string title_of(const Answer& answer) {
  return fmt::format("{}, {}", answer.world.name().substr(0, kLongestTitle), answer.policy);
}

Picture picture_of(const Answer& answer) {
  return Picture(answer.world, answer.plan.walk, title_of(answer), plan_summary(answer), Fog(answer));
}

std::string plan_html(const Answer& answer) {
  ReportPage page(title_of(answer));
  page.add_plan(answer);
  return page.html();
}

struct PlanFormat {
  std::string_view ending;
  std::string (*format)(const Answer& answer);
  bool needs_coordinates = false;
};

// A longer ending stands before a shorter one that it ends with.
constexpr std::array kFormats = {
    PlanFormat{".json", [](const Answer& answer) { return dumped(plan_json(answer)); }},
    PlanFormat{".csv", plan_csv},
    PlanFormat{".graphml", [](const Answer& answer) { return plan_graph(answer, format_graphml); }},
    PlanFormat{".dot", [](const Answer& answer) { return plan_graph(answer, format_dot); }},
    PlanFormat{".geojson", plan_geojson, true},
    PlanFormat{".yaml", plan_ros_path, true},
    PlanFormat{".anim.svg", [](const Answer& answer) { return picture_of(answer).moving_svg(); }},
    PlanFormat{".svg", [](const Answer& answer) { return picture_of(answer).svg(); }},
    PlanFormat{".png", [](const Answer& answer) { return picture_of(answer).png(); }},
    PlanFormat{".html", plan_html},
};

const PlanFormat& format_for(const std::string& file) {
  const auto* const format =
      std::find_if(kFormats.begin(), kFormats.end(), [&](const PlanFormat& one) { return file.ends_with(one.ending); });
  if (format != kFormats.end()) return *format;
  throw Error(
      {.what = "no plan is written in a file with this ending", .expected = plan_file_endings(), .where = file});
}

}  // namespace

std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  return '"' + boost::replace_all_copy(text, "\"", "\"\"") + '"';
}

std::string format_walk(const World& world, std::span<const NodeId> walk) {
  const bool labels = !world.labels().empty();
  std::string text = labels ? "node,label\n" : "node\n";
  for (const NodeId node : walk) {
    text += labels ? fmt::format("{},{}\n", node, csv_field(escaped(world.labels()[node]))) : fmt::format("{}\n", node);
  }
  return text;
}

namespace {

// By the time the walk leaves each node of the plan's walk, which has no loops.
std::vector<double> costs_over_edges(const World& world, const EdgeWalk& walk, double reset_cost) {
  const Multigraph all = all_edges(world);
  std::vector<double> costs = {0};
  for (std::size_t i = 0; i < walk.edges.size(); ++i) {
    const std::int64_t edge = walk.edges[i];
    const double cost = edge == EdgeWalk::kResetEdge ? reset_cost : all.edges[static_cast<std::size_t>(edge)].cost;
    if (walk.nodes[i] != walk.nodes[i + 1]) costs.push_back(costs.back());
    costs.back() += cost;
  }
  return costs;
}

// How many nodes were seen at each step of a walk over edges, loops among them, which show nothing.
std::vector<int> seen_with_loops(const Answer& answer) {
  const std::vector<NodeId>& walk = answer.edges->walk.nodes;
  std::vector<int> seen;
  std::size_t at = 0;
  for (std::size_t i = 0; i < walk.size(); ++i) {
    if (i > 0 && walk[i] != walk[i - 1]) ++at;
    seen.push_back(answer.discovered.after_step[at]);
  }
  return seen;
}

// What a walk over edges has beside its nodes.
void add_edges(const Answer& answer, nlohmann::ordered_json& json) {
  const EdgeCover& edges = *answer.edges;
  const Multigraph* const all = answer.world.multigraph();
  const bool labelled = all != nullptr && !all->labels.empty();
  json["cover"] = "edges";
  if (edges.reset_cost) json["reset_cost"] = *edges.reset_cost;
  Json& numbers = json["walk_edges"] = Json::array();
  Json labels = Json::array();
  for (const std::int64_t edge : edges.walk.edges) {
    const bool reset = edge == EdgeWalk::kResetEdge;
    numbers.push_back(reset ? Json() : Json(edge));
    labels.push_back(reset || !labelled ? Json() : Json(all->labels[static_cast<std::size_t>(edge)]));
  }
  if (labelled) json["walk_edge_labels"] = std::move(labels);
  json["edges_walked"] = edges.walked;
  json["edges"] = edges.edges;
  json["upper_bound"] = edges.percent(edges.bound);
  if (edges.has_prizes) {
    json["edge_prize"] = edges.prize;
    json["max_edge_prize"] = edges.bound;
  } else {
    json["max_edges"] = static_cast<std::int64_t>(edges.bound);
  }
  json["gap"] = edges.percent(edges.bound - edges.prize);
  if (edges.least_cost > 0) json["least_cost"] = edges.least_cost;
  json["optimal"] = edges.optimal();
}

// How the map became known, and what one gets that knows it.
void add_discovery(const Answer& answer, nlohmann::ordered_json& json) {
  if (!answer.reveal.all()) {
    json["reveal"] = answer.reveal.text();
    json["score"] = answer.score == Score::kSeen ? "seen" : "visited";
    json["seen"] = answer.discovered.nodes.size();
    json["seen_nodes"] = answer.discovered.nodes;
    json["seen_after_step"] = answer.edges ? seen_with_loops(answer) : answer.discovered.after_step;
    if (!answer.task.ends_anywhere()) json["no_way_back"] = answer.discovered.no_way_back;
  }
  if (answer.known) {
    json["known"] = {{"visited", answer.known->visited}, {"prize", answer.known->prize}, {"cost", answer.known->cost}};
    if (answer.edges) {
      const char* const worth = answer.edges->has_prizes ? "edge_prize" : "edges_walked";
      json["known"] = {{worth, answer.known->prize}, {"cost", answer.known->cost}};
    }
    const auto price = answer.price_of_ignorance();
    json["price_of_ignorance"] = price ? Json(*price) : Json();
  }
}

}  // namespace

std::vector<double> costs_so_far(const Answer& answer) {
  if (answer.edges) return costs_over_edges(answer.world, answer.edges->walk, answer.edges->reset_cost.value_or(0));
  const Graph& open = answer.world.open();
  std::vector<double> costs = {0};
  const std::vector<NodeId>& walk = answer.plan.walk;
  for (std::size_t i = 1; i < walk.size(); ++i) {
    const double step = walk[i] == walk[i - 1] ? 1 : open.cost(walk[i - 1], open.index_of(walk[i - 1], walk[i]));
    costs.push_back(costs.back() + step);
  }
  return costs;
}

nlohmann::ordered_json plan_json(const Answer& answer) {
  const World& world = answer.world;
  const Plan& plan = answer.plan;
  Json json;
  json["map"] = world.name();
  json["policy"] = answer.policy;
  json["start"] = plan.walk.front();
  json["end"] = answer.task.ends_anywhere() ? Json() : Json(answer.task.end());
  json["budget"] = answer.task.budget();
  const std::vector<NodeId>& walk = answer.edges ? answer.edges->walk.nodes : plan.walk;
  json["walk"] = walk;
  const auto add_steps = [&](const char* key, const auto& value_at) {
    Json& values = json[key] = Json::array();
    for (const NodeId node : walk) values.push_back(value_at(node));
  };
  if (world.has_cells()) {
    add_steps("walk_cells", [&](NodeId node) {
      const Cell cell = world.map()->cell(node);
      return Json{cell.row, cell.col};
    });
  }
  if (!world.labels().empty()) add_steps("walk_labels", [&](NodeId node) { return world.labels()[node]; });
  if (has_coordinates(world)) {
    add_steps("walk_places", [&](NodeId node) { return Json{world.place(node).x, world.place(node).y}; });
    json["unit"] = world.unit();
  }
  json["visited"] = plan.visited;
  json["coverage"] = 100.0 * plan.visited / world.valid_count();
  if (world.has_prizes()) json["prize"] = plan.prize;
  json["cost"] = plan.cost;
  add_discovery(answer, json);
  if (answer.edges) {
    add_edges(answer, json);
    json["unreachable"] = answer.unreachable;
    json["elapsed_s"] = answer.elapsed_s;
    return json;
  }
  json["upper_bound"] = world.percent_of_all(plan.bound);
  if (world.has_prizes()) {
    json["max_prize"] = plan.bound;
  } else {
    json["max_visited"] = answer.max_visited();
  }
  json["gap"] = world.percent_of_all(plan.bound) - world.percent_of_all(plan.prize);
  json["optimal"] = plan.optimal;
  json["unreachable"] = answer.unreachable;
  json["elapsed_s"] = answer.elapsed_s;
  return json;
}

std::string plan_file_endings() {
  std::string text;
  for (const PlanFormat& format : kFormats) text += fmt::format("{}{}", text.empty() ? "" : ", ", format.ending);
  return text;
}

void check_plan_file(const std::string& file) {
  format_for(file);
  check_writable(file);
}

void check_plan_file(const World& world, const std::string& file) {
  check_plan_file(file);
  const PlanFormat& format = format_for(file);
  if (!format.needs_coordinates || has_coordinates(world)) return;
  throw Error({.what = fmt::format("{} needs coordinates, and the map has none", format.ending), .where = file});
}

void write_plan(const Answer& answer, const std::string& file) {
  check_plan_file(answer.world, file);
  write_file(file, format_for(file).format(answer));
}

}  // namespace graphdrl
