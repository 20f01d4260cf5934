#include "graphdrl/env/budget.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

#include "graphdrl/base/error.h"

namespace graphdrl {

Budget::Budget(double cost) : text_(fmt::format("{}", cost)), value_(std::abs(cost)) {  // -0
  if (!(cost >= 0)) {
    throw Error({.what = "bad budget", .expected = "a number from 0 up", .got = fmt::format("{}", cost)});
  }
}

Budget Budget::parse(std::string_view text) {
  std::string_view number = text;
  const bool relative = number.ends_with('x');
  if (relative) number.remove_suffix(1);
  const char* const end = number.data() + number.size();
  double value = 0;
  const auto [rest, error] = std::from_chars(number.data(), end, value);
  if (error != std::errc() || rest != end || !(value >= 0)) {
    throw Error(
        {.what = "bad budget", .expected = "a number from 0 up, or a multiple like 1.1x", .got = in_quotes(text)});
  }
  Budget budget(value);
  budget.text_ = text;
  budget.relative_ = relative;
  return budget;
}

double Budget::cost_in(const View& view) const {
  return relative_ ? std::floor(value_ * view.valid_count() + 1e-9) * view.open().mean_cost() : value_;
}

}  // namespace graphdrl
