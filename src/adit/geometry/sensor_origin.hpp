// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Where the spinning LiDAR stood that measured some clouds, found in the clouds alone.
///
/// Each beam of a spinning LiDAR sweeps a cone about the sensor's own z axis. Seen from the sensor, the
/// slopes z / (horizontal range) of all points therefore fall on as many values as there are beams; seen from
/// anywhere else they smear. The position looked for is the one whose histogram of slopes is the sharpest.
///
/// This needs clouds whose z axis is the sensor's (the mount does not tilt it) and whose points were not
/// averaged. A sensor without beams on cones leaves no sharp position, and none is returned.
#pragma once

#include <optional>
#include <span>

#include "adit/core/point_cloud.hpp"

namespace adit {

/// Where the sensor stood, and how clearly the clouds say so.
struct SensorOrigin {
  Vector3 position;     ///< In the clouds' frame, metres, to about 2 mm.
  double contrast = 0;  ///< Sharpness here over the largest 0.2 m away, in the least clear of the clouds.
};

/// Below this contrast a position is not believed. A simulated sensor of 32 beams has 4 to 5 in the tunnels
/// of zab, single scans of NCLT (HDL-32E, thinned) have about 3; clouds that share no position stay at
/// about 1.
inline constexpr double kClearContrast = 1.6;

/// The one position, within 1.5 m across and 3 m up or down of the clouds' own origin, from which all
/// `clouds` were measured; none when it is not clear in every cloud. Five clouds of a drive are enough. Takes
/// 0.2 s where the sensor is at the clouds' origin, above or below it, else up to 2 s.
[[nodiscard]] std::optional<SensorOrigin> find_sensor_origin(std::span<const PointCloud> clouds);

}  // namespace adit
