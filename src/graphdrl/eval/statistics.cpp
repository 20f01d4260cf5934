#include "graphdrl/eval/statistics.h"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <numeric>

namespace graphdrl {

Summary summarise(std::span<const double> values) {
  const auto count = static_cast<double>(values.size());
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / count;
  Summary summary{.count = static_cast<int>(values.size()),
                  .mean = mean,
                  .best = *std::max_element(values.begin(), values.end()),
                  .std = std::nullopt,
                  .ci95 = std::nullopt};
  if (values.size() < 2) return summary;
  double squares = 0;
  for (const double value : values) squares += (value - mean) * (value - mean);
  summary.std = std::sqrt(squares / (count - 1));
  const double t = boost::math::quantile(boost::math::students_t(count - 1), 0.975);
  const double half_width = t * *summary.std / std::sqrt(count);
  summary.ci95 = Interval{mean - half_width, mean + half_width};
  return summary;
}

PairedDifference paired_difference(std::span<const double> one, std::span<const double> other) {
  std::vector<double> differences(one.begin(), one.end());
  for (std::size_t i = 0; i < differences.size(); ++i) differences[i] -= other[i];
  const Summary summary = summarise(differences);
  PairedDifference difference{.mean = summary.mean, .in_errors = {}};
  if (summary.std && *summary.std > 0) {
    difference.in_errors = summary.mean / (*summary.std / std::sqrt(static_cast<double>(summary.count)));
  }
  return difference;
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + std::ssize(values) / 2, values.end());
  return values[values.size() / 2];
}

double quantile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  const double place = share * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const std::size_t above = std::min(below + 1, values.size() - 1);
  return std::lerp(values[below], values[above], place - static_cast<double>(below));
}

std::string or_dash(const std::optional<double>& value, const char* format) {
  return value ? fmt::format(fmt::runtime(format), *value) : "–";
}

}  // namespace graphdrl
