// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/evaluation/calibration.hpp"

#include <algorithm>

#include "adit/core/check.hpp"
#include "adit/core/decompositions.hpp"

namespace adit {

void Calibration::add(const Vector6& error, const Matrix6& covariance) {
  const std::optional<Matrix6> information = inverse_of_positive_definite(covariance);
  if (!information) {
    ++num_unusable_;
    return;
  }
  normalised_.push_back(error.dot(*information * error));
  sum_of_axes_ += error.cwiseAbs2().cwiseQuotient(covariance.diagonal());
  sum_of_squares_ += error.cwiseAbs2();
  ++num_errors_;
}

void Calibration::add(const Calibration& other) {
  normalised_.insert(normalised_.end(), other.normalised_.begin(), other.normalised_.end());
  sum_of_axes_ += other.sum_of_axes_;
  sum_of_squares_ += other.sum_of_squares_;
  num_errors_ += other.num_errors_;
  num_unusable_ += other.num_unusable_;
}

double Calibration::mean() const {
  ADIT_CHECK(count() > 0, "no error was added");
  double sum = 0.0;
  for (const double value : normalised_) sum += value;
  return sum / (6.0 * static_cast<double>(count()));
}

Vector6 Calibration::mean_of_axes() const {
  ADIT_CHECK(has_axes(), "no error was added");
  return sum_of_axes_ / static_cast<double>(num_errors_);
}

double Calibration::share_beyond(double bound) const {
  ADIT_CHECK(count() > 0, "no error was added");
  const auto beyond = std::ranges::count_if(normalised_, [&](double value) { return value > bound; });
  return static_cast<double>(beyond) / static_cast<double>(count());
}

Vector6 Calibration::rms() const {
  ADIT_CHECK(has_axes(), "no error was added");
  return (sum_of_squares_ / static_cast<double>(num_errors_)).cwiseSqrt();
}

Matrix6 with_pose_noise(const Matrix6& covariance, const Pose& T_a_b, const Matrix6& noise_a,
                        const Matrix6& noise_b) {
  return covariance + carry_covariance(T_a_b.inverse().adjoint(), noise_a) + noise_b;
}

Calibration edge_calibration(const StatedPath& path, const std::vector<Pose>& truth, double metres) {
  const std::vector<Pose>& poses = path.T_odom_keyframe;
  ADIT_CHECK(path.step_covariances.size() == poses.size() && path.pose_noise.size() == poses.size() &&
                 truth.size() == poses.size(),
             "two covariances and one true pose per keyframe");
  Calibration out;
  std::size_t begin = 0;
  double driven = 0.0;
  Matrix6 drift = Matrix6::Zero();
  for (std::size_t k = 1; k < poses.size(); ++k) {
    const Pose T_step = poses[k - 1].inverse() * poses[k];
    drift = carry_covariance(T_step.inverse().adjoint(), drift) + path.step_covariances[k];
    driven += T_step.translation().norm();
    if (driven < metres) continue;
    const Pose T_begin_k = poses[begin].inverse() * poses[k];
    const Pose T_true = truth[begin].inverse() * truth[k];
    out.add((T_begin_k.inverse() * T_true).log(),
            with_pose_noise(drift, T_begin_k, path.pose_noise[begin], path.pose_noise[k]));
    begin = k;
    driven = 0.0;
    drift.setZero();
  }
  return out;
}

}  // namespace adit
