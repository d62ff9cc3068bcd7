// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/odometry/observability.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <map>

#include "adit/core/check.hpp"
#include "adit/core/decompositions.hpp"
#include "adit/core/parallel.hpp"
#include "adit/geometry/voxel_grid.hpp"
#include "adit/odometry/fixed_directions.hpp"

namespace adit {
namespace {

// Correspondences: some hundreds of normals judge a direction as well as thousands.
constexpr std::size_t kMaxSamples = 512;
// Samples per part of the parallel loop.
constexpr std::size_t kSamplesPerPart = 32;
// Points of a patch: a plane fits any five or fewer too well.
constexpr std::size_t kMinPlanePoints = 6;
// Variance along the second axis of a patch over that along the first. With less than a fifth of the extent
// the patch is a line (one scan ring), whose normal is arbitrary.
constexpr double kMinPatchRatio = 0.04;
// Square metres: no sensor, and no map of 0.2 m spacing, is better than a centimetre.
constexpr double kMinVariance = 1e-4;
// Metres: the edge of a region whose residuals err alike.
constexpr double kRegion = 2.0;
// Metres: levers of a scene that lies on an axis.
constexpr double kMinLever = 1.0;

std::vector<PlaneResidual> sampled_residuals(std::span<const Eigen::Vector3f> source, const LocalMap& map,
                                             const Pose& T_map_base, float max_distance) {
  const Matrix3 R = T_map_base.rotation_matrix();
  const Vector3& t = T_map_base.translation();
  const std::size_t stride = source.size() / kMaxSamples + 1;
  std::vector<std::optional<PlaneResidual>> residuals((source.size() + stride - 1) / stride);
  parallel_for_each(
      residuals.size(),
      [&](std::size_t i) {
        const Vector3 p = source[i * stride].cast<double>();
        const auto neighbour = map.nearest((R * p + t).cast<float>(), max_distance);
        if (!neighbour) return;
        const auto plane = plane_at(map, neighbour->point, {});
        if (plane) residuals[i] = plane_residual(R, t, {neighbour->point.cast<double>(), plane->normal}, p);
      },
      kSamplesPerPart);
  std::vector<PlaneResidual> found;
  for (const std::optional<PlaneResidual>& residual : residuals)
    if (residual) found.push_back(*residual);
  return found;
}

// Root-mean-square distance of the points from each of the three axes, metres.
Vector3 lever_arms(std::span<const Eigen::Vector3f> source) {
  Vector3 squares = Vector3::Zero();
  for (const Eigen::Vector3f& p : source) squares += p.cast<double>().array().square().matrix();
  squares /= static_cast<double>(std::max<std::size_t>(1, source.size()));
  return (squares.sum() - squares.array()).max(kMinLever * kMinLever).sqrt();
}

}  // namespace

std::optional<Plane> plane_at(const LocalMap& map, const Eigen::Vector3f& place, const PlaneLimits& limits) {
  const auto radius = static_cast<float>(limits.radius * map.voxel_size());
  const LocalMap::Moments around = map.moments_within(place, radius);
  if (around.count < static_cast<int>(kMinPlanePoints)) return {};
  const Vector3 mean = around.sum.cast<double>() / around.count;
  Eigen::SelfAdjointEigenSolver<Matrix3> eigen;
  eigen.computeDirect(around.squares.cast<double>() / around.count - mean * mean.transpose());
  const Vector3& extents = eigen.eigenvalues();
  if (extents[1] < kMinPatchRatio * extents[2] || extents[0] > limits.thickness * extents[1]) return {};
  return Plane{place.cast<double>() + mean, eigen.eigenvectors().col(0)};
}

Observability observability(std::span<const Eigen::Vector3f> source, const LocalMap& map,
                            const Pose& T_map_base, double max_distance, double degeneracy_threshold) {
  // A sample represents the correspondences that the stride leaves out.
  const std::size_t stride = source.size() / kMaxSamples + 1;
  return observability(sampled_residuals(source, map, T_map_base, static_cast<float>(max_distance)), source,
                       static_cast<double>(stride), degeneracy_threshold);
}

Observability observability(const std::vector<PlaneResidual>& residuals,
                            std::span<const Eigen::Vector3f> source, double weight,
                            double degeneracy_threshold) {
  Observability out;
  if (residuals.size() < kMinPlanePoints) return out;
  Vector6 scale = Vector6::Ones();
  scale.tail<3>() = lever_arms(source);
  Matrix6 mean = Matrix6::Zero();
  double variance = 0.0;
  for (const PlaneResidual& residual : residuals) {
    const Vector6 j = residual.jacobian.cwiseQuotient(scale);
    mean += j * j.transpose();
    variance += residual.value * residual.value;
  }
  const auto count = static_cast<double>(residuals.size());
  mean /= count;
  variance = std::max(variance / count, kMinVariance);

  const auto [values, vectors] = symmetric_eigen(mean);
  out.weakest = std::max(0.0, values[0]);
  out.degenerate = out.weakest < degeneracy_threshold;
  const double scaled_weight = weight * count / variance;
  const Vector6 kept = (values.array() < degeneracy_threshold).select(0.0, scaled_weight * values);
  const Matrix6 V = scale.asDiagonal() * vectors;
  out.information = V * kept.asDiagonal() * V.transpose();
  const Vector6 is_fixed = (values.array() < degeneracy_threshold).select(Vector6::Zero(), Vector6::Ones());
  out.onto_fixed = scale.cwiseInverse().asDiagonal() * vectors * is_fixed.asDiagonal() * vectors.transpose() *
                   scale.asDiagonal();
  return out;
}

Matrix6 information_by_regions(const std::vector<PlaneResidual>& residuals,
                               std::span<const Eigen::Vector3f> points, const Matrix6& onto_fixed) {
  ADIT_CHECK(residuals.size() == points.size(), "a point for each residual");
  const VoxelGrid regions(kRegion);
  Matrix6 H = Matrix6::Zero();
  std::map<VoxelKey, Vector6> gradients;
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    const auto& [value, jacobian] = residuals[i];
    const std::optional<VoxelKey> region = regions.key_of(points[i]);
    if (!region) continue;
    H += jacobian * jacobian.transpose();
    gradients.try_emplace(*region, Vector6::Zero()).first->second += value * jacobian;
  }
  // The floor keeps it defined where there are fewer regions than directions.
  Matrix6 squares = kMinVariance * H;
  for (const auto& [region, g] : gradients) squares += g * g.transpose();
  const FixedDirections fixed(onto_fixed.transpose() * H * onto_fixed);
  const FixedDirections::Block within = fixed.of_information(H);
  return fixed.information(within * inverse(fixed.of_information(squares)) * within);
}

}  // namespace adit
