// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "adit/keyframes/keyframe_policy.hpp"
#include "adit/keyframes/scan_view.hpp"
#include "adit/odometry/methods.hpp"
#include "adit/odometry/path_uncertainty.hpp"
#include "adit/robot/robot_map.hpp"
#include "adit/robot/scan_loop.hpp"

namespace adit {

/// How one robot makes its map from its scans.
struct RobotSlamConfig {
  OdometryConfig odometry;
  KeyframePolicyConfig keyframes;
  ConfirmConfig confirm;
  TunnelFilterConfig tunnel_filter;  ///< Of the paper's policies, which select keyframes of the map.
  /// A VLP-16 looks 15 degrees up, an OS2 11, a Livox Mid-360 52 (decision 0051).
  ScanContextConfig scan_context{.max_elevation_deg = 15.0};
  PathNoise noise;
  double cloud_voxel = 0.15;  ///< Keyframe clouds are thinned to one point per voxel of this edge, metres.
};
/// Keys of all members but `cloud_voxel` begin with their names.
Fields fields_of(RobotSlamConfig& config);

/// What became of one scan.
struct RobotStep {
  OdometryStep odometry;                    ///< Whether it was registered, and where.
  std::optional<KeyframeId> keyframe = {};  ///< Set when this scan became one.
};

/// SLAM of one robot on its own: scan -> odometry -> keyframe with its descriptor. Loops with other robots
/// are found by fleet/.
///
/// A keyframe has the returns that others confirm: their neighbours in the scan, and the scans of the
/// keyframes before and after it, which would look through the place of what moves. The newest keyframe
/// therefore still loses returns when the next one comes.
class RobotSlam {
 public:
  /// Throws ContractViolation when `config` is out of its documented ranges.
  RobotSlam(RobotId id, const std::string& name, const RobotSlamConfig& config, const Pose& T_base_lidar);
  /// The same with an odometry of one's own instead of the one that `config` names.
  RobotSlam(RobotId id, const std::string& name, const RobotSlamConfig& config, const Pose& T_base_lidar,
            std::unique_ptr<Odometry> odometry);

  /// `motion`: what other sensors measured from the scan before to this one.
  RobotStep process(const Scan& scan, const SensedMotion& motion);

  /// Of all scans so far. Only the newest keyframe may still change.
  [[nodiscard]] const RobotMap& map() const { return map_; }

 private:
  /// The scan of a keyframe at full density, base frame.
  struct Look {
    PointCloud cloud;
    ScanView view;
    Pose T_odom_base;
    std::optional<Vector3> up;
    std::size_t num_returns = 0;  ///< Before those left that nothing confirms.
  };
  static std::size_t remove_seen_through(Look& look, const Look& other);

  void note_slip(const OdometryStep& step);
  void add_keyframe(const OdometryStep& step);
  [[nodiscard]] Look look_of(const OdometryStep& step) const;
  void describe_keyframe(std::size_t k, const Look& look);

  RobotSlamConfig config_;
  std::unique_ptr<Odometry> odometry_;
  KeyframePolicy keyframe_policy_;
  PathUncertainty uncertainty_;
  std::optional<Look> last_look_;  ///< Of the newest keyframe.
  RobotMap map_;
};

/// Fails where the odometry needs wheels and the recording has none. The message recommends `without_wheels`,
/// the option that selects an odometry without wheels.
[[nodiscard]] Result<> check_wheels(const Recording& recording, const OdometryConfig& config,
                                    std::string_view without_wheels);

/// Puts KISS-ICP into `config` in place of another method where the recording has neither wheels nor an IMU:
/// plane-icp needs none either, but loses its way where scans do not come at a steady pace. Returns the note
/// that says so, which names the recording; none where nothing was changed.
[[nodiscard]] std::optional<std::string> use_kiss_icp_without_sensors(const Recording& recording,
                                                                      OdometryConfig& config);

/// Called after each scan with the number done; returns false to stop early.
using ScanObserver = std::function<bool(std::size_t num_done)>;

/// The whole recording through RobotSlam. Fails when a scan cannot be read (of damaged
/// recordings, give it what with_damaged_scans_empty returns), when the odometry needs wheels and there is no
/// wheel odometry, when no scan could be registered (wheels alone make no map), or when the observer stops
/// it.
[[nodiscard]] Result<RobotMap> map_recording(const Recording& recording, RobotId id,
                                             const RobotSlamConfig& config,
                                             const ScanObserver& observer = {});
/// The same under several configurations: one map per configuration, and every scan is read once.
[[nodiscard]] Result<std::vector<RobotMap>> map_recording(const Recording& recording, RobotId id,
                                                          const std::vector<RobotSlamConfig>& configs,
                                                          const ScanObserver& observer = {});

}  // namespace adit
