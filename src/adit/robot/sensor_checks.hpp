// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Checks of a recording's wheels and IMU before a map is made of it: units, axes, signs, clocks, gaps.
///
/// What would spoil a map is repaired where the repair is certain (a unit, a clock that is late, a value that
/// jumps), and else its sensor is left out. Wheels and IMU are compared with one another; without an IMU,
/// wheels are compared with some 300 scans. On a drive without curves less can be seen, and slip is left to
/// odometry.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "adit/core/records.hpp"

namespace adit {

/// What is wrong with a sensor.
enum class Finding {
  imu_in_g,               ///< Accelerations in units of gravity.
  imu_without_gravity,    ///< Over the whole drive, or at its start.
  imu_wrong_unit,         ///< Neither m/s^2 nor g.
  imu_in_degrees,         ///< Degrees per second.
  imu_wrong_rates,        ///< Neither radians nor clearly degrees per second.
  imu_wrong_axes,         ///< The mount does not agree with gravity.
  imu_saturated,          ///< Values are cut off at the end of the sensor's range.
  imu_gaps,               ///< Silent for more than 0.1 s.
  imu_silent,             ///< Of most or of all motions from scan to scan nothing was measured.
  imu_bad_covariance,     ///< Zero, huge or not positive definite.
  wheels_reversed,        ///< Forward for backward, or left for right.
  wheels_wrong_scale,     ///< Of turns, or ahead.
  wheels_silent,          ///< Of most or of all motions from scan to scan nothing was measured.
  wheels_frozen,          ///< Their value stops changing at full speed.
  wheels_jump,            ///< Their position changes faster than a robot drives.
  wheels_late,            ///< Or early.
  wheels_contradicted,    ///< They and the gyroscope, or the scans, turn differently.
  wheels_bad_covariance,  ///< Huge, not finite or not positive definite.
};

/// What was done about it.
enum class Consequence {
  noted,     ///< Nothing: the sensor is used as it is.
  repaired,  ///< What is wrong was left out or corrected; the sensor is used.
  left_out,  ///< The sensor is not used.
};

/// One thing that is wrong with a sensor of a recording.
struct SensorFinding {
  Finding finding;                               ///< What is wrong.
  Consequence consequence = Consequence::noted;  ///< What was done to the recording already.
  std::string sentence;                          ///< For people: what, where, what to do.
};

/// Checks the wheels and the IMU of a recording and replaces them by what can be used of them. Findings in a
/// fixed order; none for a recording in which nothing is wrong. A sensor that is not there is not checked.
[[nodiscard]] std::vector<SensorFinding> use_sound_sensors(Recording& recording);

/// Findings, and what the sensors could be compared with.
struct SensorsChecked {
  std::vector<SensorFinding> findings;  ///< Those of use_sound_sensors.
  bool with_imu = false;                ///< There was motion enough to compare the wheels with the IMU.
  bool with_scans = false;              ///< The same of the scans, which are asked where there is no IMU.
};
/// use_sound_sensors, for those who also ask what nothing was found in.
[[nodiscard]] SensorsChecked check_sensors(Recording& recording);

// The parts of it.

/// Whether wheels and IMU measured while scans were taken, as they do not where clocks differ.
[[nodiscard]] std::vector<SensorFinding> check_coverage(Recording& recording);
/// The IMU alone: covariance, gravity, axes, range, gaps, and whether rates agree with how gravity turns.
[[nodiscard]] std::vector<SensorFinding> check_imu_alone(Recording& recording);
/// The wheels alone: values that stay, values that jump, and the covariances that they state.
[[nodiscard]] std::vector<SensorFinding> check_wheels_alone(Recording& recording);

/// What a comparison of the wheels has shown.
struct WheelsCompared {
  std::vector<SensorFinding> findings = {};  ///< None where nothing is wrong, or nothing could be compared.
  bool has_enough = false;                   ///< There was motion enough to compare.
};
/// The wheels' motion against the IMU's: signs, scale, clocks.
[[nodiscard]] WheelsCompared check_wheels_with_imu(Recording& recording);
/// The wheels' motion against that between scans, where there is no IMU: signs, scale, clocks. Registers
/// about 300 scans, where by the wheels the robot turns most; nothing is said where the scans leave a motion
/// open.
[[nodiscard]] WheelsCompared check_wheels_with_scans(Recording& recording);
/// By how many seconds the wheels' stamps are too late by the scans, 0 where that is within what can be told;
/// none where the robot turns too little, or otherwise than the scans have it. The IMU has no say. Registers
/// scans as check_wheels_with_scans does, and changes nothing.
[[nodiscard]] std::optional<double> wheels_late_by_scans(const Recording& recording);

}  // namespace adit
