#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>
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

// A walk over edges: `nodes`, with the edges between them as the document says, else the likeliest ones.
EdgeWalk edge_walk(const World& world, std::vector<NodeId> nodes, const nlohmann::json& document,
                   std::optional<double> reset_cost, const std::string& file) {
  const Multigraph all = all_edges(world);
  const auto leads_back = [&](std::int64_t edge) {
    return !world.open().directed() || all.leads_back(static_cast<std::size_t>(edge));
  };
  const auto joins = [&](std::int64_t edge, NodeId from, NodeId to) {
    const Edge& one = all.edges[static_cast<std::size_t>(edge)];
    return (one.a == from && one.b == to) || (leads_back(edge) && one.a == to && one.b == from);
  };
  std::map<std::pair<NodeId, NodeId>, std::vector<std::int64_t>> between;  // cheapest first
  for (std::size_t i = 0; i < all.edges.size(); ++i) {
    const auto& [a, b, cost] = all.edges[i];
    if (world.is_blocked(a) || world.is_blocked(b)) continue;
    between[{a, b}].push_back(static_cast<std::int64_t>(i));
    if (leads_back(static_cast<std::int64_t>(i)) && a != b) between[{b, a}].push_back(static_cast<std::int64_t>(i));
  }
  const auto cost_of = [&](std::int64_t edge) { return all.edges[static_cast<std::size_t>(edge)].cost; };
  for (auto& [ends, edges] : between) std::ranges::stable_sort(edges, {}, cost_of);
  const auto said = document.is_object() ? document.find("walk_edges") : document.end();
  const bool says = said != document.end() && said->is_array() && said->size() + 1 == nodes.size();
  if (document.is_object() && said != document.end() && !says) {
    throw Error({.what = "bad walk_edges", .expected = "one for each step", .got = shortened(*said), .where = file});
  }
  std::vector<bool> walked(all.edges.size());
  EdgeWalk walk{.nodes = std::move(nodes)};
  for (std::size_t i = 1; i < walk.nodes.size(); ++i) {
    const NodeId from = walk.nodes[i - 1];
    const NodeId to = walk.nodes[i];
    std::int64_t edge = EdgeWalk::kResetEdge;
    const auto refuse = [&](const std::string& what) {
      throw Error(
          {.what = fmt::format("not a walk: {} from node {} to node {}, step {}", what, from, to, i), .where = file});
    };
    if (says && !(*said)[i - 1].is_null()) {
      const nlohmann::json& number = (*said)[i - 1];
      const bool good = number.is_number_unsigned() && number.get<std::uint64_t>() < all.edges.size() &&
                        joins(number.get<std::int64_t>(), from, to);
      if (!good) refuse(fmt::format("edge {} does not lead", shortened(number)));
      edge = number.get<std::int64_t>();
    } else if (const auto found = between.find({from, to}); !says && found != between.end()) {
      const auto fresh = std::ranges::find_if(found->second, [&](std::int64_t one) { return !walked[one]; });
      edge = fresh != found->second.end() ? *fresh : found->second.front();
    }
    if (edge == EdgeWalk::kResetEdge) {
      if (!reset_cost || to != walk.nodes.front()) refuse("no edge leads");
      walk.cost += *reset_cost;
    } else {
      walked[edge] = true;
      walk.cost += cost_of(edge);
    }
    walk.edges.push_back(edge);
  }
  return walk;
}

// What it says of the plan.
void read_claims(const World& world, const nlohmann::json& document, Answer& answer) {
  if (const auto policy = document.find("policy"); policy != document.end() && policy->is_string()) {
    answer.policy = *policy;
  }
  if (answer.edges) {
    const char* const bound = answer.edges->has_prizes ? "max_edge_prize" : "max_edges";
    answer.edges->bound = number_at(document, bound).value_or(answer.edges->bound);
    return;
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
  std::vector<std::int64_t> after_step = numbers(*counts, "seen_after_step");
  if (answer.edges && after_step.size() == answer.edges->walk.nodes.size()) {  // with loops
    const std::vector<NodeId>& walk = answer.edges->walk.nodes;
    std::size_t kept = 1;
    for (std::size_t i = 1; i < walk.size(); ++i) {
      if (walk[i] != walk[i - 1]) after_step[kept++] = after_step[i];
    }
    after_step.resize(kept);
  }
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

Answer read_plan(const World& world, const std::string& file, const AskedOfPlan& asked) {
  return parse_plan(world, read_file(file), file, asked);
}

Answer parse_plan(const World& world, const std::string& text, const std::string& file, const AskedOfPlan& asked) {
  const std::size_t begin = text.find_first_not_of(" \t\r\n");
  const bool is_json = begin != std::string::npos && (text[begin] == '{' || text[begin] == '[');
  const nlohmann::json document = is_json ? parse_json(text, file) : nlohmann::json();
  std::vector<NodeId> walk = is_json ? walk_of_json(world, document, file) : walk_of_lines(world, text, file);
  if (walk.empty()) throw Error({.what = "the walk is empty", .expected = "at least a start", .where = file});
  const NodeId start = walk.front();
  const End end = asked.task.end.value_or(end_in(document, world, file).value_or(End::anywhere()));
  // within: what it costs.
  const auto task = [&](double within) {
    try {
      const Budget said(number_at(document, "budget").value_or(within));
      return Task(world, {.budget = asked.task.budget.value_or(said), .start = start, .end = end});
    } catch (const Error& error) {
      throw Error({.what = error.what(), .where = file});
    }
  };
  const auto answered = [&] {
    const bool says_edges = document.is_object() && document.value("cover", nlohmann::json()) == "edges";
    if (asked.cover.value_or(says_edges ? Cover::kEdges : Cover::kNodes) == Cover::kEdges) {
      const auto reset_cost = asked.reset_cost ? asked.reset_cost : number_at(document, "reset_cost");
      if (reset_cost && !world.open().directed()) {
        throw Error({.what = "resets go with edges that lead one way", .where = file});
      }
      if (reset_cost && !(*reset_cost >= 0)) {
        throw Error(
            {.what = "bad reset_cost", .expected = "a number from 0 up", .got = decimal(*reset_cost), .where = file});
      }
      EdgeWalk edges = edge_walk(world, std::move(walk), document, reset_cost, file);
      const Task within = task(edges.cost);
      return edge_answer(world, within, judge_edges(world, within, reset_cost, std::move(edges)), file);
    }
    if (asked.reset_cost) throw Error({.what = "resets go with --cover edges"});
    check_steps(world, walk, file);
    Plan plan = plan_of_walk(Task(world, start, kNoLimit), std::move(walk));
    Task within = task(plan.cost);
    return Answer{.world = world, .task = std::move(within), .policy = file, .plan = std::move(plan)};
  };
  Answer answer = answered();
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
