// Graphs in the Trivial Graph Format, as yEd writes it.
#pragma once

#include <string>
#include <string_view>

#include "graphdrl/io/node_link.h"

namespace graphdrl {

// Whether a line "#" ends a list of different nodes.
bool is_tgf(std::string_view text);

// A node a line, `ID LABEL`, a line `#`, and an edge a line, `FROM TO LABEL`; labels may be missing. An edge's label
// that is a number is its cost; else it costs 1. Edges lead both ways, unless options.directed. Throws Error, naming
// `source` and the line, on anything else.
GraphMap parse_tgf(std::string_view text, const std::string& source, const MapOptions& options = {});

}  // namespace graphdrl
