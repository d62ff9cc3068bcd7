// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include "adit/robot/scan_checks.hpp"
#include "adit/slam/doctor.hpp"

namespace adit {

/// What adit slam would say of `recording`, whose sensors are sound, by some stretches of it; the remedy goes
/// by what `seen` shows of its scans.
[[nodiscard]] Diagnosis diagnose_mapping(const Recording& recording, const ScansSeen& seen,
                                         RobotSlamConfig config);

}  // namespace adit
