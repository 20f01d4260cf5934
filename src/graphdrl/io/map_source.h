// Where maps come from: the paper's ten, built in, or files and folders.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "graphdrl/io/map_formats.h"

namespace graphdrl {

struct NamedMap {
  std::string name;  // what the user gave; a file's stem
  AnyMap map;
};

// The sources of one map each that a source stands for: those of `paper`, and the files of a folder in order of name;
// hidden ones are skipped, and so is the picture of a ROS map. Any other is its own. Throws Error on a folder that has
// none or cannot be read.
std::vector<std::string> map_sources(const std::string& source);

// `paper:a`, `paper` (all ten), a file, or a folder of files, in any format of map_formats(). Throws Error where
// nothing can be read under that name, and where an option has no meaning for the map. A file called `paper` is
// reachable as `./paper`.
std::vector<NamedMap> load_maps(const std::string& source, const MapOptions& options = {});

// As load_maps, for a source that must hold exactly one map.
NamedMap load_map(const std::string& source, const MapOptions& options = {});

// The text of one of the paper's environments, 'a' to 'j'; empty for any other letter. Made from maps/paper/ at build
// time.
std::string_view paper_map_text(char letter);

}  // namespace graphdrl
