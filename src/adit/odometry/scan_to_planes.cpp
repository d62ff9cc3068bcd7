// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/odometry/scan_to_planes.hpp"

#include <algorithm>
#include <cmath>

#include "adit/core/decompositions.hpp"
#include "adit/core/parallel.hpp"
#include "adit/core/robust_kernel.hpp"
#include "adit/odometry/adaptive_threshold.hpp"

namespace adit {
namespace {

// Points per part of the parallel loop.
constexpr std::size_t kPointsPerPart = 32;
// Patches of 0.7 voxels follow rough walls better than whole ones; a tenth of thickness is the unevenness of
// blasted rock.
constexpr PlaneLimits kPatch{.radius = 0.7, .thickness = 0.1};
// Voxels. The map's planes are those around the points at the prediction; should the points move farther than
// this from there, they are looked up once more.
constexpr double kLookUpAgain = 0.2;
// Share of the usual points near a plane below which the prediction is poor.
constexpr double kPoorShare = 0.9;
// The kernel's scale, standard deviations.
constexpr double kKernelSigmas = 3.0;

using Planes = std::vector<std::optional<Plane>>;

// The problem at hand: what is aligned with what.
struct Problem {
  std::span<const Eigen::Vector3f> source;
  const LocalMap& map;
  const PosePrior& prior;
  double sigma;
  const ScanToMapConfig& config;
};

Planes planes_around(std::span<const Eigen::Vector3f> source, const LocalMap& map, const Pose& T_map_base) {
  Planes planes(source.size());
  const Eigen::Matrix3f R = T_map_base.rotation_matrix().cast<float>();
  const Eigen::Vector3f t = T_map_base.translation().cast<float>();
  parallel_for_each(
      source.size(), [&](std::size_t i) { planes[i] = plane_at(map, R * source[i] + t, kPatch); },
      kPointsPerPart);
  return planes;
}

int num_found(const Planes& planes) {
  return static_cast<int>(std::ranges::count_if(planes, [](const auto& plane) { return plane.has_value(); }));
}

double share_found(const Planes& planes) {
  return num_found(planes) / static_cast<double>(std::max<std::size_t>(1, planes.size()));
}

// Metres, the root mean square.
double usual_range(std::span<const Eigen::Vector3f> source) {
  double squares = 0.0;
  for (const Eigen::Vector3f& p : source) squares += p.cast<double>().squaredNorm();
  return std::sqrt(squares / static_cast<double>(std::max<std::size_t>(1, source.size())));
}

std::vector<PlaneResidual> residuals_at(std::span<const Eigen::Vector3f> source, const Planes& planes,
                                        const Pose& T_map_base) {
  const Matrix3 R = T_map_base.rotation_matrix();
  std::vector<PlaneResidual> residuals;
  residuals.reserve(source.size());
  for (std::size_t i = 0; i < source.size(); ++i)
    if (planes[i])
      residuals.push_back(plane_residual(R, T_map_base.translation(), *planes[i], source[i].cast<double>()));
  return residuals;
}

std::vector<Eigen::Vector3f> points_near(std::span<const Eigen::Vector3f> source, const Planes& planes) {
  std::vector<Eigen::Vector3f> near;
  near.reserve(source.size());
  for (std::size_t i = 0; i < source.size(); ++i)
    if (planes[i]) near.push_back(source[i]);
  return near;
}

ScanEquations<6> linearize_planes(const std::vector<PlaneResidual>& residuals, double sigma) {
  const double scale = kKernelSigmas * kKernelSigmas * sigma * sigma;
  ScanEquations<6> out;
  for (const PlaneResidual& residual : residuals) {
    const double r2 = residual.value * residual.value;
    const double root = geman_mcclure_root(scale, r2);
    const double weight = root * root / (sigma * sigma);
    out.H.selfadjointView<Eigen::Lower>().rankUpdate(residual.jacobian, weight);
    out.g += weight * residual.value * residual.jacobian;
    out.squared_residuals += r2;
  }
  out.H = out.H.selfadjointView<Eigen::Lower>();
  out.num_correspondences = static_cast<int>(residuals.size());
  return out;
}

// What the residuals say in the directions that the scene fixes. In the others they say little, and that is
// wrong: rings that repeat from scan to scan fit best where they were (solution remapping: J. Zhang, M.
// Kaess, S. Singh, "On degeneracy of optimization-based state estimation problems", ICRA 2016).
void take_out_open_directions(const Observability& seen, ScanEquations<6>& equations) {
  if (!seen.degenerate) return;
  equations.H = (seen.onto_fixed.transpose() * equations.H * seen.onto_fixed).eval();
  equations.g = (seen.onto_fixed.transpose() * equations.g).eval();
}

// Gauss-Newton with these planes, on from the pose of `so_far`.
PlaneAlignment refined(const Problem& problem, const Planes& planes, PlaneAlignment so_far) {
  so_far.seen = observability(residuals_at(problem.source, planes, so_far.T_map_base), problem.source, 1.0,
                              problem.config.degeneracy_threshold);
  for (int i = 0; i < problem.config.max_iterations; ++i) {
    ScanEquations<6> equations =
        linearize_planes(residuals_at(problem.source, planes, so_far.T_map_base), problem.sigma);
    take_out_open_directions(so_far.seen, equations);
    equations += linearize_prior(problem.prior, so_far.T_map_base);
    const Vector6 step = solve_symmetric(equations.H, -equations.g);
    ++so_far.iterations;
    if (!step.allFinite()) {
      so_far.status = StepStatus::diverged;
      break;
    }
    so_far.T_map_base = so_far.T_map_base * Pose::exp(step);
    if (step.norm() < problem.config.convergence) break;
  }
  return so_far;
}

// Where to start from, and the planes there.
struct Start {
  Pose T_map_base;
  Planes planes;
  int iterations = 0;  // of point-to-point ICP
};

// The prediction, or where point-to-point ICP ends if that puts more points near a plane.
Start start_of(const Problem& problem) {
  const auto& [source, map, prior, sigma, config] = problem;
  Start out{prior.T_map_base, planes_around(source, map, prior.T_map_base)};
  if (share_found(out.planes) >= kPoorShare * prior.usual_share) return out;
  const Alignment coarse = align_point_to_point(source, map, prior.T_map_base, map.voxel_size(), config);
  out.iterations = coarse.iterations;
  if (coarse.status != StepStatus::ok) return out;
  Planes at_coarse = planes_around(source, map, coarse.T_map_base);
  if (share_found(at_coarse) > share_found(out.planes))
    return {coarse.T_map_base, std::move(at_coarse), coarse.iterations};
  return out;
}

}  // namespace

ScanEquations<6> linearize_prior(const PosePrior& prior, const Pose& T_map_base) {
  const Vector6 off = (prior.T_map_base.inverse() * T_map_base).log();
  const Matrix6 J = Pose::right_jacobian_inverse(off);
  ScanEquations<6> out;
  out.H = J.transpose() * prior.information * J;
  out.g = J.transpose() * prior.information * off;
  return out;
}

PlaneAlignment align_point_to_plane(std::span<const Eigen::Vector3f> source, const LocalMap& map,
                                    const PosePrior& prior, double sigma, const ScanToMapConfig& config) {
  const Problem problem{source, map, prior, sigma, config};
  auto [T_start, planes, iterations] = start_of(problem);
  PlaneAlignment out;
  out.T_map_base = T_start;
  out.iterations = iterations;
  out = refined(problem, planes, out);
  const double moved = point_deviation(T_start.inverse() * out.T_map_base, usual_range(source));
  if (moved > kLookUpAgain * map.voxel_size()) {
    planes = planes_around(source, map, out.T_map_base);
    out = refined(problem, planes, out);
  }
  out.num_correspondences = num_found(planes);
  if (out.num_correspondences < config.min_correspondences)
    out.status = StepStatus::too_few_points;
  else if (!is_within_trust(prior.T_map_base.inverse() * out.T_map_base, config))
    out.status = StepStatus::diverged;
  if (out.status != StepStatus::ok) {
    out.T_map_base = prior.T_map_base;
    return out;
  }
  const std::vector<PlaneResidual> residuals = residuals_at(source, planes, out.T_map_base);
  out.seen.information = information_by_regions(residuals, points_near(source, planes), out.seen.onto_fixed);
  ScanEquations<6> at_end = linearize_planes(residuals, sigma);
  take_out_open_directions(out.seen, at_end);
  out.information = at_end.H;
  out.share_near = share_found(planes);
  return out;
}

}  // namespace adit
