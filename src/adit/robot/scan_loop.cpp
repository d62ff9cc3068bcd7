// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/robot/scan_loop.hpp"

namespace adit {

Result<std::optional<WheelDelta>> wheel_before(const Recording& recording, std::size_t index) {
  if (recording.wheel.empty() || index == 0) return std::optional<WheelDelta>{};
  return wheel_delta(recording.wheel, recording.scan_stamps[index - 1], recording.scan_stamps[index])
      .map([](const WheelDelta& delta) { return std::optional<WheelDelta>(delta); });
}

Result<> for_each_scan(const Recording& recording, const ScanVisitor& visit) {
  for (std::size_t i = 0; i < recording.num_scans(); ++i) {
    const Result<Scan> scan = recording.read_scan(i);
    if (!scan) return fail(recording.name, scan.error());
    const Result<std::optional<WheelDelta>> wheel = wheel_before(recording, i);
    if (!wheel) return fail(recording.name, wheel.error());
    if (!visit(*scan, *wheel)) return fail(recording.name + ": interrupted");
  }
  return {};
}

}  // namespace adit
