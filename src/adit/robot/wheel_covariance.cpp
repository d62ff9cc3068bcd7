// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/robot/wheel_covariance.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>

#include "adit/core/decompositions.hpp"
#include "adit/core/format.hpp"

namespace adit {
namespace {

// Dead reckoning over 10 km is off by less than this; drivers write squares of it for "unknown".
constexpr double kLargestPosition = 1000.0;  // metres
constexpr double kLargestHeading = 10.0;     // radians: three times what any heading can be off by
constexpr double kLargestSpeed = 10.0;       // m/s: faster than the robots are
constexpr double kLargestTurnRate = 10.0;    // rad/s

bool is_stated(const Matrix6& covariance, Eigen::Index axis) {
  return !covariance.row(axis).isZero(0.0) || !covariance.col(axis).isZero(0.0);
}

// Whether it is positive definite in the axes that it states; each axis in units of its own deviation, so
// that a large number for one does not hide the others.
bool is_covariance(const Matrix6& covariance) {
  Matrix6 correlation = Matrix6::Identity();
  for (Eigen::Index i = 0; i < 6; ++i) {
    if (!is_stated(covariance, i)) continue;
    if (covariance(i, i) <= 0.0) return false;
    for (Eigen::Index k = 0; k < 6; ++k) {
      if (k == i || covariance(i, k) == 0.0) continue;
      correlation(i, k) = covariance(i, k) / std::sqrt(covariance(i, i) * std::abs(covariance(k, k)));
    }
  }
  return correlation.allFinite() && (correlation - correlation.transpose()).norm() < 1e-6 &&
         is_positive_definite(correlation);
}

struct Limits {
  double along = 0.0;
  double heading = 0.0;
  std::string_view along_unit;
  std::string_view heading_unit;
};

std::string fault_of(const Matrix6& covariance, const Limits& limits) {
  if (covariance.isZero(0.0)) return "";
  if (!covariance.allFinite()) return "not finite";
  if (!is_covariance(covariance)) return "not positive definite";
  const double along = std::sqrt(std::max(covariance(0, 0), covariance(1, 1)));
  const double heading = std::sqrt(covariance(5, 5));
  if (along >= limits.along) return format("huge (standard deviation {:.3g} {})", along, limits.along_unit);
  if (heading >= limits.heading)
    return format("huge (standard deviation {:.3g} {})", heading, limits.heading_unit);
  return "";
}

}  // namespace

std::string fault_of_pose_covariance(const Matrix6& covariance) {
  return fault_of(covariance, {kLargestPosition, kLargestHeading, "m", "rad"});
}

std::string fault_of_twist_covariance(const Matrix6& covariance) {
  return fault_of(covariance, {kLargestSpeed, kLargestTurnRate, "m/s", "rad/s"});
}

}  // namespace adit
