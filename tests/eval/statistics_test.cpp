#include "graphdrl/eval/statistics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace graphdrl {
namespace {

TEST(Summarise, IsWorkedOutByHand) {
  const Summary summary = summarise(std::vector<double>{2, 4, 6});
  EXPECT_EQ(summary.count, 3);
  EXPECT_DOUBLE_EQ(summary.mean, 4);
  EXPECT_DOUBLE_EQ(summary.best, 6);
  EXPECT_DOUBLE_EQ(*summary.std, 2);                         // √((4 + 0 + 4) / 2)
  const double half_width = 4.302652730 * 2 / std::sqrt(3);  // t(0.975, 2), from a table
  EXPECT_NEAR(summary.ci95->low, 4 - half_width, 1e-6);
  EXPECT_NEAR(summary.ci95->high, 4 + half_width, 1e-6);
}

TEST(Median, IsTheMiddleOne) {
  EXPECT_EQ(median({3, 1, 2}), 2);
  EXPECT_EQ(median({4, 1, 3, 2}), 3);
  EXPECT_EQ(median({5}), 5);
}

TEST(Quantile, LiesBetweenTheSortedValues) {
  EXPECT_EQ(quantile({4, 1, 3, 2}, 0), 1);
  EXPECT_EQ(quantile({4, 1, 3, 2}, 0.5), 2.5);
  EXPECT_EQ(quantile({4, 1, 3, 2}, 0.25), 1.75);  // three quarters of the way from 1 to 2
  EXPECT_EQ(quantile({4, 1, 3, 2}, 1), 4);
  EXPECT_EQ(quantile({5}, 0.7), 5);
}

// Differences 1, 2, 3: mean 2, standard deviation 1, so 2 / (1 / √3).
TEST(PairedDifference, CountsInErrorsOfTheMeanDifference) {
  const PairedDifference difference =
      paired_difference(std::vector<double>{11, 22, 33}, std::vector<double>{10, 20, 30});
  EXPECT_NEAR(difference.mean, 2, 1e-12);
  EXPECT_NEAR(*difference.in_errors, 2 * std::sqrt(3.0), 1e-12);
  EXPECT_FALSE(paired_difference(std::vector<double>{5, 6}, std::vector<double>{4, 5}).in_errors);
}

TEST(Summarise, HasNoSpreadForOneValue) {
  const Summary summary = summarise(std::vector<double>{5});
  EXPECT_EQ(summary.mean, 5);
  EXPECT_FALSE(summary.std);
  EXPECT_FALSE(summary.ci95);
}

TEST(Summarise, OfEqualValuesIsAPoint) {
  const Summary summary = summarise(std::vector<double>{7, 7, 7});
  EXPECT_EQ(*summary.std, 0);
  EXPECT_EQ(summary.ci95->low, 7);
  EXPECT_EQ(summary.ci95->high, 7);
}

}  // namespace
}  // namespace graphdrl
