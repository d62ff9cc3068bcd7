// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// From recordings to one map per robot.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "adit/core/records.hpp"
#include "adit/slam/slam_config.hpp"

namespace adit {

/// The map of one robot, reduced to the keyframes of the policy, and the odometry that made it.
struct MappedRobot {
  std::shared_ptr<const RobotMap> map;    ///< Without keyframes where the policy left none.
  std::string odometry;                   ///< The method that ran.
  std::string lidar;                      ///< As the recording names it; "" when unknown.
  std::optional<Pose> T_base_lidar = {};  ///< The mount, if recorded clouds are in its frame.
};

/// A recording that could not be mapped.
struct FailedRobot {
  std::string name;    ///< That of the recording.
  std::string reason;  ///< One line that names the robot.
};

/// Their reasons, apart by semicolons.
[[nodiscard]] std::string reasons_of(const std::vector<FailedRobot>& failed);

/// What became of all recordings.
struct Mapping {
  std::vector<MappedRobot> robots;  ///< In the order of the recordings, and so are the ids.
  std::vector<FailedRobot> failed;  ///< In the order of the recordings; their ids stay free.
  std::vector<std::string> notes;   ///< What the user should know although nothing failed, one line each.
};

/// Maps all robots, in parallel, as one phase of progress that counts scans; may throw `Cancelled`
/// (core/progress.hpp). A recording without wheel odometry is mapped by kiss-icp, with a note. Wheels and
/// IMUs are checked first (robot/sensor_checks.hpp); what is found is noted. A robot whose
/// recording cannot be mapped stops no other: it is reported in `failed`. Fails on more than 256 recordings
/// (ids are one byte) and, with all reasons, where no robot is left. `num_before`: robots that have ids
/// already, from 0 on.
[[nodiscard]] Result<Mapping> map_robots(const std::vector<Recording>& given, const SlamConfig& config,
                                         std::size_t num_before = 0);

/// The number of scans of all recordings together.
[[nodiscard]] std::size_t num_scans(const std::vector<Recording>& recordings);

}  // namespace adit
