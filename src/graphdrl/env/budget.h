// Budgets as users give them: what a walk may cost, or a multiple of the number of valid nodes.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "graphdrl/env/view.h"

namespace graphdrl {

// The most steps of any walk. A budget may pay for more where edges cost next to nothing; walks stay in memory, so they
// end here.
inline constexpr std::int64_t kMaxSteps = 100'000'000;

// "25", in units of cost, or "1.1x": floor(1.1 · n + 1e-9) times the mean cost of an edge in a world of n valid nodes.
// Where edges have no costs, a unit is a step.
class Budget {
 public:
  // Units of cost. Throws Error on anything but a number from 0 up; infinity is one.
  explicit Budget(double cost);
  // The same with or without the x.
  static Budget parse(std::string_view text);

  double cost_in(const View& view) const;
  const std::string& text() const { return text_; }  // as it was given

 private:
  std::string text_;
  double value_;
  bool relative_ = false;
};

}  // namespace graphdrl
