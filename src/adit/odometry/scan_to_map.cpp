// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/odometry/scan_to_map.hpp"

#include <Eigen/Cholesky>
#include <algorithm>

#include "adit/core/parallel.hpp"

namespace adit {
namespace {

// Source points a part of the parallel sums; fixed, so that no result depends on the number of threads.
constexpr std::size_t kGrain = 256;

// Calls `add(p, r)` for each source point p with a neighbour q in the map, r = R^T (T p - q): both in the
// base frame, so that a right perturbation of T has the Jacobian [I, -hat(p)] whatever T is, and no lever arm
// to the map's origin spoils the conditioning.
template <class Add>
void for_each_correspondence(std::span<const Eigen::Vector3f> source, const LocalMap& map,
                             const Pose& T_map_base, double max_distance, const Add& add) {
  const Matrix3 R = T_map_base.rotation_matrix();
  const auto reach = static_cast<float>(max_distance);
  for (const Eigen::Vector3f& point : source) {
    const Vector3 p = point.cast<double>();
    const Vector3 at = R * p + T_map_base.translation();
    if (const auto neighbour = map.nearest(at.cast<float>(), reach))
      add(p, Vector3(R.transpose() * (at - neighbour->point.cast<double>())));
  }
}

// Iterates T <- T exp(solve(linearize(T))) from the prediction until the step is small.
template <class Linearize, class Solve>
Alignment gauss_newton(const Pose& T_prediction, const ScanToMapConfig& config, const Linearize& linearize,
                       const Solve& solve) {
  Alignment out{T_prediction};
  while (out.iterations < config.max_iterations) {
    const auto equations = linearize(out.T_map_base);
    out.num_correspondences = equations.num_correspondences;
    ++out.iterations;
    if (equations.num_correspondences < config.min_correspondences)
      return {T_prediction, StepStatus::too_few_points, out.num_correspondences, out.iterations};
    const Vector6 step = solve(equations);
    const bool finite = step.allFinite();
    if (finite) out.T_map_base = out.T_map_base * Pose::exp(step);
    if (!finite || (T_prediction.inverse() * out.T_map_base).translation().norm() > config.max_correction)
      return {T_prediction, StepStatus::diverged, out.num_correspondences, out.iterations};
    if (step.norm() < config.convergence) break;
  }
  return out;
}

}  // namespace

NormalEquations<6> linearize_rigid(std::span<const Eigen::Vector3f> source, const LocalMap& map,
                                   const Pose& T_map_base, double max_distance, double kernel_scale) {
  return parallel_sum(source.size(), kGrain, NormalEquations<6>{}, [&](std::size_t begin, std::size_t end) {
    NormalEquations<6> sum;
    double weights = 0.0;
    Vector3 points = Vector3::Zero();
    Matrix3 moments = Matrix3::Zero();
    const auto add = [&](const Vector3& p, const Vector3& r) {
      const double root = kernel_scale / (kernel_scale + r.squaredNorm());
      const Vector3 wp = root * root * p;
      weights += root * root;
      points += wp;
      moments.noalias() += wp * p.transpose();
      sum.g.head<3>() += root * root * r;
      sum.g.tail<3>() += wp.cross(r);
      sum.squared_residuals += r.squaredNorm();
      ++sum.num_correspondences;
    };
    for_each_correspondence(source.subspan(begin, end - begin), map, T_map_base, max_distance, add);
    // Sum of J^T w J with J = [I, -hat(p)], from the moments: hat(p)^T hat(p) = |p|^2 I - p p^T.
    sum.H.topLeftCorner<3, 3>().diagonal().setConstant(weights);
    sum.H.topRightCorner<3, 3>() = -so3::hat(points);
    sum.H.bottomLeftCorner<3, 3>() = so3::hat(points);
    sum.H.bottomRightCorner<3, 3>() = moments.trace() * Matrix3::Identity() - moments;
    return sum;
  });
}

NormalEquations<2> linearize_unicycle(std::span<const Eigen::Vector3f> source, const LocalMap& map,
                                      const Pose& T_map_base, double max_distance) {
  return parallel_sum(source.size(), kGrain, NormalEquations<2>{}, [&](std::size_t begin, std::size_t end) {
    NormalEquations<2> sum;
    const auto add = [&](const Vector3& p, const Vector3& r) {
      Eigen::Matrix<double, 3, 2> J;
      J << 1.0, -p.y(), 0.0, p.x(), 0.0, 0.0;
      sum.H.noalias() += J.transpose() * J;
      sum.g.noalias() += J.transpose() * r;
      sum.squared_residuals += r.squaredNorm();
      ++sum.num_correspondences;
    };
    for_each_correspondence(source.subspan(begin, end - begin), map, T_map_base, max_distance, add);
    return sum;
  });
}

Pose unicycle_motion(double distance, double turn) {
  return Pose::exp((Vector6() << distance, 0.0, 0.0, 0.0, 0.0, turn).finished());
}

Alignment align_rigid(std::span<const Eigen::Vector3f> source, const LocalMap& map, const Pose& T_prediction,
                      double sigma, const ScanToMapConfig& config) {
  return gauss_newton(
      T_prediction, config,
      [&](const Pose& T_map_base) { return linearize_rigid(source, map, T_map_base, 3.0 * sigma, sigma); },
      [](const NormalEquations<6>& equations) -> Vector6 { return equations.H.ldlt().solve(-equations.g); });
}

Alignment align_unicycle(std::span<const Eigen::Vector3f> source, const LocalMap& map,
                         const Pose& T_prediction, double max_distance, const ScanToMapConfig& config) {
  std::optional<double> beta;
  return gauss_newton(
      T_prediction, config,
      [&](const Pose& T_map_base) { return linearize_unicycle(source, map, T_map_base, max_distance); },
      [&](const NormalEquations<2>& equations) -> Vector6 {
        const double n = equations.num_correspondences;
        // A perfect fit gives an infinite weight to the wheels; the floor (1 um)^2 keeps it a number.
        if (!beta) beta = 1.0 / (equations.squared_residuals / n + 1e-12);
        Eigen::Matrix2d H = equations.H / n;
        H(0, 0) += *beta;
        const Eigen::Vector2d u = H.ldlt().solve(-equations.g / n);
        return (Vector6() << u[0], 0.0, 0.0, 0.0, 0.0, u[1]).finished();
      });
}

ThinnedScan thinned(std::span<const Eigen::Vector3f> points_base, double voxel_size) {
  ThinnedScan out;
  out.map_points = voxel_downsample(points_base, 0.5 * voxel_size);
  out.source = voxel_downsample(out.map_points, 1.5 * voxel_size);
  return out;
}

OdometryStep first_step(const ThinnedScan& scan, const Pose& T_prediction, const ScanToMapConfig& config) {
  OdometryStep step;
  step.T_odom_base = T_prediction;
  const bool enough = scan.source.size() >= static_cast<std::size_t>(config.min_correspondences);
  step.status = enough ? StepStatus::no_map : StepStatus::too_few_points;
  return step;
}

OdometryStep step_of(const Alignment& alignment, std::span<const Eigen::Vector3f> source, const LocalMap& map,
                     double max_distance, const ScanToMapConfig& config) {
  OdometryStep step;
  step.T_odom_base = alignment.T_map_base;
  step.status = alignment.status;
  step.num_correspondences = alignment.num_correspondences;
  step.iterations = alignment.iterations;
  if (alignment.status != StepStatus::ok) return step;
  const Observability seen =
      observability(source, map, alignment.T_map_base, max_distance, config.degeneracy_threshold);
  step.information = seen.information;
  if (seen.degenerate) step.status = StepStatus::degenerate;
  return step;
}

void update_map(LocalMap& map, const ThinnedScan& scan, const OdometryStep& step,
                const ScanToMapConfig& config) {
  if (enters_map(step.status)) map.add(scan.map_points, step.T_odom_base);
  map.remove_beyond(step.T_odom_base.translation().cast<float>(), config.max_range);
}

}  // namespace adit
