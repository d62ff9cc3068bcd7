// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/robot/robot_slam.hpp"

#include <algorithm>
#include <map>
#include <memory>

#include "adit/core/format.hpp"
#include "adit/core/parallel.hpp"
#include "adit/geometry/voxel_grid.hpp"
#include "adit/robot/nothing_mapped.hpp"

namespace adit {
namespace {

// A keyframe is described again where at least this share of its returns has left: 16 of 32 000, as many as a
// pedestrian 20 m away has.
constexpr double kWorthDescribing = 5e-4;

RobotSlamConfig checked(RobotSlamConfig config) {
  const Result<> valid = check_fields(fields_of(config));
  ADIT_CHECK(valid.has_value(), valid ? "" : valid.error().message.c_str());
  return config;
}

}  // namespace

Fields fields_of(RobotSlamConfig& c) {
  Fields fields = {
      {"cloud_voxel", &c.cloud_voxel, "m", 0.01, 2.0, "keyframe clouds keep one point per voxel"}};
  append(fields, "odometry", fields_of(c.odometry));
  append(fields, "keyframes", fields_of(c.keyframes));
  append(fields, "confirm", fields_of(c.confirm));
  append(fields, "tunnel_filter", fields_of(c.tunnel_filter));
  append(fields, "scan_context", fields_of(c.scan_context));
  append(fields, "noise", fields_of(c.noise));
  return fields;
}

RobotSlam::RobotSlam(RobotId id, const std::string& name, const RobotSlamConfig& config,
                     const Pose& T_base_lidar)
    : RobotSlam(id, name, config, T_base_lidar, make_odometry(config.odometry, T_base_lidar)) {}

RobotSlam::RobotSlam(RobotId id, const std::string& name, const RobotSlamConfig& config,
                     const Pose& T_base_lidar, std::unique_ptr<Odometry> odometry)
    : config_(checked(config)),
      odometry_(std::move(odometry)),
      keyframe_policy_(config.keyframes),
      uncertainty_(config.noise) {
  map_.id = id;
  map_.name = name;
  map_.viewpoint = T_base_lidar.translation();
  map_.scan_context = config_.scan_context;
}

RobotStep RobotSlam::process(const Scan& scan, const SensedMotion& motion) {
  const OdometryStep step = odometry_->register_scan(scan, motion);
  map_.odometry.push_back({step.stamp, step.T_odom_base});
  map_.num_degenerate += step.status == StepStatus::degenerate ? 1 : 0;
  map_.num_refused +=
      step.status == StepStatus::too_few_points || step.status == StepStatus::diverged ? 1 : 0;
  uncertainty_.add(step);
  if (step.innovation) map_.innovations.push_back(static_cast<float>(*step.innovation));
  note_slip(step);
  if (!keyframe_policy_.accepts(step)) return {step};
  add_keyframe(step);
  return {step, map_.keyframes.back().id};
}

// Steps that follow one another are one stretch.
void RobotSlam::note_slip(const OdometryStep& step) {
  if (step.slip) {
    const Stamp before =
        map_.odometry.size() > 1 ? map_.odometry[map_.odometry.size() - 2].stamp : step.stamp;
    if (map_.slips.empty() || map_.slips.back().end != before) map_.slips.push_back({before, before, 0.0});
    map_.slips.back().end = step.stamp;
    map_.slips.back().counted_m += *step.slip;
  }
}

void RobotSlam::add_keyframe(const OdometryStep& step) {
  Look look = look_of(step);
  if (last_look_) {
    remove_seen_through(look, *last_look_);
    const double removed = static_cast<double>(remove_seen_through(*last_look_, look));
    if (removed > kWorthDescribing * static_cast<double>(last_look_->num_returns))
      describe_keyframe(map_.keyframes.size() - 1, *last_look_);
  }
  const std::size_t k = map_.keyframes.size();
  Keyframe keyframe;
  keyframe.id = {map_.id, static_cast<std::uint32_t>(k)};
  keyframe.stamp = step.stamp;
  keyframe.T_odom_base = step.T_odom_base;
  map_.searchable.push_back(true);
  map_.step_covariances.push_back(map_.keyframes.empty() ? Matrix6(Matrix6::Zero()) : uncertainty_.drift());
  map_.pose_noise.push_back(uncertainty_.pose_noise());
  uncertainty_.begin_edge();
  map_.keyframes.push_back(std::move(keyframe));
  map_.places.emplace_back();
  map_.unconfirmed.emplace_back();
  describe_keyframe(k, look);
  last_look_ = std::move(look);
}

RobotSlam::Look RobotSlam::look_of(const OdometryStep& step) const {
  const PointCloud& full = odometry_->cloud_of_last_scan();
  ScanView view(full.points, map_.viewpoint, config_.confirm);
  const std::vector<std::uint8_t> confirmed = view.confirmed_by_neighbours();
  view.keep(confirmed);
  return {only(full, confirmed), std::move(view), step.T_odom_base, step.up, full.size()};
}

// How many returns it removes.
std::size_t RobotSlam::remove_seen_through(Look& look, const Look& other) {
  constexpr std::size_t kGrain = 2048;
  const Pose T_other_look = other.T_odom_base.inverse() * look.T_odom_base;
  const Eigen::Matrix3f R = T_other_look.rotation_matrix().cast<float>();
  const Eigen::Vector3f t = T_other_look.translation().cast<float>();
  std::vector<std::uint8_t> stays(look.cloud.size());
  parallel_for_each(
      stays.size(),
      [&](std::size_t i) { stays[i] = other.view.looks_through(R * look.cloud.points[i] + t) ? 0 : 1; },
      kGrain);
  const auto removed = static_cast<std::size_t>(std::ranges::count(stays, 0));
  if (removed > 0) look.cloud = only(look.cloud, stays);
  return removed;
}

void RobotSlam::describe_keyframe(std::size_t k, const Look& look) {
  PointCloud thinned = voxel_downsample(look.cloud, config_.cloud_voxel);
  thinned.time_offsets_ns.clear();  // the cloud is deskewed
  // Places are described with z upwards, however the robot stands, where it feels what is up.
  const Pose level = look.up ? levelled(*look.up) : Pose();
  map_.places[k] = describe(transformed(level, look.cloud), config_.scan_context, level * map_.viewpoint);
  // That nothing left a thin scan does not make it a clean one.
  map_.unconfirmed[k].reset();
  if (look.view.is_dense())
    map_.unconfirmed[k] = static_cast<float>(1.0 - static_cast<double>(look.cloud.size()) /
                                                       static_cast<double>(look.num_returns));
  map_.keyframes[k].cloud = std::make_shared<const PointCloud>(std::move(thinned));
}

Result<> check_wheels(const Recording& recording, const OdometryConfig& config,
                      std::string_view without_wheels) {
  if (!config.needs_wheels()) return {};
  if (recording.wheel.empty())
    return fail(format("{}: {} needs wheel odometry and the recording has none; use {}", recording.name,
                       to_string(config.method), without_wheels));
  return {};
}

std::optional<std::string> use_kiss_icp_without_sensors(const Recording& recording, OdometryConfig& config) {
  const bool imu_suffices = !recording.imu.empty() && config.method == OdometryMethod::plane_icp;
  if (!recording.wheel.empty() || imu_suffices || config.method == OdometryMethod::kiss_icp)
    return std::nullopt;
  const std::string_view asked_for = to_string(config.method);
  config.method = OdometryMethod::kiss_icp;
  return format("{}: no wheel odometry in this recording, so kiss-icp (LiDAR alone) instead of {}",
                recording.name, asked_for);
}

Result<RobotMap> map_recording(const Recording& recording, RobotId id, const RobotSlamConfig& config,
                               const ScanObserver& observer) {
  return map_recording(recording, id, std::vector{config}, observer).map([](std::vector<RobotMap>&& maps) {
    return std::move(maps.front());
  });
}

Result<std::vector<RobotMap>> map_recording(const Recording& recording, RobotId id,
                                            const std::vector<RobotSlamConfig>& configs,
                                            const ScanObserver& observer) {
  std::vector<RobotSlam> robots;
  for (const RobotSlamConfig& config : configs) {
    const Result<> wheels = check_wheels(recording, config.odometry, "--set robot.odometry.method=kiss-icp");
    if (!wheels) return tl::unexpected(wheels.error());
    robots.emplace_back(id, recording.name, config, recording.T_base_lidar);
  }
  std::vector<std::map<StepStatus, int>> statuses(robots.size());
  std::size_t num_done = 0;
  const Result<> done = for_each_scan(recording, [&](const Scan& scan, const SensedMotion& motion) {
    for (std::size_t i = 0; i < robots.size(); ++i)
      ++statuses[i][robots[i].process(scan, motion).odometry.status];
    return !observer || observer(++num_done);
  });
  if (!done) return tl::unexpected(done.error());
  std::vector<RobotMap> maps;
  for (std::size_t i = 0; i < robots.size(); ++i) {
    if (robots[i].map().keyframes.empty() || is_nothing_mapped(statuses[i]))
      return fail(why_nothing_mapped(recording));
    maps.push_back(robots[i].map());
  }
  return maps;
}

}  // namespace adit
