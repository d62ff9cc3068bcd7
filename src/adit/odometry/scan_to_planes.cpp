// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/odometry/scan_to_planes.hpp"

#include <algorithm>

#include "adit/core/angles.hpp"
#include "adit/core/decompositions.hpp"
#include "adit/core/parallel.hpp"
#include "adit/core/robust_kernel.hpp"

namespace adit {
namespace {

// Points per part of the parallel loop.
constexpr std::size_t kPointsPerPart = 32;
// Patches of 0.7 voxels follow rough walls better than whole ones; a tenth of thickness is the unevenness of
// blasted rock.
constexpr PlaneLimits kPatch{.radius = 0.7, .thickness = 0.1};
// Voxels. The map's planes are those around the points at the prediction; should the scan move farther than
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

double share_found(const Planes& planes) {
  const auto found = std::ranges::count_if(planes, [](const auto& plane) { return plane.has_value(); });
  return static_cast<double>(found) / static_cast<double>(std::max<std::size_t>(1, planes.size()));
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

NormalEquations<6> linearize_planes(const std::vector<PlaneResidual>& residuals, double sigma) {
  const double scale = kKernelSigmas * kKernelSigmas * sigma * sigma;
  NormalEquations<6> out;
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

// Gauss-Newton with these planes, on from the pose of `so_far`.
PlaneAlignment refined(const Problem& problem, const Planes& planes, PlaneAlignment so_far) {
  const PosePrior& prior = problem.prior;
  for (int i = 0; i < problem.config.max_iterations; ++i) {
    const NormalEquations<6> equations =
        linearize_planes(residuals_at(problem.source, planes, so_far.T_map_base), problem.sigma);
    const Vector6 off = (prior.T_map_base.inverse() * so_far.T_map_base).log();
    const Vector6 step =
        solve_symmetric(equations.H + prior.information, -(equations.g + prior.information * off));
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

Fields fields_of(WheelNoise& c) {
  return {{"slip", &c.slip, "", 1e-4, 1.0, "forward, per metre driven"},
          {"sideways", &c.sideways, "", 1e-4, 1.0, "sideways, per metre"},
          {"climb", &c.climb, "", 1e-4, 10.0, "up and down, per metre"},
          {"tilt_deg", &c.tilt_deg, "deg/m", 1e-3, 360.0, "roll and pitch, per metre"},
          {"heading_deg", &c.heading_deg, "deg/m", 1e-3, 360.0, "heading, per metre"},
          {"turn", &c.turn, "", 1e-4, 1.0, "heading again, share of the angle turned"}};
}

Matrix6 wheel_information(const WheelNoise& noise, const Pose& T_last_now) {
  // Encoder ticks and the clock leave this much open for a robot that hardly moves.
  constexpr double kFloor = 0.001;       // metres
  constexpr double kTurnFloor = 0.0002;  // radians
  constexpr double kSlipFloor = 2 * kFloor;
  const double distance = T_last_now.translation().norm();
  const double tilt = noise.tilt_deg * kDegree * distance + 2 * kTurnFloor;
  Vector6 sigma;
  sigma << noise.slip * distance + kSlipFloor, noise.sideways * distance + kFloor,
      noise.climb * distance + kFloor, tilt, tilt,
      noise.heading_deg * kDegree * distance + noise.turn * T_last_now.angle() + kTurnFloor;
  return sigma.array().square().inverse().matrix().asDiagonal();
}

PlaneAlignment align_point_to_plane(std::span<const Eigen::Vector3f> source, const LocalMap& map,
                                    const PosePrior& prior, double sigma, const ScanToMapConfig& config) {
  const Problem problem{source, map, prior, sigma, config};
  auto [T_start, planes, iterations] = start_of(problem);
  PlaneAlignment out;
  out.T_map_base = T_start;
  out.iterations = iterations;
  out = refined(problem, planes, out);
  if ((T_start.inverse() * out.T_map_base).translation().norm() > kLookUpAgain * map.voxel_size()) {
    planes = planes_around(source, map, out.T_map_base);
    out = refined(problem, planes, out);
  }
  if ((prior.T_map_base.inverse() * out.T_map_base).translation().norm() > config.max_correction)
    out.status = StepStatus::diverged;
  if (out.status == StepStatus::diverged) {
    out.T_map_base = prior.T_map_base;
    return out;
  }
  const std::vector<PlaneResidual> residuals = residuals_at(source, planes, out.T_map_base);
  out.num_correspondences = static_cast<int>(residuals.size());
  out.share_near = share_found(planes);
  out.seen = observability(residuals, source, 1.0, config.degeneracy_threshold);
  return out;
}

}  // namespace adit
