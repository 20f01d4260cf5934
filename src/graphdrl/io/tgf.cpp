#include <fmt/format.h>

#include <unordered_set>

#include "graphdrl/io/graph_builder.h"
#include "graphdrl/io/readers.h"
#include "graphdrl/io/text.h"

namespace graphdrl {

// Whether a line "#" ends a list of different nodes, which are no cells of a drawing.
bool is_tgf(std::string_view text) {
  if (text.find("\n#") == std::string_view::npos) return false;
  std::unordered_set<std::string_view> nodes;
  for (Lines lines(text); lines.next();) {
    std::string_view line = lines.line();
    const std::string_view id = take_word(line);
    if (id == "#" && line.empty()) return !nodes.empty();
    const bool cell = id == "." && line.empty();
    if (cell || id.starts_with('#') || (!id.empty() && !nodes.insert(id).second)) return false;
  }
  return false;
}

GraphMap parse_tgf(std::string_view text, const std::string& source, const MapOptions& options) {
  Lines lines(text, source);
  GraphBuilder builder(options, [&] { return lines.place(); });
  bool edges = false;
  std::int64_t texts = 0;
  while (lines.next()) {
    std::string_view rest = lines.line();
    const std::string_view id = take_word(rest);
    if (id.empty()) continue;
    if (id == "#" && rest.empty() && !edges) {
      edges = true;
    } else if (!edges) {
      const NodeId node = builder.add_node(id);
      if (!rest.empty()) builder.set_node(node, "label", rest);
    } else {
      const std::string_view to = take_word(rest);
      if (to.empty()) lines.fail("not an edge", "two nodes");
      builder.add_edge(builder.node(id), builder.node(to), options.directed);
      if (parse_number(rest)) {
        builder.set_edge("cost", rest);
      } else if (!rest.empty()) {
        ++texts;
      }
    }
  }
  if (options.note) {
    options.note(fmt::format("{}: edges of TGF lead {}{}", source,
                             options.directed ? "one way" : "both ways (--directed: one way)",
                             texts == 0 ? "" : fmt::format("; {} with a text for a label cost 1", texts)));
  }
  return builder.build();
}

}  // namespace graphdrl
