// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Recordings that one thing is wrong with.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "adit/robot/sensor_checks.hpp"

namespace adit::test {

/// Checks the sensors of a recording that one thing is wrong with, which must be the only finding.
inline SensorFinding only_finding(Recording& recording) {
  const std::vector<SensorFinding> findings = use_sound_sensors(recording);
  std::string sentences;
  for (const SensorFinding& finding : findings) sentences += finding.sentence + " | ";
  EXPECT_EQ(findings.size(), 1U) << sentences;
  return findings.empty() ? SensorFinding{Finding::imu_gaps, Consequence::noted, "no finding"}
                          : findings.front();
}

/// Expects that the only finding says `words`, and that the sensor it is about is left out where it says so.
inline void expect_finding(Recording recording, Finding finding, Consequence consequence,
                           const std::string& words) {
  const SensorFinding found = only_finding(recording);
  EXPECT_EQ(found.finding, finding) << found.sentence;
  EXPECT_EQ(found.consequence, consequence) << found.sentence;
  EXPECT_NE(found.sentence.find(words), std::string::npos) << found.sentence;
  const bool is_left_out =
      found.sentence.starts_with("imu") ? recording.imu.empty() : recording.wheel.empty();
  EXPECT_TRUE(consequence != Consequence::left_out || is_left_out);
}

}  // namespace adit::test
