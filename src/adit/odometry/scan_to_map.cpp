// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/odometry/scan_to_map.hpp"

#include <Eigen/Cholesky>
#include <algorithm>

#include "adit/core/angles.hpp"
#include "adit/core/decompositions.hpp"
#include "adit/core/parallel.hpp"
#include "adit/core/simd.hpp"

namespace adit {
namespace {

// Number of point blocks per part of the parallel sums; fixed, so that no result depends on the number of
// threads.
constexpr std::size_t kBlocksPerPart = 2;
// Square metres: the floor (1 um)^2 of the mean squared residual keeps the weight of the wheels finite.
constexpr double kMinSquaredResidual = 1e-12;

using simd::Double4;
using simd::fours;

constexpr std::size_t kFours = Correspondences::kBlock / 4;

// J^T W J and J^T W r of a block, from the moments of its points: with J = [I, -hat(p)], hat(p)^T hat(p) =
// |p|^2 I - p p^T.
struct RigidSums {
  double weights, squares, found;
  double x, y, z;                 // w p
  double xx, xy, xz, yy, yz, zz;  // w p p^T
  double rx, ry, rz;              // w r
  double cx, cy, cz;              // w p x r
};

ADIT_WIDE_VECTORS void sum_rigid(const Correspondences::Block& block, double kernel_scale, RigidSums& out) {
  const Double4* p[3] = {fours(block.px), fours(block.py), fours(block.pz)};
  const Double4* r[3] = {fours(block.rx), fours(block.ry), fours(block.rz)};
  Double4 weight[kFours];
  Double4 weights = {}, squares = {}, found = {};
  Double4 x = {}, y = {}, z = {};
  Double4 rx = {}, ry = {}, rz = {};
  for (std::size_t i = 0; i < kFours; ++i) {
    const Double4 r2 = r[0][i] * r[0][i] + r[1][i] * r[1][i] + r[2][i] * r[2][i];
    const Double4 root = kernel_scale / (kernel_scale + r2);
    const Double4 w = fours(block.found)[i] * root * root;
    weight[i] = w;
    weights += w;
    squares += r2;
    found += fours(block.found)[i];
    x += w * p[0][i];
    y += w * p[1][i];
    z += w * p[2][i];
    rx += w * r[0][i];
    ry += w * r[1][i];
    rz += w * r[2][i];
  }
  Double4 xx = {}, xy = {}, xz = {}, yy = {}, yz = {}, zz = {};
  Double4 cx = {}, cy = {}, cz = {};
  for (std::size_t i = 0; i < kFours; ++i) {
    const Double4 wx = weight[i] * p[0][i];
    const Double4 wy = weight[i] * p[1][i];
    const Double4 wz = weight[i] * p[2][i];
    xx += wx * p[0][i];
    xy += wx * p[1][i];
    xz += wx * p[2][i];
    yy += wy * p[1][i];
    yz += wy * p[2][i];
    zz += wz * p[2][i];
    cx += wy * r[2][i] - wz * r[1][i];
    cy += wz * r[0][i] - wx * r[2][i];
    cz += wx * r[1][i] - wy * r[0][i];
  }
  out = {simd::sum(weights), simd::sum(squares), simd::sum(found),  //
         simd::sum(x),       simd::sum(y),       simd::sum(z),      //
         simd::sum(xx),      simd::sum(xy),      simd::sum(xz),
         simd::sum(yy),      simd::sum(yz),      simd::sum(zz),  //
         simd::sum(rx),      simd::sum(ry),      simd::sum(rz),  //
         simd::sum(cx),      simd::sum(cy),      simd::sum(cz)};
}

ScanEquations<6> rigid_equations(const Correspondences::Block& block, double kernel_scale) {
  RigidSums s;
  sum_rigid(block, kernel_scale, s);
  ScanEquations<6> out;
  out.H.topLeftCorner<3, 3>().diagonal().setConstant(s.weights);
  out.H.topRightCorner<3, 3>() = -so3::hat({s.x, s.y, s.z});
  out.H.bottomLeftCorner<3, 3>() = so3::hat({s.x, s.y, s.z});
  out.H.bottomRightCorner<3, 3>() << s.yy + s.zz, -s.xy, -s.xz,  //
      -s.xy, s.xx + s.zz, -s.yz,                                 //
      -s.xz, -s.yz, s.xx + s.yy;
  out.g << s.rx, s.ry, s.rz, s.cx, s.cy, s.cz;
  out.squared_residuals = s.squares;
  out.num_correspondences = static_cast<int>(s.found);
  return out;
}

// J^T J and J^T r of a block, with J = [1, -y; 0, x; 0, 0].
struct UnicycleSums {
  double found, squares;
  double y, xx_yy;  // -J^T J off its diagonal, and its last element
  double rx, c;     // J^T r
};

ADIT_WIDE_VECTORS void sum_unicycle(const Correspondences::Block& block, UnicycleSums& out) {
  const Double4* p[2] = {fours(block.px), fours(block.py)};
  const Double4* r[3] = {fours(block.rx), fours(block.ry), fours(block.rz)};
  Double4 found = {}, squares = {}, y = {}, xx_yy = {}, rx = {}, c = {};
  for (std::size_t i = 0; i < kFours; ++i) {
    const Double4 f = fours(block.found)[i];
    found += f;
    squares += r[0][i] * r[0][i] + r[1][i] * r[1][i] + r[2][i] * r[2][i];
    y += f * p[1][i];
    xx_yy += f * (p[0][i] * p[0][i] + p[1][i] * p[1][i]);
    rx += r[0][i];
    c += p[0][i] * r[1][i] - p[1][i] * r[0][i];
  }
  out = {simd::sum(found), simd::sum(squares), simd::sum(y), simd::sum(xx_yy), simd::sum(rx), simd::sum(c)};
}

ScanEquations<2> unicycle_equations(const Correspondences::Block& block) {
  UnicycleSums s;
  sum_unicycle(block, s);
  ScanEquations<2> out;
  out.H << s.found, -s.y, -s.y, s.xx_yy;
  out.g << s.rx, s.c;
  out.squared_residuals = s.squares;
  out.num_correspondences = static_cast<int>(s.found);
  return out;
}

// The sum of `equations(block)` over all blocks of the source.
template <class Equations, class Each>
Equations sum_of_blocks(Correspondences& pairs, const Pose& T_map_base, const Each& equations) {
  return parallel_sum(pairs.num_blocks(), kBlocksPerPart, Equations{},
                      [&](std::size_t begin, std::size_t end) {
                        Equations sum;
                        Correspondences::Block block;
                        for (std::size_t i = begin; i < end; ++i) {
                          pairs.residuals(i, T_map_base, block);
                          sum += equations(block);
                        }
                        return sum;
                      });
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
    if (!finite || !is_within_trust(T_prediction.inverse() * out.T_map_base, config))
      return {T_prediction, StepStatus::diverged, out.num_correspondences, out.iterations};
    if (step.norm() < config.convergence) break;
  }
  return out;
}

}  // namespace

