// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "adit/core/records.hpp"

namespace adit {

/// Compares errors of relative poses with the covariances that were stated for them. The normalised error
/// squared e^T C^-1 e has the mean 6 where the covariances are true (Y. Bar-Shalom, X. R. Li, T. Kirubarajan,
/// "Estimation with Applications to Tracking and Navigation", 2001, section 5.4); figures here are divided by
/// that. More than 1 means too confident, less too cautious.
class Calibration {
 public:
  /// The error and its covariance in the same tangent, [translation; rotation], metres and radians. A
  /// covariance that is not positive definite is counted and left out.
  void add(const Vector6& error, const Matrix6& covariance);
  /// A normalised error squared, six where the covariance is true, of an error that is not known axis by
  /// axis.
  void add_normalised(double squared) { normalised_.push_back(squared); }
  /// Takes over all errors of the other, unusable ones too.
  void add(const Calibration& other);

  /// Errors that count; those of `num_unusable` do not.
  [[nodiscard]] std::size_t count() const { return normalised_.size(); }
  /// Whether any error was added axis by axis.
  [[nodiscard]] bool has_axes() const { return num_errors_ > 0; }
  /// Errors whose covariance was no covariance.
  [[nodiscard]] std::size_t num_unusable() const { return num_unusable_; }
  /// Of the six dimensions together. Like `share_beyond`, only with `count()` > 0.
  [[nodiscard]] double mean() const;
  /// Of each dimension alone: e_k^2 / C_kk. Like `rms`, only with `has_axes()`.
  [[nodiscard]] Vector6 mean_of_axes() const;
  /// Share of the errors with e^T C^-1 e above `bound`.
  [[nodiscard]] double share_beyond(double bound) const;
  /// Root mean square of the errors, metres and radians.
  [[nodiscard]] Vector6 rms() const;

 private:
  std::vector<double> normalised_;
  Vector6 sum_of_axes_ = Vector6::Zero();
  Vector6 sum_of_squares_ = Vector6::Zero();
  std::size_t num_errors_ = 0;
  std::size_t num_unusable_ = 0;
};

/// What an odometry states of its keyframes; vectors of one length.
struct StatedPath {
  std::vector<Pose> T_odom_keyframe;      ///< In the order driven.
  std::vector<Matrix6> step_covariances;  ///< Of the drift from keyframe k - 1 to k, right perturbation.
  std::vector<Matrix6> pose_noise;        ///< Of each pose alone, right perturbation.
};

/// The covariance of T_a_b where both poses have a noise of their own beside `covariance`, that of T_a_b.
[[nodiscard]] Matrix6 with_pose_noise(const Matrix6& covariance, const Pose& T_a_b, const Matrix6& noise_a,
                                      const Matrix6& noise_b);

/// The errors of odometry over stretches of `metres` along the path, end to end: from each keyframe that
/// begins one to the first keyframe that lies so far along. `truth` has a pose T_world_base for each
/// keyframe.
[[nodiscard]] Calibration edge_calibration(const StatedPath& path, const std::vector<Pose>& truth,
                                           double metres);

}  // namespace adit
