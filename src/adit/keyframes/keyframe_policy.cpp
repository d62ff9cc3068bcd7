// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/keyframes/keyframe_policy.hpp"

#include "adit/core/check.hpp"

namespace adit {
namespace {

KeyframePolicyConfig checked(KeyframePolicyConfig config) {
  const Result<> valid = check_fields(fields_of(config));
  ADIT_CHECK(valid.has_value(), valid.error().message.c_str());
  return config;
}

bool has_pose_of_its_own(StepStatus status) {
  return status == StepStatus::ok || status == StepStatus::no_map || status == StepStatus::degenerate;
}

}  // namespace

KeyframePolicy::KeyframePolicy(const KeyframePolicyConfig& config) : config_(checked(config)) {}

bool KeyframePolicy::accepts(const OdometryStep& step) {
  if (!has_pose_of_its_own(step.status)) return false;
  if (last_ && !far_enough(step)) return false;
  last_ = StampedPose{step.stamp, step.T_odom_base};
  return true;
}

bool KeyframePolicy::far_enough(const OdometryStep& step) const {
  if (config_.policy == "time") return step.stamp - last_->stamp >= from_seconds(config_.period_s);
  // The plain difference of positions: turning it into the last frame would only round it.
  const Vector3 moved = step.T_odom_base.translation() - last_->T_world_body.translation();
  if (moved.norm() >= config_.distance_m) return true;
  return config_.policy == "distance_angle" && (last_->T_world_body.inverse() * step.T_odom_base).angle() >=
                                                   config_.angle_deg * std::numbers::pi / 180.0;
}

}  // namespace adit
