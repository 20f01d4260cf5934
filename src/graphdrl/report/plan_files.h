// Plans as files, for other programs, and plans read back.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <vector>

#include "graphdrl/answer/answer.h"

namespace graphdrl {

// The document that `graphdrl plan --json` prints.
nlohmann::ordered_json plan_json(const Answer& answer);

// The cost so far at every node of the plan's walk; over edges, with the loops that are walked there.
std::vector<double> costs_so_far(const Answer& answer);

// The walk, a node a line below a header: node ids, with the labels beside them. read_plan() reads it.
std::string format_walk(const World& world, std::span<const NodeId> walk);

// Throws Error unless the file can be written [check_writable()] and has one of these endings: .json, .csv, .graphml,
// .dot, .geojson, .yaml (ROS's nav_msgs/Path), .svg, .anim.svg, .png or .html (report/report_page.h).
void check_plan_file(const std::string& file);
// Throws Error also if the format needs coordinates and the world has none.
void check_plan_file(const World& world, const std::string& file);

// Writes a plan in the format of the file's ending. Throws Error.
void write_plan(const Answer& answer, const std::string& file);

// A field of CSV [RFC 4180].
std::string csv_field(const std::string& text);

// The endings, for help texts.
std::string plan_file_endings();

// A plan from a file: the document above, an array of node ids, or lines. Lines have a node each: the first field of
// CSV or, below a header, the column `node`, `id` or `label`; a single line without a header has the whole walk. Nodes
// are named as for parse_node(). Budget and end are what is asked, else what the document says, else what the walk
// costs and anywhere; policy, bound and what was seen what the document says, else the file's name, none and the whole
// map. Throws Error, naming the file and the line, also where a step follows no edge, and where several lines of
// several words leave open which of them are nodes.
//
// Edges count where that is asked for, or the document says so. It says which ones were walked, too; else each step
// takes the cheapest edge that was not walked yet, if there is one, and a step without an edge to the start is a reset,
// where these have a cost.
struct AskedOfPlan {
  Asked task = {};
  std::optional<Cover> cover = {};        // the default is what the document says, else nodes
  std::optional<double> reset_cost = {};  // where edges count; the default is the document's, else there are none
};
Answer read_plan(const World& world, const std::string& file, const AskedOfPlan& asked = {});

// The same for a text; `file` is for error messages.
Answer parse_plan(const World& world, const std::string& text, const std::string& file, const AskedOfPlan& asked = {});

// Throws Error, naming `file`, if the plan's walk costs more than the task's budget or does not end where it must.
void check_walk(const Answer& answer, const std::string& file);

}  // namespace graphdrl
