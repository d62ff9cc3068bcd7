// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/robot/sensor_checks.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

namespace adit {

SensorsChecked check_sensors(Recording& recording) {
  SensorsChecked checked;
  const auto keep = [&](std::vector<SensorFinding> findings) {
    std::ranges::move(findings, std::back_inserter(checked.findings));
  };
  for (const auto check : {check_coverage, check_imu_alone, check_wheels_alone}) keep(check(recording));
  WheelsCompared with_imu = check_wheels_with_imu(recording);
  keep(std::move(with_imu.findings));
  WheelsCompared with_scans = check_wheels_with_scans(recording);
  keep(std::move(with_scans.findings));
  checked.with_imu = with_imu.has_enough;
  checked.with_scans = with_scans.has_enough;
  return checked;
}

std::vector<SensorFinding> use_sound_sensors(Recording& recording) {
  return check_sensors(recording).findings;
}

}  // namespace adit
