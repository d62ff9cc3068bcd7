// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace adit {

/// The p-th percentile, p in [0, 100], with linear interpolation between the order statistics at p/100 * (n -
/// 1): the usual rule of plotting programs. `values` is not empty and holds no NaN, else ContractViolation.
[[nodiscard]] double percentile(std::span<const double> values, double p);
/// The 50th percentile; contract of `percentile`.
[[nodiscard]] double median(std::span<const double> values);
/// Of at least one value, else ContractViolation.
[[nodiscard]] double mean(std::span<const double> values);
/// sqrt(mean(x^2)).
[[nodiscard]] double root_mean_square(std::span<const double> values);

/// The probability of an event of which `k` in `n` trials were seen lies between these, with the stated
/// confidence at least: exact limits (C. Clopper, E. Pearson, "The use of confidence or fiducial limits
/// illustrated in the case of the binomial", 1934). Without a trial nothing is known: 0 and 1.
struct ShareLimits {
  double lower = 0.0;  ///< 0 where the event was never seen.
  double upper = 1.0;  ///< 1 where it was seen in every trial.
};
/// Both limits at once. `k` is at most `n`, `confidence` between 0 and 1, else ContractViolation.
[[nodiscard]] ShareLimits share_limits(std::size_t k, std::size_t n, double confidence = 0.95);
/// The upper limit alone, for what should not happen: for 0 of n about 3 / n at 95 %.
[[nodiscard]] double share_upper_limit(std::size_t k, std::size_t n, double confidence = 0.95);

/// What a standard (Tukey) boxplot shows: the whiskers end at the furthest values within 1.5 interquartile
/// ranges of the box, values beyond are outliers, ascending.
struct BoxStatistics {
  double lower_whisker = 0.0;    ///< At most the lower quartile.
  double lower_quartile = 0.0;   ///< Lower edge of the box: the 25th percentile.
  double median = 0.0;           ///< The line within the box.
  double upper_quartile = 0.0;   ///< Upper edge of the box: the 75th percentile.
  double upper_whisker = 0.0;    ///< At least the upper quartile.
  std::vector<double> outliers;  ///< On both sides.
};
/// Contract of `percentile`.
[[nodiscard]] BoxStatistics box_statistics(std::span<const double> values);

}  // namespace adit
