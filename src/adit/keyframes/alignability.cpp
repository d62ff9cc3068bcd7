// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/keyframes/alignability.hpp"

#include <Eigen/Eigenvalues>

#include "adit/geometry/normals.hpp"
#include "adit/geometry/voxel_grid.hpp"

namespace adit {

std::optional<Alignability> alignability(std::span<const Eigen::Vector3f> normals) {
  Matrix3 information = Matrix3::Zero();
  std::size_t num_normals = 0;
  for (const Eigen::Vector3f& normal : normals) {
    if (!normal.allFinite() || normal.isZero()) continue;
    const Vector3 n = normal.cast<double>().normalized();
    information += n * n.transpose();
    ++num_normals;
  }
  if (num_normals == 0) return std::nullopt;
  const Eigen::SelfAdjointEigenSolver<Matrix3> solver(information / static_cast<double>(num_normals));
  return Alignability{solver.eigenvalues().cwiseMax(0.0), solver.eigenvectors()};
}

std::optional<Alignability> alignability_of_points(std::span<const Eigen::Vector3f> points, double voxel) {
  PointCloud cloud;
  cloud.points.assign(points.begin(), points.end());
  const PointCloud means = voxel_centroids(cloud, voxel);
  return alignability(estimate_normals(means.points, static_cast<float>(2.5 * voxel)));
}

}  // namespace adit
