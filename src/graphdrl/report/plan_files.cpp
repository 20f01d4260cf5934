#include "graphdrl/report/plan_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "graphdrl/base/error.h"
#include "graphdrl/io/file.h"
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

std::string label_of(const World& world, NodeId node) {
  return world.labels().empty() ? std::to_string(node) : world.labels()[node];
}

// The step at which each node was first visited; empty if never.
std::vector<std::string> visit_order(const Answer& report) {
  std::vector<std::string> order(report.world.node_count());
  const std::vector<NodeId>& walk = report.plan.walk;
  for (std::size_t step = 0; step < walk.size(); ++step) {
    if (order[walk[step]].empty()) order[walk[step]] = std::to_string(step);
  }
  return order;
}

// A field of CSV [RFC 4180].
std::string csv(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  return quoted + '"';
}

std::string plan_csv(const Answer& report) {
  const World& world = report.world;
  const bool labels = !world.labels().empty();
  const bool cells = world.has_cells();
  const bool places = has_coordinates(world);
  std::string text = "step,node";
  if (labels) text += ",label";
  if (cells) text += ",row,column";
  if (places) text += ",x,y";
  text += ",cost,visited\n";
  const std::vector<double> costs = costs_so_far(report);
  std::vector<bool> seen(world.node_count());
  int visited = 0;
  for (std::size_t step = 0; step < report.plan.walk.size(); ++step) {
    const NodeId node = report.plan.walk[step];
    if (!seen[node]) ++visited;
    seen[node] = true;
    text += fmt::format("{},{}", step, node);
    if (labels) text += fmt::format(",{}", csv(world.labels()[node]));
    if (cells) text += fmt::format(",{},{}", world.map()->cell(node).row, world.map()->cell(node).col);
    if (places) text += fmt::format(",{},{}", world.place(node).x, world.place(node).y);
    text += fmt::format(",{},{}\n", costs[step], visited);
  }
  return text;
}

}  // namespace

std::string format_walk(const World& world, std::span<const NodeId> walk) {
  const bool labels = !world.labels().empty();
  std::string text = labels ? "node,label\n" : "node\n";
  for (const NodeId node : walk) {
    text += labels ? fmt::format("{},{}\n", node, csv(escaped(world.labels()[node]))) : fmt::format("{}\n", node);
  }
  return text;
}

