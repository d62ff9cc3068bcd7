// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/odometry/observability.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>

#include "adit/core/parallel.hpp"

namespace adit {
namespace {

// A direction is judged by some hundreds of normals as well as by thousands.
constexpr std::size_t kMaxSamples = 512;
// Samples of a part of the parallel loop.
constexpr std::size_t kGrain = 32;
// Below six points a plane fits anything.
constexpr int kMinPlanePoints = 6;
// A patch whose second extent is less than a fifth of its first is a line (one scan ring): its normal is
// chance.
constexpr double kMinPatchRatio = 0.04;
// No sensor and no map of 0.2 m spacing is better than a centimetre.
constexpr double kMinVariance = 1e-4;

std::vector<PlaneRow> plane_rows(std::span<const Eigen::Vector3f> source, const LocalMap& map,
                                 const Pose& T_map_base, float max_distance) {
  const Matrix3 R = T_map_base.rotation_matrix();
  const std::size_t stride = source.size() / kMaxSamples + 1;
  std::vector<std::optional<PlaneRow>> rows((source.size() + stride - 1) / stride);
  parallel_for_each(
      rows.size(),
      [&](std::size_t i) {
        const Vector3 p = source[i * stride].cast<double>();
        const Vector3 at = R * p + T_map_base.translation();
        const auto neighbour = map.nearest(at.cast<float>(), max_distance);
        if (!neighbour) return;
        const auto plane = plane_at(map, neighbour->point, {});
        if (plane)
          rows[i] =
              plane_row(p, {neighbour->point.cast<double>(), plane->normal}, R, T_map_base.translation());
      },
      kGrain);
  std::vector<PlaneRow> found;
  for (const std::optional<PlaneRow>& row : rows)
    if (row) found.push_back(*row);
  return found;
}

// Root-mean-square distance of the points from each of the three axes; at least a metre, for a scene on the
// axis.
Vector3 lever_arms(std::span<const Eigen::Vector3f> source) {
  Vector3 squares = Vector3::Zero();
  for (const Eigen::Vector3f& p : source) squares += p.cast<double>().array().square().matrix();
  squares /= static_cast<double>(std::max<std::size_t>(1, source.size()));
  return (squares.sum() - squares.array()).max(1.0).sqrt();
}

}  // namespace

std::optional<MapPlane> plane_at(const LocalMap& map, const Eigen::Vector3f& place,
                                 const PlaneLimits& limits) {
  const auto radius = static_cast<float>(limits.radius * map.voxel_size());
  const LocalMap::Moments around = map.moments_within(place, radius);
  if (around.count < kMinPlanePoints) return {};
  const Vector3 mean = around.sum.cast<double>() / around.count;
  Eigen::SelfAdjointEigenSolver<Matrix3> eigen;
  eigen.computeDirect(around.squares.cast<double>() / around.count - mean * mean.transpose());
  const Vector3& extents = eigen.eigenvalues();
  if (extents[1] < kMinPatchRatio * extents[2] || extents[0] > limits.thickness * extents[1]) return {};
  return MapPlane{place.cast<double>() + mean, eigen.eigenvectors().col(0)};
}

PlaneRow plane_row(const Vector3& point, const MapPlane& plane, const Matrix3& R_map_base,
                   const Vector3& t_map_base) {
  const Vector3 n = R_map_base.transpose() * plane.normal;
  return {(Vector6() << n, point.cross(n)).finished(),
          plane.normal.dot(R_map_base * point + t_map_base - plane.point)};
}

Observability observability(std::span<const Eigen::Vector3f> source, const LocalMap& map,
                            const Pose& T_map_base, double max_distance, double degeneracy_threshold) {
  // The samples speak for as many correspondences as the stride left out.
  const std::size_t stride = source.size() / kMaxSamples + 1;
  return observability(plane_rows(source, map, T_map_base, static_cast<float>(max_distance)), source,
                       static_cast<double>(stride), degeneracy_threshold);
}

Observability observability(const std::vector<PlaneRow>& rows, std::span<const Eigen::Vector3f> source,
                            double weight_of_row, double degeneracy_threshold) {
  Observability out;
  if (rows.size() < kMinPlanePoints) return out;
  Vector6 scale = Vector6::Ones();
  scale.tail<3>() = lever_arms(source);
  Matrix6 mean = Matrix6::Zero();
  double variance = 0.0;
  for (const PlaneRow& row : rows) {
    const Vector6 j = row.jacobian.cwiseQuotient(scale);
    mean += j * j.transpose();
    variance += row.residual * row.residual;
  }
  const auto count = static_cast<double>(rows.size());
  mean /= count;
  variance = std::max(variance / count, kMinVariance);

  const Eigen::SelfAdjointEigenSolver<Matrix6> eigen(mean);
  out.weakest = std::max(0.0, eigen.eigenvalues()[0]);
  out.degenerate = out.weakest < degeneracy_threshold;
  const double weight = weight_of_row * count / variance;
  const Vector6 kept =
      (eigen.eigenvalues().array() < degeneracy_threshold).select(0.0, weight * eigen.eigenvalues());
  const Matrix6 V = scale.asDiagonal() * eigen.eigenvectors();
  out.information = V * kept.asDiagonal() * V.transpose();
  return out;
}

}  // namespace adit
