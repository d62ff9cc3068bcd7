// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "adit/core/config.hpp"
#include "adit/core/records.hpp"

namespace adit {

/// What a new keyframe needs.
enum class KeyframeRule { distance, distance_angle, time };
/// All rules.
inline constexpr std::array kKeyframeRules{KeyframeRule::distance, KeyframeRule::distance_angle,
                                           KeyframeRule::time};
/// distance, distance_angle, time.
[[nodiscard]] std::string_view to_string(KeyframeRule rule);

/// When a scan becomes a keyframe. The paper: after 0.5 m of odometry.
struct KeyframePolicyConfig {
  KeyframeRule policy = KeyframeRule::distance;
  double distance_m = 0.5;
  double angle_deg = 10.0;
  double period_s = 1.0;
};
/// The keys are the names of the fields.
[[nodiscard]] Fields fields_of(KeyframePolicyConfig& config);

/// Chooses keyframes from the stream of odometry steps of one robot.
///
/// A step that was not registered (`too_few_points`, `diverged`) is never a keyframe. Every other may be one,
/// `degenerate` too: its cloud is sound, and its pose follows the prediction where the geometry leaves it
/// open; a robot in a tunnel that dropped such steps would have no keyframes at all. The first registered
/// step always is one.
///
/// distance:        the position is at least `distance_m` from the last keyframe's;
/// distance_angle:  that, or turned by at least `angle_deg` from it;
/// time:            its stamp is at least `period_s` after the last keyframe's.
/// A value at the threshold accepts; the distance is the straight line between the two positions.
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