namespace {

GraphMap graph_of(const World& world) {
  if (world.graph().edge_count() > kMostEdges) {
    throw Error({.what = "a graph with too many edges for this format",
                 .expected = fmt::format("at most {}", kMostEdges),
                 .got = std::to_string(world.graph().edge_count()),
                 .where = world.name()});
  }
  return world.to_map();
}

std::string plan_graphml(const Answer& report) {
  return format_graphml(graph_of(report.world), {.name = "visit_order", .values = visit_order(report)});
}

std::string plan_dot(const Answer& report) {
  return format_dot(graph_of(report.world), {.name = "visit_order", .values = visit_order(report)});
}

// A line, and a point for every valid node [RFC 7946].
std::string plan_geojson(const Answer& report) {
  const World& world = report.world;
  const auto position = [&](NodeId node) { return Json::array({world.place(node).x, world.place(node).y}); };
  Json line = Json::array();
  for (const NodeId node : report.plan.walk) line.push_back(position(node));
  if (line.size() == 1) line.push_back(line[0]);  // a line has two positions
  Json features = Json::array();
  features.push_back({{"type", "Feature"},
                      {"geometry", {{"type", "LineString"}, {"coordinates", line}}},
                      {"properties",
                       {{"policy", report.policy},
                        {"visited", report.plan.visited},
                        {"cost", report.plan.cost},
                        {"budget", report.task.budget()}}}});
  const std::vector<std::string> order = visit_order(report);
  for (const NodeId node : world.valid_nodes()) {
    features.push_back({{"type", "Feature"},
                        {"geometry", {{"type", "Point"}, {"coordinates", position(node)}}},
                        {"properties",
                         {{"node", node},
                          {"label", label_of(world, node)},
                          {"visit_order", order[node].empty() ? Json() : Json(std::stoi(order[node]))}}}});
  }
  const Json document = {{"type", "FeatureCollection"}, {"features", features}};
  return document.dump(-1, ' ', false, Json::error_handler_t::replace) + '\n';
}

// A message nav_msgs/Path [docs.ros.org], as `rostopic pub -f` and `ros2 topic pub` take it. Every pose faces the
// next one.
std::string plan_ros_path(const Answer& report) {
  std::string text = "header:\n  frame_id: map\nposes:\n";
  const std::vector<NodeId>& walk = report.plan.walk;
  double heading = 0;
  for (std::size_t i = 0; i < walk.size(); ++i) {
    const Point at = report.world.place(walk[i]);
    if (i + 1 < walk.size() && walk[i + 1] != walk[i]) {
      const Point next = report.world.place(walk[i + 1]);
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

std::string title_of(const Answer& report) {
  return fmt::format("{}, {}", report.world.name().substr(0, kLongestTitle), report.policy);
}

Picture picture_of(const Answer& report) {
  return Picture(report.world, report.plan.walk, title_of(report), plan_summary(report));
}

std::string plan_svg(const Answer& report) {
  return picture_of(report).svg();
}

std::string plan_moving_svg(const Answer& report) {
  return picture_of(report).moving_svg();
}

std::string plan_png(const Answer& report) {
  return picture_of(report).png();
}

std::string plan_html(const Answer& report) {
  ReportPage page(title_of(report));
  page.add_plan(report);
  return page.html();
}

std::string plan_json_text(const Answer& report) {
  return plan_json(report).dump(-1, ' ', false, Json::error_handler_t::replace) + '\n';
}

struct PlanFormat {
  std::string_view ending;
  std::string (*format)(const Answer& report);
  bool needs_coordinates = false;
};

// A longer ending stands before a shorter one that it ends with.
constexpr std::array kFormats = {
    PlanFormat{".json", plan_json_text},
    PlanFormat{".csv", plan_csv},
    PlanFormat{".graphml", plan_graphml},
    PlanFormat{".dot", plan_dot},
    PlanFormat{".geojson", plan_geojson, true},
    PlanFormat{".yaml", plan_ros_path, true},
    PlanFormat{".anim.svg", plan_moving_svg},
    PlanFormat{".svg", plan_svg},
    PlanFormat{".png", plan_png},
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

std::vector<double> costs_so_far(const Answer& report) {
  const Graph& open = report.world.open();
  std::vector<double> costs = {0};
  const std::vector<NodeId>& walk = report.plan.walk;
  for (std::size_t i = 1; i < walk.size(); ++i) {
    const double step = walk[i] == walk[i - 1] ? 1 : open.cost(walk[i - 1], open.index_of(walk[i - 1], walk[i]));
    costs.push_back(costs.back() + step);
  }
  return costs;
}

nlohmann::ordered_json plan_json(const Answer& report) {
  const World& world = report.world;
  const Plan& plan = report.plan;
  Json json;
  json["map"] = world.name();
  json["policy"] = report.policy;
  json["start"] = plan.walk.front();
  json["end"] = report.task.ends_anywhere() ? Json() : Json(report.task.end());
  json["budget"] = report.task.budget();
  json["walk"] = plan.walk;
  if (world.has_cells()) {
    json["walk_cells"] = Json::array();
    for (const NodeId node : plan.walk) {
      const Cell cell = world.map()->cell(node);
      json["walk_cells"].push_back({cell.row, cell.col});
    }
  }
  if (!world.labels().empty()) {
    json["walk_labels"] = Json::array();
    for (const NodeId node : plan.walk) json["walk_labels"].push_back(world.labels()[node]);
  }
  if (has_coordinates(world)) {
    json["walk_places"] = Json::array();
    for (const NodeId node : plan.walk) json["walk_places"].push_back({world.place(node).x, world.place(node).y});
    json["unit"] = world.unit();
  }
  json["visited"] = plan.visited;
  json["coverage"] = 100.0 * plan.visited / world.valid_count();
  if (world.has_prizes()) json["prize"] = plan.prize;
  json["cost"] = plan.cost;
  json["upper_bound"] = world.percent_of_all(plan.bound);
  if (world.has_prizes()) {
    json["max_prize"] = plan.bound;
  } else {
    json["max_visited"] = report.max_visited();
  }
  json["gap"] = world.percent_of_all(plan.bound) - world.percent_of_all(plan.prize);
  json["optimal"] = plan.optimal;
  json["unreachable"] = report.unreachable;
  json["elapsed_s"] = report.elapsed_s;
  return json;
}

std::string plan_file_endings() {
  std::string text;
  for (const PlanFormat& format : kFormats) text += fmt::format("{}{}", text.empty() ? "" : ", ", format.ending);
  return text;
}

void check_plan_file(const World& world, const std::string& file) {
  const PlanFormat& format = format_for(file);
  if (!format.needs_coordinates || has_coordinates(world)) return;
  throw Error({.what = fmt::format("{} needs coordinates, and the map has none", format.ending), .where = file});
}

void write_plan(const Answer& report, const std::string& file) {
  check_plan_file(report.world, file);
  write_file(file, format_for(file).format(report));
}

}  // namespace graphdrl
