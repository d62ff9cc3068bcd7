// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <optional>

#include "adit/core/records.hpp"
#include "adit/geometry/deskew.hpp"

namespace adit {

/// Metres from the sensor; both bounds are exclusive, so that the (0, 0, 0) that some drivers write for "no
/// echo" is dropped too.
struct RangeLimits {
  double min_range = 0.0;    ///< Points at this range and nearer ones are dropped.
  double max_range = 100.0;  ///< Points at this range and farther ones are dropped.
};

/// A raw cloud in the lidar frame -> all points with a finite position and a range within the limits, in the
/// base frame at the scan's stamp, at full density and in their order; intensities are kept, times are used
/// up. With `motion` (of the base) and per-point times the sweep is deskewed; without either it is only moved
/// into the base frame. The result replaces `cloud_base` and uses its memory.
void preprocess(const PointCloud& cloud_lidar, const RangeLimits& limits, const Pose& T_base_lidar,
                const std::optional<SweepMotion>& motion, PointCloud& cloud_base);

}  // namespace adit
