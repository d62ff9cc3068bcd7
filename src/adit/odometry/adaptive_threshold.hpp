// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include "adit/core/pose.hpp"

namespace adit {

/// The displacement of the farthest point in range when the prediction is corrected by `correction`, metres:
/// |t| + 2 r_max sin(theta / 2) (KISS-ICP, eq. (6)-(7)).
[[nodiscard]] double point_deviation(const Pose& correction, double max_range);

/// sigma of the point displacements that the motion model leaves to ICP: the root mean square of the
/// deviations seen.
class DeviationStatistics {
 public:
  DeviationStatistics() = default;
  /// Starts as if `initial` had been seen once.
  explicit DeviationStatistics(double initial) : sum_of_squares_(initial * initial), count_(1) {}

  /// Metres, as of `point_deviation`.
  void add(double deviation);
  /// 0 while nothing was seen.
  [[nodiscard]] double sigma() const;

 private:
  double sum_of_squares_ = 0.0;
  int count_ = 0;
};

/// The adaptive threshold of KISS-ICP, section III-C, metres. Deviations up to `min_motion` do not count, so
/// that a robot at rest does not shrink the threshold to nothing. One addition to the paper: sigma can freeze
/// at a value so small that no correspondence is ever found again. Therefore each consecutive scan that could
/// not be registered (`failed`) widens it by half, up to the initial threshold; the first success takes the
/// widening back.
class AdaptiveThreshold {
 public:
  /// All in metres. The initial threshold counts as one deviation seen; `max_range` is that of
  /// `point_deviation`.
  AdaptiveThreshold(double initial_threshold, double min_motion, double max_range);

  /// Of the next scan, metres: the deviations' own, or wider after scans that failed.
  [[nodiscard]] double sigma() const;
  void add(const Pose& correction);  ///< predicted^-1 * estimated of a scan that was registered.
  void failed();                     ///< A scan that was not.

 private:
  double initial_threshold_;
  double min_motion_;
  double max_range_;
  DeviationStatistics statistics_;
  double widening_ = 1.0;
};

}  // namespace adit
