// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/evaluation/statistics.hpp"

#include <algorithm>
#include <cmath>

#include "adit/core/check.hpp"
#include "adit/core/log_gamma.hpp"

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

/// P(at most k of n events), each with probability p between 0 and 1, both excluded.
double binomial_at_most(std::size_t k, std::size_t n, double p) {
  const auto trials = static_cast<double>(n);
  double sum = 0.0;
  for (std::size_t i = 0; i <= k; ++i) {
    const auto events = static_cast<double>(i);
    const double log_ways =
        log_gamma(trials + 1.0) - log_gamma(events + 1.0) - log_gamma(trials - events + 1.0);
    sum += std::exp(log_ways + events * std::log(p) + (trials - events) * std::log1p(-p));
  }
  return std::min(sum, 1.0);
}

/// The p at which P(at most k of n) is `probability`; it falls with p.
double share_where(std::size_t k, std::size_t n, double probability) {
  constexpr int kHalvings = 60;
  double below = 0.0;
  double above = 1.0;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (below + above);
    (binomial_at_most(k, n, middle) > probability ? below : above) = middle;
  }
  return 0.5 * (below + above);
}

void check_share(std::size_t k, std::size_t n, double confidence) {
  ADIT_CHECK(k <= n, "more events than trials");
  ADIT_CHECK(confidence > 0.0 && confidence < 1.0, "a confidence lies between 0 and 1");
}

}  // namespace

ShareLimits share_limits(std::size_t k, std::size_t n, double confidence) {
  check_share(k, n, confidence);
  const double tail = 0.5 * (1.0 - confidence);
  return {k == 0 ? 0.0 : share_where(k - 1, n, 1.0 - tail), k == n ? 1.0 : share_where(k, n, tail)};
}

double share_upper_limit(std::size_t k, std::size_t n, double confidence) {
  check_share(k, n, confidence);
  return k == n ? 1.0 : share_where(k, n, 1.0 - confidence);
}

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