Fields fields_of(ScanToMapConfig& c) {
  return {{"voxel_size", &c.voxel_size, "m", 0.01, 10.0,
           "edge of a map voxel; scans are thinned to 0.5 and 1.5 of it"},
          {"max_range", &c.max_range, "m", 1.0, 1000.0,
           "points beyond this range are dropped, and so is the map"},
          {"min_range", &c.min_range, "m", 0.0, 100.0, "points nearer than this are dropped"},
          {"max_points_per_voxel", &c.max_points_per_voxel, "", 1, 200, "points kept per map voxel"},
          {"deskew", &c.deskew, "", 0, 1, "remove the motion within the sweep where points carry times"},
          {"max_iterations", &c.max_iterations, "", 1, 10000, "Gauss-Newton iterations per scan, at most"},
          {"convergence", &c.convergence, "", 1e-9, 1.0,
           "norm of the last step [m; rad] at which iterating stops"},
          {"min_correspondences", &c.min_correspondences, "", 6, 100000, "fewer leave the scan unregistered"},
          {"max_correction", &c.max_correction, "m", 0.01, 1000.0,
           "larger corrections of the predicted position count as divergence"},
          {"max_turn_deg", &c.max_turn_deg, "deg", 0.1, 180.0,
           "and so do larger corrections of the predicted orientation"},
          {"degeneracy_threshold", &c.degeneracy_threshold, "", 0.0, 0.33,
           "share of the information (1/3 = even) below which a direction counts as open"}};
}

bool is_within_trust(const Pose& correction, const ScanToMapConfig& config) {
  return correction.translation().norm() <= config.max_correction &&
         correction.angle() <= config.max_turn_deg * kDegree;
}

ScanEquations<6> linearize_rigid(Correspondences& pairs, const Pose& T_map_base, double kernel_scale) {
  return sum_of_blocks<ScanEquations<6>>(pairs, T_map_base, [&](const Correspondences::Block& block) {
    return rigid_equations(block, kernel_scale);
  });
}

ScanEquations<2> linearize_unicycle(Correspondences& pairs, const Pose& T_map_base) {
  return sum_of_blocks<ScanEquations<2>>(pairs, T_map_base, unicycle_equations);
}

Alignment align_point_to_point(std::span<const Eigen::Vector3f> source, const LocalMap& map,
                               const Pose& T_prediction, double sigma, const ScanToMapConfig& config) {
  Correspondences pairs(source, map, 3.0 * sigma);
  return gauss_newton(
      T_prediction, config, [&](const Pose& T_map_base) { return linearize_rigid(pairs, T_map_base, sigma); },
      [](const ScanEquations<6>& equations) -> Vector6 {
        return solve_symmetric(equations.H, -equations.g);
      });
}

Alignment align_unicycle(std::span<const Eigen::Vector3f> source, const LocalMap& map,
                         const Pose& T_prediction, double max_distance, const ScanToMapConfig& config,
                         bool by_wheels) {
  // Beside H(0, 0) / n, which is 1 as each point moves by what the robot does. Undamped, points along a
  // smooth wall would carry the robot wherever noise points.
  constexpr double kDamping = 0.05;
  Correspondences pairs(source, map, max_distance);
  std::optional<double> beta;
  if (!by_wheels) beta = kDamping;
  return gauss_newton(
      T_prediction, config, [&](const Pose& T_map_base) { return linearize_unicycle(pairs, T_map_base); },
      [&](const ScanEquations<2>& equations) -> Vector6 {
        const double n = equations.num_correspondences;
        if (!beta) beta = 1.0 / (equations.squared_residuals / n + kMinSquaredResidual);
        Eigen::Matrix2d H = equations.H / n;
        H(0, 0) += *beta;
        const Eigen::Vector2d u = H.ldlt().solve(-equations.g / n);
        return (Vector6() << u[0], 0.0, 0.0, 0.0, 0.0, u[1]).finished();
      });
}

ThinnedScan thinned_twice(std::span<const Eigen::Vector3f> points_base, double voxel_size,
                          VoxelThinner& thinner) {
  ThinnedScan out;
  for (const std::uint32_t i : thinner.first_in_voxel(points_base, 0.5 * voxel_size))
    out.map_points.push_back(points_base[i]);
  for (const std::uint32_t i : thinner.first_in_voxel(out.map_points, 1.5 * voxel_size))
    out.source.push_back(out.map_points[i]);
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
