// Where nodes lie.
#pragma once

#include <cmath>
#include <string>
#include <vector>

namespace graphdrl {

struct Point {
  double x;
  double y;
  friend bool operator==(const Point&, const Point&) = default;
};

inline double length_between(const Point& a, const Point& b) {
  return std::hypot(a.x - b.x, a.y - b.y);
}

// Of the nodes of a graph, y upward.
struct Places {
  std::vector<Point> points;  // [N]; empty if unknown
  std::string unit;           // "m"; "degrees" of longitude and latitude; empty if unknown
};

}  // namespace graphdrl
