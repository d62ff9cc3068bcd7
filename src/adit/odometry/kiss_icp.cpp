// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/odometry/kiss_icp.hpp"

#include "adit/odometry/preprocess.hpp"

namespace adit {
namespace {

// Sum of squared distances from the map, square metres; a point counts at most the square of a voxel.
double misfit(const Alignment& alignment, const ThinnedScan& scan, const LocalMap& map) {
  const double reach = map.voxel_size();
  Correspondences pairs(scan.source, map, reach);
  const auto fit = linearize_rigid(pairs, alignment.T_map_base, reach);
  const auto lost = static_cast<double>(scan.source.size()) - fit.num_correspondences;
  return fit.squared_residuals + lost * reach * reach;
}

bool are_irregular(IrregularSteps steps, const Scan& scan) {
  return steps == IrregularSteps::on || (steps == IrregularSteps::automatic && !scan.cloud.has_times());
}

}  // namespace

std::string_view to_string(IrregularSteps steps) {
  switch (steps) {
    case IrregularSteps::automatic:
      return "auto";
    case IrregularSteps::on:
      return "on";
    case IrregularSteps::off:
      return "off";
  }
  return "unknown";
}

Fields fields_of(KissIcpConfig& c) {
  Fields fields = fields_of(c.scan_to_map);
  fields.push_back(
      {"initial_threshold", &c.initial_threshold, "m", 0.01, 100.0, "first sigma of the motion model"});
  fields.push_back({"min_motion", &c.min_motion, "m", 0.0, 10.0, "smaller deviations do not train sigma"});
  fields.push_back(
      enum_field("irregular_steps", &c.irregular_steps, kIrregularSteps,
                 "also start from the last pose and keep the better fit, for scans that do not come at a "
                 "steady pace; auto: where points carry no times"));
  return fields;
}

KissIcp::KissIcp(const KissIcpConfig& config, const Pose& T_base_lidar)
    : config_(config),
      T_base_lidar_(T_base_lidar),
      map_(config.scan_to_map.voxel_size, config.scan_to_map.max_points_per_voxel),
      threshold_(config.initial_threshold, config.min_motion, config.scan_to_map.max_range) {}

OdometryStep KissIcp::register_scan(const Scan& scan, const SensedMotion& /*motion*/) {
  const Pose T_prediction = motion_.T_odom_base() * motion_.until(scan.stamp);
  const ScanToMapConfig& config = config_.scan_to_map;
  preprocess(scan.cloud, {config.min_range, config.max_range}, T_base_lidar_,
             config.deskew && motion_.last() ? std::optional(sweep_of(*motion_.last())) : std::nullopt,
             cloud_);
  irregular_ = are_irregular(config_.irregular_steps, scan);
  const ThinnedScan thin = thinned_twice(cloud_.points, config.voxel_size, thinner_);
  OdometryStep step = map_.empty() ? first_step(thin, T_prediction, config) : registered(thin, T_prediction);
  step.stamp = scan.stamp;
  step.is_guess = irregular_;
  update_map(map_, thin, step, config);
  motion_.arrive(scan.stamp, step.T_odom_base);
  return step;
}

Alignment KissIcp::align(const ThinnedScan& scan, const Pose& T_prediction) const {
  const auto align_from = [&](const Pose& T_start) {
    return align_point_to_point(scan.source, map_, T_start, threshold_.sigma(), config_.scan_to_map);
  };
  Alignment predicted = align_from(T_prediction);
  if (!irregular_) return predicted;
  Alignment rival = align_from(motion_.T_odom_base());
  if (rival.status != StepStatus::ok) return predicted;
  if (predicted.status != StepStatus::ok) return rival;
  return misfit(rival, scan, map_) < misfit(predicted, scan, map_) ? rival : predicted;
}

OdometryStep KissIcp::registered(const ThinnedScan& scan, const Pose& T_prediction) {
  const double sigma = threshold_.sigma();
  const Alignment alignment = align(scan, T_prediction);
  if (alignment.status == StepStatus::ok)
    threshold_.add(T_prediction.inverse() * alignment.T_map_base);
  else
    threshold_.failed();
  OdometryStep step = step_of(alignment, scan.source, map_, 3.0 * sigma, config_.scan_to_map);
  step.correction = (T_prediction.inverse() * step.T_odom_base).log();
  return step;
}

}  // namespace adit
