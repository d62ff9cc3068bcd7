// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

#include "adit/core/config.hpp"
#include "adit/core/point_cloud.hpp"
#include "adit/robot/robot_map.hpp"

namespace adit {

/// A keyframe with those around it. A single scan shows what its sensor's field of view leaves; a few metres
/// of them show the tunnel, whatever the sensor (decision 0040). Lengths in metres.
struct SubmapConfig {
  double reach_m = 8.0;    ///< Along the path, to each side; 0: the keyframe alone.
  double step_m = 1.0;     ///< Along the path, from one keyframe that is taken to the next.
  double radius_m = 20.0;  ///< Points farther from the keyframe, horizontally, are left out.
};
/// The keys are the names of the fields.
[[nodiscard]] Fields fields_of(SubmapConfig& config);

/// The points of keyframe `k` and of those around it, brought together by odometry; base frame of keyframe
/// `k`. Not thinned. Throws std::out_of_range where there is no such keyframe.
[[nodiscard]] PointCloud submap(const RobotMap& map, std::uint32_t k, const SubmapConfig& config);

}  // namespace adit
