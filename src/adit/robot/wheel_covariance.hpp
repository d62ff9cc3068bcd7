// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "adit/core/pose.hpp"

namespace adit {

/// What is wrong with the covariance that a message of wheel odometry states, as the end of a sentence that
/// begins "the covariance ... is": not finite, not positive definite, huge. "" where nothing is, and for one
/// of zeros, by which drivers say that they know nothing. Order x, y, z, rotation about x, y, z.
///
/// Wheels measure in the plane: an axis whose row and column are zero is not stated, and along z, roll and
/// pitch drivers write large numbers for "not measured". Only x, y and yaw can be huge.
[[nodiscard]] std::string fault_of_pose_covariance(const Matrix6& covariance);   ///< m^2, rad^2
[[nodiscard]] std::string fault_of_twist_covariance(const Matrix6& covariance);  ///< (m/s)^2, (rad/s)^2

}  // namespace adit
