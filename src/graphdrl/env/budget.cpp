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
  if (!relative_) return checked_budget(world, value_, text_);
  return checked_budget(world, std::floor(value_ * world.valid_count() + 1e-9) * world.open().mean_cost(), text_);
}

double checked_budget(const World& world, double cost, std::string_view text) {
  const double most = static_cast<double>(kMaxSteps) * world.open().mean_cost();
  if (cost <= most) return cost;
  throw Error(
      {.what = "bad budget",
       .expected = fmt::format("at most {:g}: a walk has at most {} steps, and stays in memory", most, kMaxSteps),
       .got = text.empty() ? fmt::format("{:g}", cost) : fmt::format("{} = {:g}", text, cost),
       .where = world.name()});
}

}  // namespace graphdrl
