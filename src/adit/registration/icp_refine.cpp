// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/registration/icp_refine.hpp"

#include <Eigen/Cholesky>
#include <algorithm>

#include "adit/core/parallel.hpp"

namespace adit {
namespace {

constexpr std::size_t kGrain = 512;

struct NormalEquations {
  Matrix6 H = Matrix6::Zero();
  Vector6 g = Vector6::Zero();
  NormalEquations& operator+=(const NormalEquations& other) {
    H += other.H;
    g += other.g;
    return *this;
  }
};

NormalEquations linearize(const Features& a, const Features& b, const std::vector<PointPair>& pairs,
                          const Pose& T_a_b, double kernel) {
  return parallel_sum(pairs.size(), kGrain, NormalEquations{}, [&](std::size_t begin, std::size_t end) {
    NormalEquations sum;
    for (std::size_t k = begin; k < end; ++k) {
      const auto [i, j] = pairs[k];
      const PlaneResidual r = plane_residual(T_a_b, a.points[i].cast<double>(), a.normals[i].cast<double>(),
                                             b.points[j].cast<double>());
      const double root = kernel * kernel / (kernel * kernel + r.value * r.value);
      sum.H += root * root * r.jacobian.transpose() * r.jacobian;
      sum.g += root * root * r.jacobian.transpose() * r.value;
    }
    return sum;
  });
}

/// Proportional to the mean diagonal of the translational and of the rotational block: free of units.
Vector6 gauss_newton_step(const NormalEquations& sum) {
  constexpr double kDamping = 1e-3;
  Matrix6 H = sum.H;
  H.diagonal().head<3>().array() += kDamping * sum.H.diagonal().head<3>().mean() + 1e-12;
  H.diagonal().tail<3>().array() += kDamping * sum.H.diagonal().tail<3>().mean() + 1e-12;
  return -H.ldlt().solve(sum.g);
}

}  // namespace

PlaneResidual plane_residual(const Pose& T_a_b, const Vector3& p_a, const Vector3& n_a, const Vector3& p_b) {
  const Vector3 n_b = T_a_b.rotation().conjugate() * n_a;
  PlaneResidual out{.value = n_a.dot(T_a_b * p_b - p_a)};
  out.jacobian << n_b.transpose(), p_b.cross(n_b).transpose();
  return out;
}

std::vector<PointPair> associate(const KdTree& tree_a, const Features& b, const Pose& T_a_b,
                                 double max_distance, std::size_t stride) {
  constexpr auto kNone = static_cast<std::uint32_t>(-1);
  const Eigen::Matrix3f R = T_a_b.rotation_matrix().cast<float>();
  const Eigen::Vector3f t = T_a_b.translation().cast<float>();
  std::vector<PointPair> pairs((b.size() + stride - 1) / stride);
  parallel_for_each(
      pairs.size(),
      [&](std::size_t k) {
        const std::size_t j = k * stride;
        const auto nearest = tree_a.nearest(R * b.points[j] + t, static_cast<float>(max_distance));
        pairs[k] = {nearest ? nearest->index : kNone, static_cast<std::uint32_t>(j)};
      },
      kGrain);
  std::erase_if(pairs, [](const PointPair& pair) { return pair.a == kNone; });
  return pairs;
}

Pose refine_point_to_plane(const Features& a, const KdTree& tree_a, const Features& b, Pose T_a_b,
                           const RegistrationConfig& config) {
  constexpr std::size_t kMaxSourcePoints = 2500;
  constexpr std::size_t kMinPairs = 12;
  constexpr double kConvergedStep = 1e-4;
  const double max_distance = config.refine_distance_voxels * config.voxel_size;
  const std::size_t stride = b.size() / kMaxSourcePoints + 1;
  for (int iteration = 0; iteration < config.refine_max_iterations; ++iteration) {
    const std::vector<PointPair> pairs = associate(tree_a, b, T_a_b, max_distance, stride);
    if (pairs.size() < kMinPairs) break;
    const Vector6 step =
        gauss_newton_step(linearize(a, b, pairs, T_a_b, config.refine_kernel_voxels * config.voxel_size));
    if (!step.allFinite()) break;
    T_a_b = T_a_b * Pose::exp(step);
    if (step.norm() < kConvergedStep) break;
  }
  return T_a_b;
}

}  // namespace adit
