// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/registration/icp_refine.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "adit/core/parallel.hpp"

namespace adit {
namespace {

constexpr std::size_t kGrain = 512;
constexpr double kAgreeingNormals = 0.8;  ///< Cosine of the angle between them.

struct NormalEquations {
  Matrix6 H = Matrix6::Zero();
  Vector6 g = Vector6::Zero();
  void add(const PlaneResidual& r, double kernel) {
    const double root = kernel * kernel / (kernel * kernel + r.value * r.value);
    H += root * root * r.jacobian.transpose() * r.jacobian;
    g += root * root * r.jacobian.transpose() * r.value;
  }
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
      const Vector3 p_a = a.points[i].cast<double>();
      const Vector3 p_b = b.points[j].cast<double>();
      // Both clouds' planes count (Rusinkiewicz, "A symmetric objective function for ICP", 2019), and only
      // where they agree: far out, a spinning sensor sees the ground as the line of one ring, and that normal
      // is noise.
      const Vector3 n_a = a.normals[i].cast<double>();
      const Vector3 n_b = T_a_b.rotation() * b.normals[j].cast<double>();
      if (std::abs(n_a.dot(n_b)) < kAgreeingNormals) continue;
      sum.add(plane_residual(T_a_b, p_a, n_a, p_b), kernel);
      sum.add(plane_residual(T_a_b, p_a, n_b, p_b), kernel);
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

namespace {

constexpr std::size_t kMaxSourcePoints = 2500;

/// Iterates until the steps are small.
Pose refine_from(const Features& a, const KdTree& tree_a, const Features& b, Pose T_a_b,
                 const RegistrationConfig& config) {
  constexpr std::size_t kMinPairs = 12;
  constexpr double kConvergedStep = 1e-4;
  const double max_distance = config.refine_distance_voxels * config.voxel_size;
  const double kernel = config.refine_kernel_voxels * config.voxel_size;
  const std::size_t stride = b.size() / kMaxSourcePoints + 1;
  for (int iteration = 0; iteration < config.refine_max_iterations; ++iteration) {
    const std::vector<PointPair> pairs = associate(tree_a, b, T_a_b, max_distance, stride);
    if (pairs.size() < kMinPairs) break;
    const Vector6 step = gauss_newton_step(linearize(a, b, pairs, T_a_b, kernel));
    if (!step.allFinite()) break;
    T_a_b = T_a_b * Pose::exp(step);
    if (step.norm() < kConvergedStep) break;
  }
  return T_a_b;
}

/// Share of misfit, 0 (all points on the other cloud's planes) to 1; a point without partner counts in full.
double misfit(const Features& a, const KdTree& tree_a, const Features& b, const Pose& T_a_b,
              const RegistrationConfig& config) {
  const std::size_t stride = b.size() / kMaxSourcePoints + 1;
  const double kernel = config.refine_kernel_voxels * config.voxel_size;
  double fit = 0.0;
  for (const auto& [i, j] :
       associate(tree_a, b, T_a_b, config.refine_distance_voxels * config.voxel_size, stride)) {
    const double r = plane_residual(T_a_b, a.points[i].cast<double>(), a.normals[i].cast<double>(),
                                    b.points[j].cast<double>())
                         .value;
    fit += kernel * kernel / (kernel * kernel + r * r);
  }
  return 1.0 - fit * static_cast<double>(stride) / static_cast<double>(std::max<std::size_t>(b.size(), 1));
}

/// The global result itself, and turned by a degree or so about each axis, either way.
std::vector<Pose> starts_around(const Pose& T_a_b) {
  constexpr double kTurn = 0.02;  // radians: what a global result is off by when it is off
  std::vector<Pose> starts{T_a_b};
  for (int axis = 3; axis < 6; ++axis) {
    for (const double sign : {-1.0, 1.0})
      starts.push_back(T_a_b * Pose::exp(sign * kTurn * Vector6::Unit(axis)));
  }
  return starts;
}

}  // namespace

Pose refine_point_to_plane(const Features& a, const KdTree& tree_a, const Features& b, const Pose& T_a_b,
                           const RegistrationConfig& config) {
  // The rings of a spinning sensor lock onto one another in narrow false minima; several starts and the best
  // fit get out of them.
  std::vector<Pose> refined = starts_around(T_a_b);
  std::vector<double> misfits(refined.size());
  parallel_for_each(refined.size(), [&](std::size_t s) {
    refined[s] = refine_from(a, tree_a, b, refined[s], config);
    misfits[s] = misfit(a, tree_a, b, refined[s], config);
  });
  return refined[static_cast<std::size_t>(std::ranges::min_element(misfits) - misfits.begin())];
}

}  // namespace adit
