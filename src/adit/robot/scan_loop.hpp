// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// The loop over the scans of a recording.
#pragma once

#include <functional>
#include <optional>

#include "adit/core/records.hpp"

namespace adit {

/// The wheel motion from scan `index` - 1 to `index`; none for the first scan and for recordings without
/// wheels.
[[nodiscard]] Result<std::optional<WheelDelta>> wheel_before(const Recording& recording, std::size_t index);

/// Takes a scan and the wheel motion since the scan before (as `wheel_before`); returns false to stop.
using ScanVisitor = std::function<bool(const Scan& scan, const std::optional<WheelDelta>& wheel)>;

/// Hands every scan of the recording to `visit`, in order; each is read once. Fails, naming the recording,
/// when a scan cannot be read, when the wheel odometry does not span it, and when `visit` stops it.
[[nodiscard]] Result<> for_each_scan(const Recording& recording, const ScanVisitor& visit);

}  // namespace adit
