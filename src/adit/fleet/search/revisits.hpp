// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Places of its own map to which a robot may have come back: what odometry says about them.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "adit/posegraph/pcm.hpp"

namespace adit {

/// Metres that a robot has driven at least between two visits: two keyframes no farther apart along the way
/// may see the same walls without its having come back.
inline constexpr double kRevisitWay = 40.0;

/// The later keyframes that may stand where keyframe k does: `kRevisitWay` or more along `way` (way_along)
/// and no farther away than a few metres and what the odometry may be off.
[[nodiscard]] std::vector<std::uint32_t> possible_revisits(const OdometryChain& chain,
                                                           const std::vector<double>& way, std::uint32_t k);

/// Whether a loop within one map is compatible with its odometry, generously: odometry slips.
[[nodiscard]] bool fits_odometry(const OdometryChain& chain, const PcmLoop& loop);

/// Evidence that such a loop is true: the logarithm of the likelihood ratio of how far it lies, in the plane,
/// from where the odometry led. A true one is as far as the odometry drifts; one that only looks alike may be
/// anywhere that `possible_revisits` allows.
[[nodiscard]] double odometry_evidence(const OdometryChain& chain, const PcmLoop& loop);

}  // namespace adit
