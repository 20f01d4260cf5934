// Maps of the Robot Operating System: a YAML file and a picture, as map_server reads and map_saver writes them.
#pragma once

#include <string>
#include <string_view>

#include "graphdrl/graph/grid_map.h"
#include "graphdrl/io/map_options.h"

namespace graphdrl {

// Whether a text is YAML with the keys `image` and `resolution`.
bool is_ros_map(std::string_view text);

// image: a picture in the YAML file's folder or below, or an absolute path of which the last part is a file beside it
// (then told to options.note); resolution: metres a pixel; origin: [x, y, yaw] of the lower left corner; negate;
// occupied_thresh, 0.65 unless given; free_thresh, 0.196; mode: trinary, scale or raw [wiki.ros.org/map_server; nav2's
// map_io]. A pixel counts by the mean of red, green and blue, in trinary mode of alpha too. A cell is free where its
// occupancy is below free_thresh, blocked where it is above occupied_thresh, and unknown in between; so is a raw value
// above 100, and in scale mode a pixel that is not opaque. Unknown cells are blocked unless options.unknown_is_free.
// The frame is that of the file, in metres. Reads no file outside of the folder. Throws Error, naming the file and
// mostly the line, on anything else.
GridMap parse_ros_map(std::string_view text, const std::string& source, const MapOptions& options = {});

}  // namespace graphdrl
