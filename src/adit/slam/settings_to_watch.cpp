// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/slam/settings_to_watch.hpp"

#include <array>

#include "adit/core/format.hpp"

namespace adit {
namespace {

constexpr std::array kSettings = {
    SettingToWatch{"check_sensors", "wheels or an IMU known to be good are left out: false",
                   "the notes of `adit slam`, and the error of the odometry (`adit evaluate`)"},
    SettingToWatch{"robot.cloud_voxel",
                   "maps too large for a robot's disk: larger, up to "
                   "`loops.adaptive.registration.voxel_size`, by which scans are compared",
                   "the size of ROBOT/map.adit"},
    SettingToWatch{"robot.odometry.plane_icp.voxel_size", "narrow passages: smaller; halls: larger",
                   "scans that were not registered, time per scan"},
    SettingToWatch{"robot.odometry.plane_icp.min_range", "the robot sees itself: beyond its own parts",
                   "the finding on self-hits of `adit doctor`"},
    SettingToWatch{"robot.odometry.plane_icp.wheels.slip", "tracks, mud or loose rock: larger",
                   "the drift of the odometry along smooth tubes"},
    SettingToWatch{"robot.odometry.plane_icp.wheels.turn", "skid steering: larger",
                   "the error of headings after turns (`adit evaluate`)"},
    SettingToWatch{"robot.odometry.plane_icp.imu.gyroscope", "the data sheet of the IMU says otherwise",
                   "whether the IMU is used (notes of `adit slam`)"},
    SettingToWatch{"robot.odometry.plane_icp.imu.accelerometer", "the same",
                   "the same, and the tilt of floors"},
    SettingToWatch{"robot.keyframes.distance_m",
                   "little memory or radio: larger, though fewer places can then be compared",
                   "the evidence of merges (`adit explain`), and `bytes_sent` in metrics.json"},
    SettingToWatch{"loops.adaptive.candidates", "large maps of places that look alike: more",
                   "the number of loops in `adit explain`; processor time grows with it"},
    SettingToWatch{"loops.adaptive.merge_check.evidence.error_rate",
                   "a wrong merge is worse than many refused ones: smaller; refused ones cost more: larger",
                   "evidence and what is needed in `adit explain`: half the rate asks for 0.7 more"},
    SettingToWatch{"recording.mount", "`adit doctor` finds another mount than the recording has",
                   "`adit doctor` again; floors are level, and each wall is mapped once"},
    SettingToWatch{"recording.point_times", "`adit info` shows another unit than the driver has",
                   "corners that stay sharp where the robot turns"},
    SettingToWatch{
        "recording.stamp_at", "the driver stamps the end of a sweep",
        "the offset between the clocks of wheels and scans that `adit doctor` finds where the robot turns"},
    SettingToWatch{
        "maps.voxel_m",
        "a denser or lighter cloud; below `robot.cloud_voxel` further points come only from keyframes that "
        "overlap",
        "the size of the file"},
    SettingToWatch{"maps.grid.lowest_m", "higher kerbs and rails that the robot climbs",
                   "the occupancy grid, before a robot plans on it"},
    SettingToWatch{"maps.grid.highest_m", "a higher robot or mast", "the same"},
    SettingToWatch{"routes.clearance_m", "narrow drifts that `adit routes` leaves out: less",
                   "the lengths that `adit routes` prints"},
    SettingToWatch{"routes.max_slope_deg", "what the robot climbs", "the same"},
    SettingToWatch{"sight.reach_m", "a LiDAR that sees less far: less, or a map counts as incomplete",
                   "completeness (`adit evaluate --mesh`)"},
};

}  // namespace

std::span<const SettingToWatch> settings_to_watch() { return kSettings; }

std::string markdown_of_settings_to_watch() {
  std::string text =
      "## What users change, and what to watch\n\n| key | change it where | watch |\n| --- | --- | --- |\n";
  for (const SettingToWatch& one : settings_to_watch())
    text += format("| `{}` | {} | {} |\n", one.key, one.when, one.watch);
  return text;
}

}  // namespace adit
