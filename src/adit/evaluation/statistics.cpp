// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/evaluation/statistics.hpp"

#include <algorithm>
#include <cmath>

#include "adit/core/check.hpp"

namespace adit {
namespace {

std::vector<double> sorted(std::span<const double> values) {
  ADIT_CHECK(!values.empty(), "statistics need at least one value");
  ADIT_CHECK(std::none_of(values.begin(), values.end(), [](double v) { return std::isnan(v); }),
             "statistics of values with NaN");
  std::vector<double> copy(values.begin(), values.end());
  std::sort(copy.begin(), copy.end());
  return copy;
}

double percentile_of_sorted(std::span<const double> ascending, double p) {
  const double position = p / 100.0 * static_cast<double>(ascending.size() - 1);
  const auto below = static_cast<std::size_t>(position);
  const std::size_t above = std::min(below + 1, ascending.size() - 1);
  return std::lerp(ascending[below], ascending[above], position - static_cast<double>(below));
}

}  // namespace

double percentile(std::span<const double> values, double p) {
  ADIT_CHECK(p >= 0.0 && p <= 100.0, "a percentile lies between 0 and 100");
  return percentile_of_sorted(sorted(values), p);
}

double median(std::span<const double> values) { return percentile(values, 50.0); }

double mean(std::span<const double> values) {
  ADIT_CHECK(!values.empty(), "statistics need at least one value");
  double sum = 0.0;
  for (const double v : values) sum += v;
  return sum / static_cast<double>(values.size());
}

double root_mean_square(std::span<const double> values) {
  ADIT_CHECK(!values.empty(), "statistics need at least one value");
  double sum = 0.0;
  for (const double v : values) sum += v * v;
  return std::sqrt(sum / static_cast<double>(values.size()));
}

BoxStatistics box_statistics(std::span<const double> values) {
  const std::vector<double> ascending = sorted(values);
  BoxStatistics box;
  box.lower_quartile = percentile_of_sorted(ascending, 25.0);
  box.median = percentile_of_sorted(ascending, 50.0);
  box.upper_quartile = percentile_of_sorted(ascending, 75.0);
  const double reach = 1.5 * (box.upper_quartile - box.lower_quartile);
  const auto first = std::lower_bound(ascending.begin(), ascending.end(), box.lower_quartile - reach);
  const auto last = std::upper_bound(ascending.begin(), ascending.end(), box.upper_quartile + reach);
  // With few values the furthest one within reach may lie inside the box; a whisker never does.
  box.lower_whisker = std::min(*first, box.lower_quartile);
  box.upper_whisker = std::max(*(last - 1), box.upper_quartile);
  box.outliers.assign(ascending.begin(), first);
  box.outliers.insert(box.outliers.end(), last, ascending.end());
  return box;
}

}  // namespace adit
