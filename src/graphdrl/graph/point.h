// Where a node lies.
#pragma once

namespace graphdrl {

struct Point {
  double x;
  double y;
  friend bool operator==(const Point&, const Point&) = default;
};

}  // namespace graphdrl
