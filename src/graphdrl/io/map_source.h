// Where maps come from: the paper's ten, built in, or files and folders.
#pragma once

#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "graphdrl/graph/grid_map.h"
#include "graphdrl/io/node_link.h"

namespace graphdrl {

struct NamedMap {
  std::string name;  // what the user gave; a file's stem
  std::variant<GridMap, GraphMap> map;
};

// `paper:a` … `paper:j`, `paper` (all ten), a file, or a folder of files (read in order of name; hidden ones are
// skipped). A file that begins with '{' is a graph in node-link form, one that begins
// with a keyword of TSPLIB a file of OPLib, any other an ASCII map. Throws Error where
// nothing can be read under that name. A file called `paper` is reachable as `./paper`.
std::vector<NamedMap> load_maps(const std::string& source);

// As load_maps, for a source that must hold exactly one map.
NamedMap load_map(const std::string& source);

// The text of one of the paper's environments, 'a' to 'j'; empty for any other letter. Made from maps/paper/ at build
// time.
std::string_view paper_map_text(char letter);

}  // namespace graphdrl
