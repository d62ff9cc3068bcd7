// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <span>

#include "adit/core/pose.hpp"
#include "adit/core/result.hpp"

namespace adit {

/// The rigid motion T_target_source that minimises sum |target_i - T_target_source * source_i|^2, without
/// scale and never a reflection. Source: Umeyama, "Least-squares estimation of transformation parameters
/// between two point patterns", PAMI 1991, equations 40 to 42 with c = 1.
///
/// Where the points leave the rotation open, the smallest of the best rotations is returned: points on one
/// line (a robot that drove straight ahead) turn that line onto the other and do not roll about it;
/// coincident points, or a single point, do not turn at all.
///
/// Fails when there is no point or when a coordinate is not finite. Throws ContractViolation when the two
/// spans differ in length.
[[nodiscard]] Result<Pose> align_rigid(std::span<const Vector3> source, std::span<const Vector3> target);

}  // namespace adit
