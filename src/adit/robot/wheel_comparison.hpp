// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "adit/robot/motion_growth.hpp"
#include "adit/robot/sensor_checks.hpp"

namespace adit {

/// How findings name what the wheels were compared with.
struct WheelReference {
  std::string_view turns;   ///< "the gyroscope"
  std::string_view ahead;   ///< "the accelerometer"
  std::string_view remedy;  ///< "--mount or --imu-mount if one of these is wrong"
  std::string_view mount;   ///< "--imu-mount"
};

/// What comparing the wheels with another sensor has shown.
struct WheelComparison {
  TurnComparison turns;             ///< Judged only where it has_curves().
  bool is_backward = false;         ///< They count backward as forward.
  std::optional<double> ahead;      ///< Metres driven per metre that they count; none where nothing is known.
  double clock_tolerance_s = 0.04;  ///< Two steps of the grid of rates.

  /// By how much the wheels' stamps are too late; 0 within the tolerance, or where no shift explains much.
  /// To be asked where turns.agrees().
  [[nodiscard]] double late_s() const;
};

/// Takes the wheels out of the recording or moves their stamps by what was found, and says so.
[[nodiscard]] std::vector<SensorFinding> judge_wheels(Recording& recording, const WheelComparison& comparison,
                                                      const WheelReference& reference);

}  // namespace adit
