// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include "adit/core/config.hpp"
#include "adit/core/point_cloud.hpp"
#include "adit/core/result.hpp"

namespace adit {

/// The paper's test for keyframes that saw nothing but a tube. The threshold depends on the site, as the
/// paper says. The defaults suit tubes of 7 to 10 m: with the cloud cropped at 30 m, the box of a straight
/// tube is as wide as the tube, and that of a junction reaches into the side passage.
struct TunnelFilterConfig {
  double width_threshold_m = 20.0;
  double max_range_m = 30.0;
};
/// The keys are the names of the fields.
inline Fields fields_of(TunnelFilterConfig& c) {
  return {{"width_threshold_m", &c.width_threshold_m, "m", 0.0, 1000.0,
           "a keyframe whose box has a second-largest extent below this is tunnel-like"},
          {"max_range_m", &c.max_range_m, "m", 0.0, 1000.0,
           "points farther than this from the robot are cropped first; 0: no cropping"}};
}

/// What the box of a keyframe's cloud says of the place.
struct TunnelVerdict {
  Vector3 extents = Vector3::Zero();  ///< Of the oriented box of the (cropped) cloud, metres, descending.
  bool tunnel_like = false;           ///< The second extent is below `width_threshold_m`.
};

/// Measures the oriented box of one keyframe's cloud, in its base frame, and calls it tunnel-like when the
/// second-largest extent (in a tunnel: its width) is below the threshold. The cloud is not changed; what
/// follows from the verdict (leave the graph, or only the loop search) is the caller's choice. Errors: no
/// finite point within `max_range_m`. Throws ContractViolation when `config` is out of its ranges. Source:
/// the paper, section 2.3.
[[nodiscard]] Result<TunnelVerdict> tunnel_filter(const PointCloud& cloud_base,
                                                  const TunnelFilterConfig& config);

}  // namespace adit
