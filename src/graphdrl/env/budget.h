// Budgets as users give them: what an episode may spend, or a multiple of the number of valid nodes.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "graphdrl/env/task.h"

namespace graphdrl {

// "25", in units of cost, or "1.1x": floor(1.1 · n + 1e-9) times the mean cost of an edge in a world of n valid nodes.
// Where edges have no costs, a unit is a step.
class Budget {
 public:
  // Throws Error on anything but a number from 0 up, with or without the x.
  static Budget parse(std::string_view text);

  double cost_in(const World& world) const;  // throws Error as checked_budget() does
  const std::string& text() const { return text_; }

 private:
  std::string text_;
  double value_ = 0;
  bool relative_ = false;
};

// `cost` itself, as a budget in `world` that comes from anywhere. Throws Error where it is more than kMaxSteps mean
// edges; `text` is what the user wrote, if anything.
double checked_budget(const World& world, double cost, std::string_view text = {});

}  // namespace graphdrl
