#include "graphdrl/env/budget.h"

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
  if (error != std::errc() || rest != end || !std::isfinite(budget.value_) || budget.value_ < 0) {
    throw Error(
        {.what = "bad budget", .expected = "a number from 0 up, or a multiple like 1.1x", .got = in_quotes(text)});
  }
  return budget;
}

double Budget::steps_in(const World& world) const {
  return relative_ ? std::floor(value_ * world.valid_count() + 1e-9) : value_;
}

}  // namespace graphdrl
