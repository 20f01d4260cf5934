#include <fmt/format.h>

#include <array>
#include <nlohmann/json.hpp>
#include <utility>

#include "graphdrl/base/error.h"
#include "graphdrl/env/load_worlds.h"
#include "graphdrl/io/csv.h"
#include "graphdrl/io/file.h"
#include "graphdrl/io/json.h"
#include "graphdrl/io/text.h"
#include "graphdrl/report/plan_files.h"

namespace graphdrl {
namespace {

std::vector<NodeId> walk_of_json(const World& world, const std::string& text, const std::string& file) {
  const nlohmann::json document = parse_json(text, file);
  const nlohmann::json& walk = document.is_object() && document.contains("walk") ? document["walk"] : document;
  if (!walk.is_array())
    throw Error({.what = "no walk", .expected = "an array, or one under the key \"walk\"", .where = file});
  std::vector<NodeId> nodes;
  for (const nlohmann::json& item : walk) {
    // A number is a node id, a text is what users call it.
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

std::vector<NodeId> walk_of_lines(const World& world, const std::string& text, const std::string& file) {
  std::vector<NodeId> nodes;
  Lines lines(text);
  int column = 0;
  bool ids = false;  // the column has node ids
  char separator = ' ';
  bool first = true;
  while (lines.next()) {
    const std::string_view line = lines.line();
    if (is_comment(line)) continue;
    const std::string where = fmt::format("{}:{}", file, lines.number());
    if (first) separator = separator_of(line);
    const std::vector<std::string> fields = split_fields(line, separator);
    if (std::exchange(first, false)) {
      const std::array<std::string_view, 2> id_names = {"node", "id"};
      const std::array<std::string_view, 1> names = {"label"};
      const int id_column = column_of(fields, id_names);
      const int label_column = column_of(fields, names);
      ids = id_column != kNoColumn;
      if (ids || label_column != kNoColumn) {
        column = ids ? id_column : label_column;
        continue;
      }
    }
    if (std::ssize(fields) <= column) {
      throw Error({.what = "no node", .expected = "a node a line", .got = in_quotes(line), .where = where});
    }
    const std::string& name = fields[column];
    nodes.push_back(parse_node(world, ids && parse_number(name) ? fmt::format("#{}", name) : name, where + ": node"));
  }
  return nodes;
}

}  // namespace

std::vector<NodeId> read_walk(const World& world, const std::string& file) {
  const std::string text = read_file(file);
  const std::size_t begin = text.find_first_not_of(" \t\r\n");
  const bool json = begin != std::string::npos && (text[begin] == '{' || text[begin] == '[');
  std::vector<NodeId> walk = json ? walk_of_json(world, text, file) : walk_of_lines(world, text, file);
  if (walk.empty()) throw Error({.what = "the walk is empty", .expected = "at least a start", .where = file});
  return walk;
}

}  // namespace graphdrl
