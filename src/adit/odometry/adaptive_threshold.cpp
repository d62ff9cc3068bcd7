// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/odometry/adaptive_threshold.hpp"

#include <algorithm>
#include <cmath>

namespace adit {

double point_deviation(const Pose& correction, double max_range) {
  return correction.translation().norm() + 2.0 * max_range * std::sin(0.5 * correction.angle());
}

void DeviationStatistics::add(double deviation) {
  sum_of_squares_ += deviation * deviation;
  ++count_;
}

double DeviationStatistics::sigma() const { return count_ == 0 ? 0.0 : std::sqrt(sum_of_squares_ / count_); }

AdaptiveThreshold::AdaptiveThreshold(double initial_threshold, double min_motion, double max_range)
    : initial_threshold_(initial_threshold),
      min_motion_(min_motion),
      max_range_(max_range),
      statistics_(initial_threshold) {}

double AdaptiveThreshold::sigma() const {
  const double sigma = statistics_.sigma();
  return std::max(sigma, std::min(widening_ * sigma, initial_threshold_));
}

void AdaptiveThreshold::add(const Pose& correction) {
  widening_ = 1.0;
  const double deviation = point_deviation(correction, max_range_);
  if (deviation > min_motion_) statistics_.add(deviation);
}

void AdaptiveThreshold::failed() {
  if (sigma() < initial_threshold_) widening_ *= 1.5;
}

}  // namespace adit
