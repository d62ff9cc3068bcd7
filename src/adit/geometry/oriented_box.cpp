// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/geometry/oriented_box.hpp"

#include <algorithm>
#include <array>

#include "adit/core/decompositions.hpp"
#include "adit/geometry/convex_hull.hpp"

namespace adit {
namespace {

Matrix3 principal_axes(const std::vector<Vector3>& corners, const Vector3& mean) {
  Matrix3 covariance = Matrix3::Zero();
  for (const Vector3& corner : corners) covariance += (corner - mean) * (corner - mean).transpose();
  return symmetric_eigen(Matrix3(covariance / static_cast<double>(corners.size()))).vectors;
}

/// By extent, descending, right-handed; of the two directions of an axis the one whose greatest component is
/// positive.
Matrix3 sorted_axes(const Matrix3& axes, const Vector3& extents) {
  std::array<int, 3> order = {
      2, 1, 0};  // The solver's eigenvalues ascend; of equal extents the greater one goes first.
  std::ranges::stable_sort(order, std::ranges::greater{}, [&](int i) { return extents[i]; });
  Matrix3 sorted;
  for (int i = 0; i < 2; ++i) {
    const Vector3 axis = axes.col(order[static_cast<std::size_t>(i)]);
    Eigen::Index greatest = 0;
    axis.cwiseAbs().maxCoeff(&greatest);
    sorted.col(i) = axis[greatest] < 0.0 ? Vector3(-axis) : axis;
  }
  sorted.col(2) = sorted.col(0).cross(sorted.col(1));
  return sorted;
}

struct Span {
  Vector3 low, high;
};

Span span_along(const Matrix3& axes, const std::vector<Vector3>& corners) {
  Span span{axes.transpose() * corners.front(), axes.transpose() * corners.front()};
  for (const Vector3& corner : corners) {
    const Vector3 along = axes.transpose() * corner;
    span.low = span.low.cwiseMin(along);
    span.high = span.high.cwiseMax(along);
  }
  return span;
}

}  // namespace

Result<OrientedBox> oriented_box(std::span<const Eigen::Vector3f> points) {
  const Result<ConvexHull> hull = convex_hull(points);
  if (!hull) return fail("no oriented box", hull.error());
  std::vector<Vector3> corners;
  Vector3 mean = Vector3::Zero();
  for (const std::uint32_t vertex : hull->vertices) {
    corners.emplace_back(points[vertex].cast<double>());
    mean += corners.back();
  }
  mean /= static_cast<double>(corners.size());
  const Matrix3 unsorted = principal_axes(corners, mean);
  const Span first = span_along(unsorted, corners);
  const Matrix3 axes = sorted_axes(unsorted, first.high - first.low);
  const Span span = span_along(axes, corners);
  return OrientedBox{Pose(axes, axes * (span.low + span.high) / 2.0), span.high - span.low};
}

}  // namespace adit
