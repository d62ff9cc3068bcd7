// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>

#include "adit/core/config.hpp"

namespace adit {

/// As RecordingConfig::imu: do without an IMU.
inline constexpr std::string_view kNoImu = "none";

/// As RecordingConfig::truth: do without ground truth.
inline constexpr std::string_view kNoTruth = "none";

/// As RecordingConfig::wheel: do without wheels.
inline constexpr std::string_view kNoWheel = "none";

/// How recordings are opened (io/recording_files.hpp).
struct RecordingConfig {
  std::string mount =
      {};  ///< Overrides what a recording says of its mount, see io/mount.hpp. "": as it says.
  std::string points = {};  ///< Topic of the clouds, where a file has several. "": the only one.
  std::string wheel =
      {};  ///< Topic of wheel odometry, where a file has several. "": the only one; "none": do without.
  std::string imu =
      {};  ///< Topic of the IMU, where a file has several. "": the only one; "none": do without.
  std::string imu_mount = {};  ///< As `mount`, of the IMU.
  std::string truth = {};  ///< Topic of ground truth. "": the only one whose name says so; "none": without.
  /// Unit of the times of points, "s", "ms", "us" or "ns". "": as found (io/packed_cloud.hpp).
  std::string point_times = {};
  /// "start": a sweep's stamp is that of its start, or of wherever its points' times are 0; "end": of its
  /// end, while the times count from its start.
  std::string stamp_at = "start";
  /// Topics of the robot begin with this and a slash, "/husky1", beside /tf_static. "": all are the robot's.
  std::string topics_under = {};
  bool namespaces =
      false;  ///< A bag has a robot in every namespace that has clouds (namespaces_of, io/bag_topics.hpp).
};

[[nodiscard]] inline Fields fields_of(RecordingConfig& c) {
  return {
      {"mount", &c.mount, "m, deg", 0, 0,
       "pose of the LiDAR on the robot, 'x y z' or 'x y z roll pitch yaw'; empty: as each recording says"},
      {"points", &c.points, "", 0, 0,
       "topic of the clouds, where a recording has several; empty: the only one"},
      {"wheel", &c.wheel, "", 0, 0,
       "topic of the wheel odometry, where a recording has several; empty: the only one; none: without "
       "wheels"},
      {"imu", &c.imu, "", 0, 0,
       "topic of the IMU, where a recording has several; empty: the only one; none: without an IMU"},
      {"imu_mount", &c.imu_mount, "m, deg", 0, 0,
       "pose of the IMU on the robot, as 'mount'; empty: as each recording says"},
      {"truth", &c.truth, "", 0, 0,
       "topic of ground truth; empty: the only one whose name says that it is; none: without"},
      {"point_times", &c.point_times, "", 0, 0,
       "unit of the times of points, s, ms, us or ns; empty: the one that makes a sweep last 2 ms to 2 s"},
      {"stamp_at", &c.stamp_at, "", 0, 0,
       "start: a sweep's stamp is of its start, or of the moment at which its points' times are 0; end: of "
       "its "
       "end, while the times count from its start"},
      {"topics_under", &c.topics_under, "", 0, 0,
       "the robot's topics begin with this and a slash, as '/husky1'; empty: all topics are the robot's"},
      {"namespaces", &c.namespaces, "", 0, 0,
       "a bag has a robot in every namespace that has clouds, each named after its namespace"}};
}

}  // namespace adit
