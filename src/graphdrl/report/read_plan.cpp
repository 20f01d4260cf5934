#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
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
    const std::string role = fmt::format("{}: step {}", file, nodes.size());
    if (item.is_number_integer()) {
      nodes.push_back(checked_node(world, item.get<std::int64_t>(), role));
    } else if (item.is_string()) {
      nodes.push_back(parse_node(world, item.get<std::string>(), role));
    } else {
      throw Error({.what = "not a node", .expected = "a node id or a label", .got = shortened(item), .where = file});
    }
  }
  return nodes;
}

struct Row {
  std::string where;
  std::vector<std::string> fields;
};

// A node's id: "5"; empty where the text is no whole number.
std::optional<std::int64_t> parse_id(std::string_view text) {
  std::int64_t id = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), id);
  return error == std::errc() && end == text.data() + text.size() ? std::optional(id) : std::nullopt;
}

// Whether a line that looks like a comment names nodes: "#5", or labels that begin so.
bool names_nodes(const World& world, std::string_view line) {
  const std::vector<std::string> names = split_fields(line, separator_of(line));
  return !names.empty() && std::all_of(names.begin(), names.end(), [&](const std::string& name) {
    const auto& labels = world.labels();
    return (name.starts_with('#') && parse_id(std::string_view(name).substr(1))) ||
           std::find(labels.begin(), labels.end(), name) != labels.end();
  });
}

std::vector<Row> rows_of(const World& world, const std::string& text, const std::string& file, char& separator) {
  std::vector<Row> rows;
  for (Lines lines(text); lines.next();) {
    if (is_comment(lines.line()) && !names_nodes(world, lines.line())) continue;
    if (rows.empty()) separator = separator_of(lines.line());
    rows.push_back({fmt::format("{}:{}", file, lines.number()), split_fields(lines.line(), separator)});
  }
  return rows;
}

std::vector<NodeId> walk_of_lines(const World& world, const std::string& text, const std::string& file) {
  char separator = ' ';
  const std::vector<Row> rows = rows_of(world, text, file, separator);
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
    const auto id = ids ? parse_id(name) : std::nullopt;
    nodes.push_back(id ? checked_node(world, *id, where + ": node") : parse_node(world, name, where + ": node"));
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

// The end that a document states.
std::optional<End> end_in(const nlohmann::json& document, const World& world, const std::string& file) {
  const auto end = document.find("end");
  if (end == document.end() || !end->is_number_integer()) return std::nullopt;
  return End::at(checked_node(world, end->get<std::int64_t>(), file + ": end"));
}

// What it says of the plan.
void read_claims(const World& world, const nlohmann::json& document, Answer& answer) {
  if (const auto policy = document.find("policy"); policy != document.end() && policy->is_string()) {
    answer.policy = *policy;
  }
  if (const auto bound = number_at(document, "upper_bound")) answer.plan.bound = *bound / 100 * world.total_prize();
  if (!world.has_prizes()) answer.plan.bound = std::round(answer.plan.bound);
  answer.plan.optimal = document.value("optimal", nlohmann::json()) == true;
}

// What it says of a map that was not known beforehand, if it does.
void read_discovery(const World& world, const nlohmann::json& document, const std::string& file, Answer& answer) {
  const auto reveal = document.find("reveal");
  const auto nodes = document.find("seen_nodes");
  const auto counts = document.find("seen_after_step");
  if (reveal == document.end() || nodes == document.end() || counts == document.end()) return;
  const auto numbers = [&](const nlohmann::json& list, const std::string& key) {
    const bool good = list.is_array() && std::ranges::all_of(list, &nlohmann::json::is_number_integer);
    if (good) return list.get<std::vector<std::int64_t>>();
    throw Error({.what = "bad " + key, .expected = "whole numbers", .got = shortened(list), .where = file});
  };
  for (const std::int64_t node : numbers(*nodes, "seen_nodes")) {
    answer.discovered.nodes.push_back(checked_node(world, node, file + ": seen_nodes"));
  }
  if (const auto& list = answer.discovered.nodes; std::ssize(std::set(list.begin(), list.end())) != std::ssize(list)) {
    throw Error({.what = "bad seen_nodes", .expected = "each node once", .got = shortened(*nodes), .where = file});
  }
  const std::vector<std::int64_t> after_step = numbers(*counts, "seen_after_step");
  if (std::ssize(after_step) != std::ssize(answer.plan.walk) || !std::ranges::is_sorted(after_step) ||
      after_step.front() < 1 || after_step.back() != std::ssize(answer.discovered.nodes)) {
    throw Error({.what = "bad seen_after_step",
                 .expected = "for each node of the walk, how many of seen_nodes were seen by then",
                 .got = shortened(*counts),
                 .where = file});
  }
  answer.discovered.after_step.assign(after_step.begin(), after_step.end());
  try {
    answer.reveal = Reveal::parse(reveal->is_string() ? reveal->get<std::string>() : "");
  } catch (const Error& error) {
    throw Error({.what = error.what(), .where = file});
  }
  if (document.value("score", nlohmann::json()) == "seen") answer.score = Score::kSeen;
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
  const End end = asked.end.value_or(end_in(document, world, file).value_or(End::anywhere()));
  const auto task = [&] {
    try {
      const Budget said(number_at(document, "budget").value_or(plan.cost));
      return Task(world, {.budget = asked.budget.value_or(said), .start = plan.walk.front(), .end = end});
    } catch (const Error& error) {
      throw Error({.what = error.what(), .where = file});
    }
  };
  Answer answer{.world = world, .task = task(), .policy = file, .plan = std::move(plan)};
  if (document.is_object()) {
    read_claims(world, document, answer);
    read_discovery(world, document, file, answer);
  }
  return answer;
}

void check_walk(const Answer& answer, const std::string& file) {
  const Task& task = answer.task;
  if (answer.plan.cost > task.limit()) {
    throw Error({.what = "the walk costs more than the budget",
                 .expected = "at most " + decimal(task.budget()),
                 .got = decimal(answer.plan.cost),
                 .where = file});
  }
  if (!task.ends_anywhere() && answer.plan.walk.back() != task.end()) {
    throw Error({.what = "the walk ends elsewhere",
                 .expected = fmt::format("node {}", task.end()),
                 .got = fmt::format("node {}", answer.plan.walk.back()),
                 .where = file});
  }
}

}  // namespace graphdrl
