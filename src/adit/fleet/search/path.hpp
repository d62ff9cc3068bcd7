// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Positions along the path that a robot drove.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "adit/posegraph/pcm.hpp"

namespace adit {

/// The first keyframe at or beyond `metres` of path (OdometryChain::path_m); none before the start and beyond
/// the end.
[[nodiscard]] std::optional<std::uint32_t> keyframe_at(const std::vector<double>& path_m, double metres);

/// At most `num` of `size` keyframes, evenly spread.
[[nodiscard]] std::vector<std::uint32_t> evenly_spread(std::size_t size, std::size_t num);

/// The loop whose end `b` is nearest to keyframe `b` along the other robot's path; the first of equals. At
/// least one loop.
[[nodiscard]] const PcmLoop& nearest_loop(const std::vector<PcmLoop>& loops,
                                          const std::vector<double>& their_path_m, std::size_t b);

/// Two keyframes that are compared stand at most so many metres apart.
inline constexpr double kSideBySide = 3.0;

/// Of the keyframes that `may_be(index)` allows, the one nearest to `position` (frame odom); the first of
/// equals. None where all are kSideBySide or more away.
template <class MayBe>
[[nodiscard]] std::optional<std::uint32_t> nearest_beside(const OdometryChain& chain, const Vector3& position,
                                                          const MayBe& may_be) {
  std::optional<std::uint32_t> nearest;
  double nearest_m = kSideBySide;
  for (std::uint32_t k = 0; k < chain.size(); ++k) {
    if (!may_be(k)) continue;
    const double metres = (chain.pose(k).translation() - position).norm();
    if (metres < nearest_m) nearest = k;
    nearest_m = std::min(nearest_m, metres);
  }
  return nearest;
}

}  // namespace adit
