// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// The loop over the scans of a recording.
#pragma once

#include <functional>

#include "adit/core/left_out.hpp"
#include "adit/core/records.hpp"

namespace adit {

/// Wheels that are silent for longer say nothing: robots speed up, stop and turn within that.
inline constexpr Duration kWheelSilence = std::chrono::seconds(1);

/// What the other sensors measured from scan `index` - 1 to `index`; for the first
/// scan, what the IMU felt in the half second around it. Wheels that
/// begin later, end earlier or were silent for longer than kWheelSilence in between say nothing of that
/// interval; an IMU neither, for which a silence begins after 0.1 s.
[[nodiscard]] SensedMotion sensed_before(const Recording& recording, std::size_t index);

/// Takes a scan and what was measured since the scan before (as `sensed_before`); returns false to stop.
using ScanVisitor = std::function<bool(const Scan& scan, const SensedMotion& motion)>;

/// The recording with a scan without points in place of each that cannot be read: one damaged message must
/// not cost the drive. `left_out` counts as scans are read in their order, by one thread, and has to live as
/// long.
[[nodiscard]] Recording with_damaged_scans_empty(Recording recording, LeftOut& left_out);

/// Hands every scan of the recording to `visit`, in order; each is read once. Fails, naming the recording,
/// when a scan cannot be read, and when `visit` stops it.
[[nodiscard]] Result<> for_each_scan(const Recording& recording, const ScanVisitor& visit);

}  // namespace adit
