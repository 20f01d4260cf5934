// Live explorations as files: the map discovered, or the walk through it.
#pragma once

#include <string>

#include "graphdrl/live/live_exploration.h"

namespace graphdrl {

// Throws Error unless the file can be written and has an ending that write_live() knows.
void check_live_file(const std::string& file);

// The map discovered (.graphml, .gml, .dot, .json; of cells .pgm, .map, .txt, too), else the walk as write_plan()
// writes it. Throws Error.
void write_live(const LiveExploration& exploration, const std::string& file);

}  // namespace graphdrl
