#include <algorithm>

#include "graphdrl/base/error.h"
#include "graphdrl/io/readers.h"
#include "graphdrl/io/text.h"

namespace graphdrl {
namespace {

constexpr std::size_t kShown = 40;  // characters of a line

struct Foreign {
  std::string_view begin;  // of the text
  const char* what;
  const char* advice;
};

constexpr Foreign kScenario = {"", "a scenario of MovingAI, a list of starts and goals",
                               "the map that its second column names; --start takes a start from the scenario"};
constexpr Foreign kForeign[] = {
    {"%%MatrixMarket", "a matrix of Matrix Market",
     "an edge list or GraphML, as networkx writes of what scipy.io.mmread reads"},
    {"LEDA.GRAPH", "a graph of LEDA", "GraphML, GML, DOT or an edge list"},
    {">>graph6<<", "a graph in graph6", "GraphML, as networkx writes of what read_graph6 reads"},
    {"%PDF", "a PDF document", "the map as a PNG picture"},
    {"GIF8", "a GIF picture", "a PNG picture"},
    {"\xFF\xD8\xFF", "a JPEG picture", "a PNG picture"},
    {"<", "XML of another kind", "GraphML"},
};

// "version 1", then nine fields a line: bucket, map, its size, start, goal, length. The map is no number.
bool is_scenario(std::string_view text) {
  Lines lines(text);
  if (!lines.next()) return false;
  if (trimmed(lines.line()).starts_with("version") && !lines.next()) return false;
  const auto fields = split_fields(lines.line(), separator_of(lines.line()));
  const auto is_number = [](const std::string& field) { return parse_number(field).has_value(); };
  return fields.size() == 9 && !is_number(fields[1]) && std::all_of(fields.begin() + 2, fields.end(), is_number);
}

const Foreign* foreign_of(std::string_view text) {
  if (is_scenario(text)) return &kScenario;
  for (const Foreign& foreign : kForeign) {
    if (text.starts_with(foreign.begin)) return &foreign;
  }
  return nullptr;
}

}  // namespace

bool is_foreign(std::string_view text) {
  return foreign_of(text) != nullptr;
}

void refuse_foreign(std::string_view text, const std::string& source) {
  if (const Foreign* const foreign = foreign_of(text)) {
    throw Error(
        {.what = std::string("this looks like ") + foreign->what, .expected = foreign->advice, .where = source});
  }
  Lines lines(text);
  while (lines.next() && trimmed(lines.line()).empty()) {
  }
  throw Error({.what = "no format of maps is known by this content",
               .expected = "one that graphdrl maps convert --help names",
               .got = in_quotes(lines.line().substr(0, kShown)),
               .where = source});
}

}  // namespace graphdrl
