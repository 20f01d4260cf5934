// Where nodes lie.
#pragma once

#include <string>
#include <vector>

namespace graphdrl {

struct Point {
  double x;
  double y;
  friend bool operator==(const Point&, const Point&) = default;
};

// Of the nodes of a graph, y upward.
struct Places {
  std::vector<Point> points;  // [N]; empty if unknown
  std::string unit;           // "m"; "degrees" of longitude and latitude; empty if unknown
};

}  // namespace graphdrl
