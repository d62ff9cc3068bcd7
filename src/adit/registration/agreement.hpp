// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include "adit/core/pose.hpp"
#include "adit/geometry/kd_tree.hpp"
#include "adit/registration/oriented_points.hpp"
#include "adit/registration/registration_config.hpp"

namespace adit {

/// What two scans say about their relative pose where both could see. A point counts when the other scan had
/// a surface in its direction and it does not hide behind that surface: it is confirmed when the other scan
/// has a point near it, and it contradicts when the other scan saw through the place where it stands. Free
/// space is what tells one tube from another that is wider, or has a niche less.
struct Agreement {
  double confirmed = 0.0;     ///< Share of the points that count, the smaller of both directions.
  double contradicted = 1.0;  ///< Share of the points that count, the larger of both directions.
};

/// `a` and `b` were seen from the origins of their frames; `T_a_b` brings the points of b into the frame of
/// a. No point that counts: nothing is confirmed.
[[nodiscard]] Agreement agreement(const OrientedPoints& a, const KdTree& tree_a, const OrientedPoints& b,
                                  const KdTree& tree_b, const Pose& T_a_b, const RegistrationConfig& config);

}  // namespace adit
