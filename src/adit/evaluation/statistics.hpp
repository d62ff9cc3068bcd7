// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <vector>

namespace adit {

/// The p-th percentile, p in [0, 100], with linear interpolation between the order statistics at p/100 * (n -
/// 1): the usual rule of plotting programs. `values` is not empty and holds no NaN, else ContractViolation.
[[nodiscard]] double percentile(std::span<const double> values, double p);
[[nodiscard]] double median(std::span<const double> values);
[[nodiscard]] double mean(std::span<const double> values);
/// sqrt(mean(x^2)).
[[nodiscard]] double root_mean_square(std::span<const double> values);

/// What a standard (Tukey) boxplot shows: the whiskers end at the furthest values within 1.5 interquartile
/// ranges of the box, values beyond are outliers, ascending.
struct BoxStatistics {
  double lower_whisker = 0.0;
  double lower_quartile = 0.0;
  double median = 0.0;
  double upper_quartile = 0.0;
  double upper_whisker = 0.0;
  std::vector<double> outliers;
};
/// Contract of `percentile`.
[[nodiscard]] BoxStatistics box_statistics(std::span<const double> values);

}  // namespace adit
