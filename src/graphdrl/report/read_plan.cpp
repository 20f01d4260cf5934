#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <span>

#include "graphdrl/base/error.h"
#include "graphdrl/env/load_worlds.h"
#include "graphdrl/env/task.h"
#include "graphdrl/io/file.h"
#include "graphdrl/io/json.h"
#include "graphdrl/io/text.h"
#include "graphdrl/report/plan_files.h"

namespace graphdrl {
namespace {

std::vector<NodeId> walk_of_json(const World& world, const nlohmann::json& document, const std::string& file) {
  const nlohmann::json& walk = document.is_object() && document.contains("walk") ? document["walk"] : document;
  if (!walk.is_array())
    throw Error({.what = "no walk", .expected = "an array, or one under the key \"walk\"", .where = file});
  std::vector<NodeId> nodes;
  for (const nlohmann::json& item : walk) {
    // A number is a node id; a text names a node as users do.
    const std::string name = item.is_number_integer() ? fmt::format("#{}", item.dump())
                             : item.is_string()       ? item.get<std::string>()
                                                      : "";
    if (name.empty()) {
      throw Error({.what = "not a node", .expected = "a node id or a label", .got = shortened(item), .where = file});
    }
    nodes.push_back(parse_node(world, name, fmt::format("{}: step {}", file, nodes.size())));
  }
  return nodes;
}

struct Row {
  std::string where;
  std::vector<std::string> fields;
};

std::vector<Row> rows_of(const std::string& text, const std::string& file, char& separator) {
  std::vector<Row> rows;
  for (Lines lines(text); lines.next();) {
    if (is_comment(lines.line())) continue;
    if (rows.empty()) separator = separator_of(lines.line());
    rows.push_back({fmt::format("{}:{}", file, lines.number()), split_fields(lines.line(), separator)});
  }
  return rows;
}

std::vector<NodeId> walk_of_lines(const World& world, const std::string& text, const std::string& file) {
  char separator = ' ';
  const std::vector<Row> rows = rows_of(text, file, separator);
  if (rows.empty()) return {};
  const std::vector<std::string>& header = rows[0].fields;
  const std::array<std::string_view, 2> id_names = {"node", "id"};
  const std::array<std::string_view, 1> label_names = {"label"};
  const int id_column = column_of(header, id_names);
  const int label_column = column_of(header, label_names);
  const bool ids = id_column != kNoColumn;
  const bool has_header = ids || label_column != kNoColumn;
  const int column = ids ? id_column : std::max(label_column, 0);
  std::vector<NodeId> nodes;
  const auto add = [&](const std::string& name, const std::string& where) {
    nodes.push_back(parse_node(world, ids && parse_number(name) ? fmt::format("#{}", name) : name, where + ": node"));
  };
  if (!has_header && rows.size() == 1) {
    for (const std::string& name : header) add(name, rows[0].where);
    return nodes;
  }
  for (const Row& row : std::span(rows).subspan(has_header ? 1 : 0)) {
    const bool open = !has_header && separator == ' ' && row.fields.size() > 1;
    if (open || std::ssize(row.fields) <= column) {
      throw Error({.what = open ? "several words a line, and no header says which is the node" : "no node",
                   .expected = "a node a line, or all nodes on one line",
                   .got = in_quotes(fmt::format("{}", fmt::join(row.fields, " "))),
                   .where = row.where});
    }
    add(row.fields[column], row.where);
  }
  return nodes;
}

// Throws Error if a step of the walk follows no edge.
void check_steps(const World& world, const std::vector<NodeId>& walk, const std::string& file) {
  const auto name = [&](NodeId node) {
    return world.labels().empty() ? fmt::format("node {}", node) : in_quotes(world.labels()[node]);
  };
  for (std::size_t i = 1; i < walk.size(); ++i) {
    const bool stays = walk[i] == walk[i - 1] && world.is_grid();  // a blocked move
    if (stays || world.open().index_of(walk[i - 1], walk[i]) >= 0) continue;
    throw Error(
        {.what = fmt::format("not a walk: no edge leads from {} to {}, step {}", name(walk[i - 1]), name(walk[i]), i),
         .where = file});
  }
}

std::optional<double> number_at(const nlohmann::json& document, const char* key) {
  const auto item = document.find(key);
  if (item == document.end() || !item->is_number()) return std::nullopt;
  return item->get<double>();
}

// What a document says of the task.
Asked read_task(const World& world, const nlohmann::json& document, const std::string& file) {
  Asked asked;
  if (const auto budget = number_at(document, "budget")) asked.budget = Budget(*budget);
  if (const auto end = document.find("end"); end != document.end() && end->is_number_integer()) {
    asked.end = End::at(parse_node(world, fmt::format("#{}", end->dump()), file + ": end"));
  }
  return asked;
}

// What it says of the plan.
void read_claims(const World& world, const nlohmann::json& document, Answer& report) {
  if (const auto policy = document.find("policy"); policy != document.end() && policy->is_string()) {
    report.policy = *policy;
  }
  if (const auto bound = number_at(document, "upper_bound")) report.plan.bound = *bound / 100 * world.total_prize();
  if (!world.has_prizes()) report.plan.bound = std::round(report.plan.bound);
  report.plan.optimal = document.value("optimal", nlohmann::json()) == true;
}

}  // namespace

Answer read_plan(const World& world, const std::string& file, const Asked& asked) {
  return parse_plan(world, read_file(file), file, asked);
}

Answer parse_plan(const World& world, const std::string& text, const std::string& file, const Asked& asked) {
  const std::size_t begin = text.find_first_not_of(" \t\r\n");
  const bool is_json = begin != std::string::npos && (text[begin] == '{' || text[begin] == '[');
  const nlohmann::json document = is_json ? parse_json(text, file) : nlohmann::json();
  std::vector<NodeId> walk = is_json ? walk_of_json(world, document, file) : walk_of_lines(world, text, file);
  if (walk.empty()) throw Error({.what = "the walk is empty", .expected = "at least a start", .where = file});
  check_steps(world, walk, file);
  const Task any(world, walk.front(), kNoLimit);
  Plan plan = plan_of_walk(any, std::move(walk));
  const Asked said = document.is_object() ? read_task(world, document, file) : Asked();
  const auto end = asked.end ? asked.end : said.end;
  const auto budget = asked.budget ? asked.budget : said.budget;
  const Task task(
      world,
      {.budget = budget.value_or(Budget(plan.cost)), .start = plan.walk.front(), .end = end.value_or(End::anywhere())});
  Answer report{.world = world, .task = task, .policy = file, .plan = std::move(plan)};
  if (document.is_object()) read_claims(world, document, report);
  return report;
}

void check_walk(const Answer& report, const std::string& file) {
  const Task& task = report.task;
  if (report.plan.cost > task.limit()) {
    throw Error({.what = "the walk costs more than the budget",
                 .expected = "at most " + decimal(task.budget()),
                 .got = decimal(report.plan.cost),
                 .where = file});
  }
  if (!task.ends_anywhere() && report.plan.walk.back() != task.end()) {
    throw Error({.what = "the walk ends elsewhere",
                 .expected = fmt::format("node {}", task.end()),
                 .got = fmt::format("node {}", report.plan.walk.back()),
                 .where = file});
  }
}

}  // namespace graphdrl
