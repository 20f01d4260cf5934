// Walks on grid maps as text that fits a terminal.
#pragma once

#include <cstdio>
#include <span>
#include <string>

#include "graphdrl/env/world.h"
#include "graphdrl/report/fog.h"

namespace graphdrl {

// The room for a picture.
struct Screen {
  int columns = 80;  // characters
  int lines = 60;
  bool colour = false;  // whether escape codes for 256 colours may be written
};

// A terminal's size; with colours unless NO_COLOR is set or TERM is "dumb". For any other stream, COLUMNS by 60 lines
// without colours; 80 columns by default.
Screen screen_of(std::FILE* out);

// The map with the walk, and a legend below. Where the screen has room for it, a cell is one character, or two side by
// side: an arrow leaves each visited cell as the walk first does. Otherwise a character stands for k × 2k cells, with
// the least k that fits: two pixels of their mean colour, or without colours a shade, the share visited. What a walk
// that explores has never seen is blank, or grey.
// REQUIRES: world.has_cells(); the walk is valid and not empty.
std::string draw_walk(const World& world, std::span<const NodeId> walk, const Screen& screen, const Fog& fog = {});

}  // namespace graphdrl
