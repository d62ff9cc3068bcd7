// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/geometry/umeyama.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "adit/core/check.hpp"
#include "adit/core/decompositions.hpp"

namespace adit {
namespace {

Vector3 centroid(std::span<const Vector3> points) {
  Vector3 sum = Vector3::Zero();
  for (const Vector3& p : points) sum += p;
  return sum / static_cast<double>(points.size());
}

double largest_coordinate(std::span<const Vector3> points) {
  double largest = 0.0;
  for (const Vector3& p : points) largest = std::max(largest, p.cwiseAbs().maxCoeff());
  return largest;
}

bool all_finite(std::span<const Vector3> points) {
  return std::all_of(points.begin(), points.end(), [](const Vector3& p) { return p.allFinite(); });
}

/// Sum of (target - mean) (source - mean)^T, and the size below which a singular value of it is mere
/// rounding.
struct CrossCovariance {
  Matrix3 matrix = Matrix3::Zero();
  double rounding = 0.0;
};

CrossCovariance cross_covariance(std::span<const Vector3> source, std::span<const Vector3> target,
                                 const Vector3& source_mean, const Vector3& target_mean) {
  CrossCovariance covariance;
  double source_spread = 0.0;
  double target_spread = 0.0;
  for (std::size_t i = 0; i < source.size(); ++i) {
    const Vector3 s = source[i] - source_mean;
    const Vector3 t = target[i] - target_mean;
    covariance.matrix += t * s.transpose();
    source_spread += s.squaredNorm();
    target_spread += t.squaredNorm();
  }
  const double unit = std::numeric_limits<double>::epsilon() *
                      std::max(largest_coordinate(source), largest_coordinate(target));
  covariance.rounding = 8.0 * unit * std::sqrt(static_cast<double>(source.size())) *
                        (std::sqrt(source_spread) + std::sqrt(target_spread));
  return covariance;
}

/// The rotation by the smallest angle that turns unit vector `from` into `to`. Eigen has one that decomposes
/// a matrix where they are opposite, and takes ten seconds to compile.
Matrix3 smallest_rotation(const Vector3& from, const Vector3& to) {
  const double cosine = to.dot(from);
  const bool opposite = cosine < -1.0 + Eigen::NumTraits<double>::dummy_precision();
  if (opposite) return Eigen::AngleAxisd(std::numbers::pi, from.unitOrthogonal()).toRotationMatrix();
  const double twice_w = std::sqrt(2.0 * (1.0 + cosine));
  Eigen::Quaterniond q;
  q.vec() = from.cross(to) / twice_w;
  q.w() = 0.5 * twice_w;
  return q.toRotationMatrix();
}

/// Umeyama's equation 40 (R = U S V^T), with the degenerate ranks taken apart.
Matrix3 best_rotation(const CrossCovariance& covariance) {
  const auto [u, singular_values, v] = svd(covariance.matrix);
  if (singular_values(0) <= covariance.rounding) return Matrix3::Identity();
  if (singular_values(1) <= covariance.rounding) {
    return smallest_rotation(v.col(0), u.col(0));
  }
  const double handedness = (u * v.transpose()).determinant() < 0.0 ? -1.0 : 1.0;
  return u * Vector3(1.0, 1.0, handedness).asDiagonal() * v.transpose();
}

}  // namespace

Result<Pose> align_rigid(std::span<const Vector3> source, std::span<const Vector3> target) {
  ADIT_CHECK(source.size() == target.size(), "every source point needs its target point");
  if (source.empty()) return fail("rigid alignment needs at least one pair of points, but there is none");
  if (!all_finite(source) || !all_finite(target)) {
    return fail("rigid alignment was given a coordinate that is not finite; remove such points first");
  }
  const Vector3 source_mean = centroid(source);
  const Vector3 target_mean = centroid(target);
  const Matrix3 rotation = best_rotation(cross_covariance(source, target, source_mean, target_mean));
  return Pose(rotation, target_mean - rotation * source_mean);
}

}  // namespace adit
