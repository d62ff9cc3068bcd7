// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// What spoils a map, looked for in a recording before an hour is spent on it.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "adit/core/recording_config.hpp"
#include "adit/core/records.hpp"
#include "adit/io/bag.hpp"
#include "adit/robot/robot_slam.hpp"

namespace adit {

/// What a finding means for the map.
enum class Health : std::uint8_t {
  good,     ///< Nothing is wrong.
  noted,    ///< A map can be made; it may be worse than it could be.
  spoils,   ///< A map made of this is bent, or none is made.
  unknown,  ///< The recording does not tell.
};
/// good, noted, spoils, unknown.
[[nodiscard]] std::string_view to_string(Health health);

/// One check of a recording and its outcome.
struct Diagnosis {
  std::string check;             ///< What was looked at: "mount: tilt".
  Health health = Health::good;  ///< What it means for the map.
  std::string sentence;          ///< What was found, with the numbers.
  std::string remedy = {};       ///< What to do; "" where nothing is to be done.
};

/// What a recording was read from, by which some remedies differ.
enum class RecordedAs : std::uint8_t {
  bag,               ///< Of topics.
  folder_of_clouds,  ///< With files beside them.
};

/// Scans (missing ones, times of points, ranges, view, parts of the robot in it), the mount (tilt and height
/// by the floor; turn and lever arm by the motion between scans and the wheels), wheels and IMU
/// (check_sensors, and their clock by the scans), and whether map_recording under `config` makes a map of
/// some stretches of scans, in a fixed order, one line a check whatever it found. Reads some 40 scans and
/// registers some 700. Directions are in the axes of the levelled mount. Fails where a scan cannot be read,
/// or all are empty.
[[nodiscard]] Result<std::vector<Diagnosis>> diagnose(const Recording& recording,
                                                      const RobotSlamConfig& config = {},
                                                      RecordedAs recorded_as = RecordedAs::bag);

/// The topics of a bag that adit uses whose stamps and times of recording went at different speeds, one line
/// each.
[[nodiscard]] std::vector<Diagnosis> diagnose_clocks(const Bag& bag, const RecordingConfig& config);

}  // namespace adit
