// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/odometry/kiss_icp.hpp"

#include "adit/odometry/preprocess.hpp"

namespace adit {
namespace {

// Sum of squared distances to the map, a voxel at most for each point.
double misfit(const Alignment& alignment, const ThinnedScan& scan, const LocalMap& map) {
  const double reach = map.voxel_size();
  Correspondences pairs(scan.source, map, reach);
  const auto fit = linearize_rigid(pairs, alignment.T_map_base, reach);
  const auto lost = static_cast<double>(scan.source.size()) - fit.num_correspondences;
  return fit.squared_residuals + lost * reach * reach;
}

}  // namespace

KissIcp::KissIcp(const KissIcpConfig& config, const Pose& T_base_lidar)
    : config_(config),
      T_base_lidar_(T_base_lidar),
      map_(config.voxel_size, config.max_points_per_voxel),
      threshold_(config.initial_threshold, config.min_motion, config.max_range) {}

OdometryStep KissIcp::register_scan(const Scan& scan) {
  ADIT_CHECK(!stamp_ || *stamp_ < scan.stamp, "the stamps of scans ascend");
  const Pose T_prediction = motion_ ? T_odom_base_ * motion_->T_start_end : T_odom_base_;
  preprocess(scan.cloud, {config_.min_range, config_.max_range}, T_base_lidar_,
             config_.deskew ? motion_ : std::nullopt, cloud_);
  irregular_ =
      config_.irregular_steps == "on" || (config_.irregular_steps == "auto" && !scan.cloud.has_times());
  const ThinnedScan thin = thinned(cloud_.points, config_.voxel_size, thinner_);
  OdometryStep step = map_.empty() ? first_step(thin, T_prediction, config_) : registered(thin, T_prediction);
  step.stamp = scan.stamp;
  step.is_guess = irregular_;
  update_map(map_, thin, step, config_);
  if (stamp_) motion_ = {T_odom_base_.inverse() * step.T_odom_base, scan.stamp - *stamp_};
  stamp_ = scan.stamp;
  T_odom_base_ = step.T_odom_base;
  return step;
}

Alignment KissIcp::align(const ThinnedScan& scan, const Pose& T_prediction) const {
  Alignment predicted = align_rigid(scan.source, map_, T_prediction, threshold_.sigma(), config_);
  if (!irregular_) return predicted;
  Alignment rival = align_rigid(scan.source, map_, T_odom_base_, threshold_.sigma(), config_);
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
  return step_of(alignment, scan.source, map_, 3.0 * sigma, config_);
}

}  // namespace adit
