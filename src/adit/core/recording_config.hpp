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

/// How many columns RecordingConfig::bin_columns can state.
///@{
inline constexpr int kLeastBinColumns = 3;
inline constexpr int kMostBinColumns = 8;
///@}

/// How the joints of wheels move the robot, for wheels that are recorded as sensor_msgs/JointState
/// (io/joint_odometry.hpp). Names of joints are apart by commas; a minus in front turns a joint round.
struct JointDriveConfig {
  std::string left = {};      ///< Wheels on the left.
  std::string right = {};     ///< Wheels on the right.
  std::string steering = {};  ///< Joints that steer the front wheels. "": the robot turns by its wheels.
  double wheel_radius = 0.0;  ///< Metres; 0: not stated, like the next two.
  double track_width = 0.0;   ///< Metres, from the left to the right wheels.
  double wheelbase = 0.0;     ///< Metres, from the axle that does not steer to the one that does.
  double axle_x = 0.0;        ///< Of the axle that does not steer, in the base frame, metres.
};

/// The keys of RecordingConfig::drive. They point into `c`, which must outlive them.
[[nodiscard]] inline Fields fields_of(JointDriveConfig& c) {
  return {
      {"left", &c.left, "", 0, 0,
       "joints of the wheels on the left, apart by commas, for wheels that are recorded as JointState; a "
       "minus "
       "in front of a name turns it round"},
      {"right", &c.right, "", 0, 0, "joints of the wheels on the right"},
      {"steering", &c.steering, "", 0, 0,
       "joints that steer (Ackermann); empty: the robot turns by the difference of its wheels"},
      {"wheel_radius", &c.wheel_radius, "m", 0, 10, "radius of the wheels"},
      {"track_width", &c.track_width, "m", 0, 50,
       "distance of the left from the right wheels; of skid-steered robots the one with which turns come out "
       "right, often 1.5 to 2 times as wide"},
      {"wheelbase", &c.wheelbase, "m", 0, 50,
       "distance of the axle that does not steer from the one that does (Ackermann)"},
      {"axle_x", &c.axle_x, "m", -50, 50, "x of the axle that does not steer in the robot's frame"}};
}

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
  /// Topics of the links between frames, apart by commas. "": all that are called tf or tf_static.
  std::string tf = {};
  JointDriveConfig drive = {};  ///< Where `wheel` is of joints.
  std::string truth = {};  ///< Topic of ground truth. "": the only one whose name says so; "none": without.
  /// Unit of the times of points, "s", "ms", "us" or "ns". "": as found (io/packed_cloud.hpp).
  std::string point_times = {};
  /// Name of the field with the times of points, in PointCloud2, .pcd and .ply. "": as found
  /// (io/packed_cloud.hpp).
  std::string point_time_field = {};
  int bin_columns = 0;  ///< Of .bin clouds, 3 to 8. 0: as found (io/kitti.hpp).
  /// "start": a sweep's stamp is that of its start, or of wherever its points' times are 0; "end": of its
  /// end, while the times count from its start; "auto": as found (io/bag_recording.hpp).
  std::string stamp_at = "auto";
  /// Topics of the robot begin with this and a slash, "/husky1", beside /tf_static. "": all are the robot's.
  std::string topics_under = {};
  bool namespaces =
      false;  ///< A bag has a robot in every namespace that has clouds (namespaces_of, io/bag_topics.hpp).
};

/// Keys without a prefix, those of `drive` with "drive.". They point into `c`, which must outlive them.
[[nodiscard]] inline Fields fields_of(RecordingConfig& c) {
  Fields fields = {
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
      {"tf", &c.tf, "", 0, 0,
       "topics of the links between frames, apart by commas, /robot/tf with /robot/tf_static; empty: all "
       "that "
       "are called tf or tf_static"},
      {"truth", &c.truth, "", 0, 0,
       "topic of ground truth; empty: the only one whose name says that it is; none: without"},
      {"point_times",
       &c.point_times,
       "",
       0,
       0,
       "unit of the times of points, s, ms, us or ns; empty: the one that makes a sweep last 2 ms to 2 s",
       {"s", "ms", "us", "ns", ""}},
      {"point_time_field", &c.point_time_field, "", 0, 0,
       "field with the times of points, in PointCloud2, .pcd and .ply; empty: the first that is called t, "
       "time, time_offset, offset_time, timestamp or time_stamp"},
      {"bin_columns", &c.bin_columns, "", 0, kMostBinColumns,
       "columns of .bin clouds, 3 to 8: x y z, intensity, and others that are not used; 0: four or five, as "
       "the files show"},
      {"stamp_at",
       &c.stamp_at,
       "",
       0,
       0,
       "start: a sweep's stamp is of its start, or of the moment at which its points' times are 0; end: of "
       "its "
       "end, while the times count from its start; auto: end where messages were recorded before such a "
       "sweep "
       "could have ended, else start",
       {"auto", "start", "end"}},
      {"topics_under", &c.topics_under, "", 0, 0,
       "the robot's topics begin with this and a slash, as '/husky1'; empty: all topics are the robot's"},
      {"namespaces", &c.namespaces, "", 0, 0,
       "a bag has a robot in every namespace that has clouds, each named after its namespace"}};
  append(fields, "drive", fields_of(c.drive));
  return fields;
}

}  // namespace adit
