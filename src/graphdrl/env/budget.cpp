#include "graphdrl/env/budget.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

#include "graphdrl/base/error.h"

namespace graphdrl {

Budget Budget::parse(std::string_view text) {
  Budget budget;
  budget.text_ = text;
  std::string_view number = text;
  budget.relative_ = number.ends_with('x');
  if (budget.relative_) number.remove_suffix(1);
  const char* const end = number.data() + number.size();
  const auto [rest, error] = std::from_chars(number.data(), end, budget.value_);
  if (error != std::errc() || rest != end || !(budget.value_ >= 0) || !std::isfinite(budget.value_)) {
    throw Error(
        {.what = "bad budget", .expected = "a number from 0 up, or a multiple like 1.1x", .got = in_quotes(text)});
  }
  budget.value_ = std::abs(budget.value_);  // -0
  return budget;
}

double Budget::cost_in(const World& world) const {
  const double mean_cost = world.open().mean_cost();
  const double cost = relative_ ? std::floor(value_ * world.valid_count() + 1e-9) * mean_cost : value_;
  const double most = static_cast<double>(kMaxSteps) * mean_cost;
  if (cost <= most) return cost;
  throw Error(
      {.what = "bad budget",
       .expected = fmt::format("at most {:g}: a walk has at most {} steps, and stays in memory", most, kMaxSteps),
       .got = fmt::format("{} = {:g}", text_, cost),
       .where = world.name()});
}

}  // namespace graphdrl
