// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Poses as files and messages state them.
#pragma once

#include "adit/core/pose.hpp"
#include "adit/core/result.hpp"

namespace adit {

/// By how much the norm of a quaternion may be off 1 that was rounded to a few digits; more than that is
/// another number in its place.
inline constexpr double kRoundedQuaternion = 0.01;

/// The pose of a stated position (metres) and quaternion, whose norm is made 1. One of full precision stays
/// as it is, so that what was written comes back. Fails on a norm off 1 by more than `norm_error`, and as
/// check_not_far_out does.
[[nodiscard]] Result<Pose> stated_pose(const Vector3& position, const Eigen::Quaterniond& rotation,
                                       double norm_error = kRoundedQuaternion);

}  // namespace adit
