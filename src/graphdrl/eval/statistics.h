// Summaries of samples.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace graphdrl {

struct Interval {
  double low;
  double high;
};

// All in the unit of the sample. One value alone has no standard deviation and no interval.
struct Summary {
  int count;
  double mean;
  double best;                   // the largest
  std::optional<double> std;     // of the sample: n - 1
  std::optional<Interval> ci95;  // of the mean: mean ± t(0.975, n - 1) · std / √n
};

// REQUIRES: values is not empty.
Summary summarise(std::span<const double> values);

// Of two samples whose values belong together, such as those of the same seeds.
struct PairedDifference {
  double mean;                      // of one less the other
  std::optional<double> in_errors;  // mean / (std / √n); empty where the differences do not vary
};
// REQUIRES: as many of each, at least one.
PairedDifference paired_difference(std::span<const double> one, std::span<const double> other);

// The upper one of the two in the middle where their number is even. REQUIRES: values is not empty.
double median(std::vector<double> values);

// Between the sorted values, linearly: 0 gives the smallest, 0.5 the median, 1 the largest. REQUIRES: values is not
// empty, and a share from 0 to 1.
double quantile(std::vector<double> values, double share);

// "1.5", or "–" where there is no value. format: as fmt takes it.
std::string or_dash(const std::optional<double>& value, const char* format = "{:.1f}");

}  // namespace graphdrl
