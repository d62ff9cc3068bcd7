// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <numbers>
#include <optional>
#include <string>

#include "adit/core/config.hpp"
#include "adit/core/records.hpp"

namespace adit {

/// When a scan becomes a keyframe. The paper: after 0.5 m of odometry.
struct KeyframePolicyConfig {
  std::string policy = "distance";  ///< distance | distance_angle | time
  double distance_m = 0.5;
  double angle_deg = 10.0;
  double period_s = 1.0;
};
inline Fields fields_of(KeyframePolicyConfig& c) {
  return {
      {"policy", &c.policy, "", 0, 0, "what a new keyframe needs", {"distance", "distance_angle", "time"}},
      {"distance_m", &c.distance_m, "m", 0.0, 100.0,
       "motion since the last keyframe (distance, distance_angle)"},
      {"angle_deg", &c.angle_deg, "deg", 0.1, 180.0, "or this much turning (distance_angle)"},
      {"period_s", &c.period_s, "s", 0.0, 3600.0, "time since the last keyframe (time)"}};
}

/// Chooses keyframes from the stream of odometry steps of one robot.
///
/// A step without a pose of its own (`too_few_points`, `diverged`) is never a keyframe. Every other may be,
/// `degenerate` too: its cloud is sound and its pose stands on the prediction where the geometry is silent,
/// and a tunnel robot that dropped such steps would have no keyframes at all. The first such step always is
/// one.
///
/// distance:        the position is at least `distance_m` from the last keyframe's;
/// distance_angle:  that, or turned by at least `angle_deg` from it;
/// time:            its stamp is at least `period_s` after the last keyframe's.
/// A value at the threshold accepts; the distance is measured between the two poses, not along the way.
class KeyframePolicy {
 public:
  /// Throws ContractViolation when `config` is out of its documented ranges.
  explicit KeyframePolicy(const KeyframePolicyConfig& config);

  /// Whether `step` becomes a keyframe; if so, later steps are measured from it. Steps come in the order of
  /// time.
  [[nodiscard]] bool accepts(const OdometryStep& step);

 private:
  [[nodiscard]] bool far_enough(const OdometryStep& step) const;

  KeyframePolicyConfig config_;
  std::optional<StampedPose> last_;  ///< The last keyframe; none before the first.
};

}  // namespace adit
