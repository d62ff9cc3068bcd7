// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/odometry/scan_to_planes.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <numbers>

#include "adit/core/parallel.hpp"

namespace adit {
namespace {

// Points of a part of the parallel loop.
constexpr std::size_t kGrain = 32;
// Smaller patches follow rough walls better; a tenth is the unevenness of blasted rock.
constexpr PlaneLimits kPatch{0.7, 0.1};
// The map's planes are those around the points at the prediction. Should the scan move farther than this from
// there, voxels, they are looked up once more.
constexpr double kFar = 0.2;
// Below this share of the usual points near a plane the prediction is poor.
constexpr double kPoor = 0.9;

using Planes = std::vector<std::optional<MapPlane>>;

Planes planes_around(std::span<const Eigen::Vector3f> source, const LocalMap& map, const Pose& T_map_base) {
  Planes planes(source.size());
  const Eigen::Matrix3f R = T_map_base.rotation_matrix().cast<float>();
  const Eigen::Vector3f t = T_map_base.translation().cast<float>();
  parallel_for_each(
      source.size(), [&](std::size_t i) { planes[i] = plane_at(map, R * source[i] + t, kPatch); }, kGrain);
  return planes;
}

double share_found(const Planes& planes) {
  const auto found = std::ranges::count_if(planes, [](const auto& plane) { return plane.has_value(); });
  return static_cast<double>(found) / static_cast<double>(std::max<std::size_t>(1, planes.size()));
}

std::vector<PlaneRow> rows_of(std::span<const Eigen::Vector3f> source, const Planes& planes,
                              const Pose& T_map_base) {
  const Matrix3 R = T_map_base.rotation_matrix();
  std::vector<PlaneRow> rows;
  rows.reserve(source.size());
  for (std::size_t i = 0; i < source.size(); ++i)
    if (planes[i])
      rows.push_back(plane_row(source[i].cast<double>(), *planes[i], R, T_map_base.translation()));
  return rows;
}

NormalEquations<6> linearize_planes(const std::vector<PlaneRow>& rows, double sigma) {
  const double scale = 9.0 * sigma * sigma;
  NormalEquations<6> out;
  for (const PlaneRow& row : rows) {
    const double r2 = row.residual * row.residual;
    const double root = scale / (scale + r2);
    const double weight = root * root / (sigma * sigma);
    out.H.selfadjointView<Eigen::Lower>().rankUpdate(row.jacobian, weight);
    out.g += weight * row.residual * row.jacobian;
    out.squared_residuals += r2;
  }
  out.H = out.H.selfadjointView<Eigen::Lower>();
  out.num_correspondences = static_cast<int>(rows.size());
  return out;
}

// Gauss-Newton with these planes, from `out.T_map_base` on.
void refine(std::span<const Eigen::Vector3f> source, const Planes& planes, const Pose& T_prediction,
            const Matrix6& information, double sigma, const ScanToMapConfig& config, PlaneAlignment& out) {
  for (int i = 0; i < config.max_iterations; ++i) {
    const NormalEquations<6> equations = linearize_planes(rows_of(source, planes, out.T_map_base), sigma);
    const Vector6 off = (T_prediction.inverse() * out.T_map_base).log();
    const Vector6 step = (equations.H + information).ldlt().solve(-(equations.g + information * off));
    ++out.iterations;
    if (!step.allFinite()) {
      out.status = StepStatus::diverged;
      return;
    }
    out.T_map_base = out.T_map_base * Pose::exp(step);
    if (step.norm() < config.convergence) return;
  }
}

}  // namespace

Fields fields_of(WheelNoise& c) {
  return {{"slip", &c.slip, "", 1e-4, 1.0, "forward, in each metre driven"},
          {"sideways", &c.sideways, "", 1e-4, 1.0, "sideways, in each metre"},
          {"climb", &c.climb, "", 1e-4, 10.0, "up and down, in each metre"},
          {"tilt_deg", &c.tilt_deg, "deg/m", 1e-3, 360.0, "roll and pitch, in each metre"},
          {"heading_deg", &c.heading_deg, "deg/m", 1e-3, 360.0, "heading, in each metre"},
          {"turn", &c.turn, "", 1e-4, 1.0, "of the angle turned"}};
}

Matrix6 wheel_information(const WheelNoise& noise, const Pose& T_last_now) {
  // What encoder ticks and the clock leave open of a robot that hardly moves.
  constexpr double kFloor = 0.001;       // metres
  constexpr double kTurnFloor = 0.0002;  // radians
  constexpr double kSlipFloor = 2 * kFloor;
  const double distance = T_last_now.translation().norm();
  const double deg = std::numbers::pi / 180.0;
  const double tilt = noise.tilt_deg * deg * distance + 2 * kTurnFloor;
  Vector6 sigma;
  sigma << noise.slip * distance + kSlipFloor, noise.sideways * distance + kFloor,
      noise.climb * distance + kFloor, tilt, tilt,
      noise.heading_deg * deg * distance + noise.turn * T_last_now.angle() + kTurnFloor;
  return sigma.array().square().inverse().matrix().asDiagonal();
}

PlaneAlignment align_planes(std::span<const Eigen::Vector3f> source, const LocalMap& map,
                            const Pose& T_prediction, const Matrix6& information, double sigma,
                            double usual_share, const ScanToMapConfig& config) {
  PlaneAlignment out;
  out.T_map_base = T_prediction;
  Planes planes = planes_around(source, map, T_prediction);
  if (share_found(planes) < kPoor * usual_share) {
    const Alignment coarse = align_rigid(source, map, T_prediction, map.voxel_size(), config);
    out.iterations = coarse.iterations;
    if (coarse.status == StepStatus::ok) {
      Planes at_coarse = planes_around(source, map, coarse.T_map_base);
      if (share_found(at_coarse) > share_found(planes)) {
        out.T_map_base = coarse.T_map_base;
        planes = std::move(at_coarse);
      }
    }
  }
  const Pose T_looked_up = out.T_map_base;
  refine(source, planes, T_prediction, information, sigma, config, out);
  if ((T_looked_up.inverse() * out.T_map_base).translation().norm() > kFar * map.voxel_size()) {
    planes = planes_around(source, map, out.T_map_base);
    refine(source, planes, T_prediction, information, sigma, config, out);
  }
  if ((T_prediction.inverse() * out.T_map_base).translation().norm() > config.max_correction)
    out.status = StepStatus::diverged;
  if (out.status == StepStatus::diverged) {
    out.T_map_base = T_prediction;
    return out;
  }
  const std::vector<PlaneRow> rows = rows_of(source, planes, out.T_map_base);
  out.num_correspondences = static_cast<int>(rows.size());
  out.share_near = share_found(planes);
  out.seen = observability(rows, source, 1.0, config.degeneracy_threshold);
  return out;
}

}  // namespace adit
