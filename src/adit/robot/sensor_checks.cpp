// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/robot/sensor_checks.hpp"

#include <algorithm>
#include <iterator>

namespace adit {

std::vector<SensorFinding> use_sound_sensors(Recording& recording) {
  std::vector<SensorFinding> findings;
  for (const auto check :
       {check_coverage, check_imu_alone, check_wheels_alone, check_wheels_with_imu, check_wheels_with_scans})
    std::ranges::move(check(recording), std::back_inserter(findings));
  return findings;
}

}  // namespace adit
