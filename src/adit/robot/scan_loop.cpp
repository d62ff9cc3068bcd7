// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/robot/scan_loop.hpp"

#include <algorithm>
#include <utility>

namespace adit {

namespace {

// Ten samples of a slow IMU. A robot that shakes turns by degrees in between, which nothing else measures.
constexpr Duration kImuSilence = std::chrono::milliseconds(100);
constexpr Duration kStart = std::chrono::milliseconds(500);

// Whether the wheels measured from `begin` to `end` without a silence.
bool spans(const Trajectory& wheel, Stamp begin, Stamp end) {
  if (wheel.empty() || begin < wheel.front().stamp || end > wheel.back().stamp) return false;
  auto at = std::ranges::upper_bound(wheel, begin, {}, &StampedPose::stamp);
  for (; at != wheel.end(); ++at) {
    if (at->stamp - (at - 1)->stamp > kWheelSilence) return false;
    if (at->stamp >= end) break;
  }
  return true;
}

// Of the half second before the first scan or, where the IMU began later, after it.
SensedMotion sensed_at_the_start(const Recording& recording) {
  SensedMotion motion;
  motion.T_base_imu = recording.T_base_imu;
  const Stamp first = recording.scan_stamps.front();
  motion.imu = imu_between(recording.imu, first - kStart, first, kImuSilence);
  if (motion.imu.empty()) motion.imu = imu_between(recording.imu, first, first + kStart, kImuSilence);
  return motion;
}

}  // namespace

SensedMotion sensed_before(const Recording& recording, std::size_t index) {
  if (index == 0) return sensed_at_the_start(recording);
  const Stamp begin = recording.scan_stamps[index - 1];
  const Stamp end = recording.scan_stamps[index];
  SensedMotion motion;
  if (spans(recording.wheel, begin, end)) motion.wheel = wheel_delta(recording.wheel, begin, end).value();
  motion.imu = imu_between(recording.imu, begin, end, kImuSilence);
  motion.T_base_imu = recording.T_base_imu;
  return motion;
}

Recording with_damaged_scans_empty(Recording recording, LeftOut& left_out) {
  recording.read_scan = [read = std::move(recording.read_scan), stamps = recording.scan_stamps, &left_out,
                         next = std::size_t{0}](std::size_t i) mutable -> Result<Scan> {
    Result<Scan> scan = read(i);
    const bool is_new = i == next;  // not one that is looked at again
    if (is_new) {
      ++next;
      scan ? left_out.take() : left_out.leave(scan.error());
    }
    if (!scan) return Scan{stamps[i], {}};
    return scan;
  };
  return recording;
}

Result<> for_each_scan(const Recording& recording, const ScanVisitor& visit) {
  for (std::size_t i = 0; i < recording.num_scans(); ++i) {
    const Result<Scan> scan = recording.read_scan(i);
    if (!scan) return fail(recording.name, scan.error());
    if (!visit(*scan, sensed_before(recording, i))) return fail(recording.name + ": interrupted");
  }
  return {};
}

}  // namespace adit
