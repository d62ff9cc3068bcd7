// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <vector>

#include "adit/core/records.hpp"

namespace adit {

/// Estimated poses with the true poses at the same stamps; the three arrays are equally long.
struct AssociatedPoses {
  std::vector<Stamp> stamps;      ///< Of the estimates.
  std::vector<Pose> estimate;     ///< T_odom_body (or whatever frame the estimate lives in).
  std::vector<Pose> truth;        ///< T_world_body, interpolated to the estimate's stamp.
  std::size_t num_unmatched = 0;  ///< Estimates outside the truth's span, or inside a gap of it.

  /// The number of pairs.
  [[nodiscard]] std::size_t size() const { return stamps.size(); }
};

/// Finds the truth for each pose of `estimate`. Between two true poses further apart in time than `max_gap`
/// nothing is interpolated. Fails when no pose finds a partner; the message names both spans.
[[nodiscard]] Result<AssociatedPoses> associate(const Trajectory& estimate, const Trajectory& truth,
                                                Duration max_gap = std::chrono::seconds(1));

}  // namespace adit
