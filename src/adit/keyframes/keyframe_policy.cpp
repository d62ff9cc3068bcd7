// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/keyframes/keyframe_policy.hpp"

#include <numbers>

#include "adit/core/check.hpp"

namespace adit {
namespace {

KeyframePolicyConfig checked(KeyframePolicyConfig config) {
  const Result<> valid = check_fields(fields_of(config));
  ADIT_CHECK(valid.has_value(), valid.error().message.c_str());
  return config;
}

bool was_registered(StepStatus status) {
  return status == StepStatus::ok || status == StepStatus::no_map || status == StepStatus::degenerate;
}

}  // namespace

std::string_view to_string(KeyframeRule rule) {
  switch (rule) {
    case KeyframeRule::distance:
      return "distance";
    case KeyframeRule::distance_angle:
      return "distance_angle";
    case KeyframeRule::time:
      return "time";
  }
  return "unknown";
}

Fields fields_of(KeyframePolicyConfig& c) {
  return {enum_field("policy", &c.policy, kKeyframeRules, "criterion for a new keyframe"),
          {"distance_m", &c.distance_m, "m", 0.0, 100.0,
           "motion since the last keyframe (distance, distance_angle)"},
          {"angle_deg", &c.angle_deg, "deg", 0.1, 180.0, "or this much turning (distance_angle)"},
          {"period_s", &c.period_s, "s", 0.0, 3600.0, "time since the last keyframe (time)"}};
}

KeyframePolicy::KeyframePolicy(const KeyframePolicyConfig& config) : config_(checked(config)) {}

bool KeyframePolicy::accepts(const OdometryStep& step) {
  if (!was_registered(step.status)) return false;
  if (last_ && !far_enough(step)) return false;
  last_ = StampedPose{step.stamp, step.T_odom_base};
  return true;
}

bool KeyframePolicy::far_enough(const OdometryStep& step) const {
  if (config_.policy == KeyframeRule::time)
    return step.stamp - last_->stamp >= from_seconds(config_.period_s);
  // The plain difference of positions: turning it into the last frame would only round it.
  const Vector3 moved = step.T_odom_base.translation() - last_->T_world_body.translation();
  if (moved.norm() >= config_.distance_m) return true;
  if (config_.policy != KeyframeRule::distance_angle) return false;
  const double turned = (last_->T_world_body.inverse() * step.T_odom_base).angle();
  return turned >= config_.angle_deg * std::numbers::pi / 180.0;
}

}  // namespace adit
