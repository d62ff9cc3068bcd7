// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/evaluation/statistics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "adit/core/check.hpp"
#include "adit/core/rng.hpp"

namespace adit {
namespace {

TEST(Statistics, PercentilesOfKnownLists) {
  const std::vector<double> values = {4.0, 1.0, 3.0, 2.0};
  EXPECT_DOUBLE_EQ(percentile(values, 0.0), 1.0);
  EXPECT_DOUBLE_EQ(percentile(values, 25.0), 1.75);
  EXPECT_DOUBLE_EQ(median(values), 2.5);
  EXPECT_DOUBLE_EQ(percentile(values, 100.0), 4.0);
  EXPECT_DOUBLE_EQ(mean(values), 2.5);
  EXPECT_DOUBLE_EQ(root_mean_square(values), std::sqrt(7.5));
  EXPECT_DOUBLE_EQ(median(std::vector<double>{7.0}), 7.0);
}

TEST(Statistics, PercentileSplitsValuesAsItsDefinitionSays) {
  Rng rng(5);
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<double> values(1 + rng.below(30));
    for (double& v : values) v = std::floor(rng.uniform(0.0, 10.0));  // many duplicates
    const double p = rng.uniform(0.0, 100.0);
    const double found = percentile(values, p);
    const double n = static_cast<double>(values.size());
    const auto below =
        static_cast<double>(std::count_if(values.begin(), values.end(), [&](double v) { return v < found; }));
    const auto above =
        static_cast<double>(std::count_if(values.begin(), values.end(), [&](double v) { return v > found; }));
    EXPECT_LE(below, p / 100.0 * (n - 1.0) + 1.0);
    EXPECT_LE(above, (1.0 - p / 100.0) * (n - 1.0) + 1.0);
  }
}

TEST(Statistics, BoxAgainstBruteForce) {
  Rng rng(6);
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<double> values(1 + rng.below(60));
    for (double& v : values) v = std::exp(2.0 * rng.normal());  // long tail: outliers
    const BoxStatistics box = box_statistics(values);
    const double reach = 1.5 * (box.upper_quartile - box.lower_quartile);
    double low = box.lower_quartile;
    double high = box.upper_quartile;
    std::vector<double> outliers;
    for (const double v : values) {
      if (v < box.lower_quartile - reach || v > box.upper_quartile + reach) {
        outliers.push_back(v);
      } else {
        low = std::min(low, v);
        high = std::max(high, v);
      }
    }
    std::sort(outliers.begin(), outliers.end());
    EXPECT_EQ(box.lower_whisker, low);
    EXPECT_EQ(box.upper_whisker, high);
    EXPECT_EQ(box.outliers, outliers);
    EXPECT_EQ(box.median, median(values));
  }
}

TEST(Statistics, EqualValuesMakeAFlatBox) {
  const BoxStatistics box = box_statistics(std::vector<double>(9, 3.0));
  EXPECT_EQ(box.lower_whisker, 3.0);
  EXPECT_EQ(box.upper_whisker, 3.0);
  EXPECT_TRUE(box.outliers.empty());
}

TEST(Statistics, NothingAndNaNAreContractViolations) {
  EXPECT_THROW((void)median({}), ContractViolation);
  EXPECT_THROW((void)mean({}), ContractViolation);
  EXPECT_THROW((void)box_statistics(std::vector<double>{1.0, std::nan("")}), ContractViolation);
  EXPECT_THROW((void)percentile(std::vector<double>{1.0}, 101.0), ContractViolation);
}

TEST(ShareLimits, AreThoseOfTheBinomialDistribution) {
  // 0 of n: (1 - p)^n = 5 %.
  for (const std::size_t n : {1U, 10U, 300U})
    EXPECT_NEAR(share_upper_limit(0, n), 1.0 - std::pow(0.05, 1.0 / static_cast<double>(n)), 1e-9) << n;
  // Known values, two-sided 95 %: 5 of 10 (Clopper and Pearson, 1934) and 64 of 76.
  EXPECT_NEAR(share_limits(5, 10).lower, 0.1871, 1e-4);
  EXPECT_NEAR(share_limits(5, 10).upper, 0.8129, 1e-4);
  for (const auto& [k, n] : {std::pair<std::size_t, std::size_t>(64, 76), {1, 7}, {250, 300}}) {
    const ShareLimits limits = share_limits(k, n);
    const ShareLimits mirrored = share_limits(n - k, n);
    EXPECT_NEAR(limits.lower, 1.0 - mirrored.upper, 1e-9);
    EXPECT_LT(limits.lower, static_cast<double>(k) / static_cast<double>(n));
    EXPECT_GT(limits.upper, share_upper_limit(k, n)) << "one side is less to promise";
    EXPECT_GT(share_limits(k, n, 0.99).upper, limits.upper);
  }
}

TEST(ShareLimits, OfNothingOrAllAreTheEnds) {
  EXPECT_EQ(share_limits(0, 0).lower, 0.0);
  EXPECT_EQ(share_limits(0, 0).upper, 1.0);
  EXPECT_EQ(share_upper_limit(0, 0), 1.0);
  EXPECT_EQ(share_limits(0, 5).lower, 0.0);
  EXPECT_EQ(share_limits(5, 5).upper, 1.0);
  EXPECT_THROW((void)share_limits(3, 2), ContractViolation);
  EXPECT_THROW((void)share_upper_limit(0, 2, 1.0), ContractViolation);
}

}  // namespace
}  // namespace adit
