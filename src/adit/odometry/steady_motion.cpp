// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/odometry/steady_motion.hpp"

#include <algorithm>

#include "adit/core/check.hpp"

namespace adit {

void SteadyMotion::arrive(Stamp stamp, const Pose& T_odom_base) {
  ADIT_CHECK(!stamp_ || *stamp_ < stamp, "the stamps of scans ascend");
  if (stamp_) last_ = {T_odom_base_.inverse() * T_odom_base, stamp - *stamp_};
  stamp_ = stamp;
  T_odom_base_ = T_odom_base;
}

Pose SteadyMotion::until(Stamp stamp) const {
  ADIT_CHECK(!stamp_ || *stamp_ < stamp, "the stamps of scans ascend");
  if (!last_) return {};
  return last_->pose_after(std::min(stamp - *stamp_, std::max(last_->duration, kVelocityHorizon)));
}

}  // namespace adit
