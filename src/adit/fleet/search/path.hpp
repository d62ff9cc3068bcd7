// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Positions along the path that a robot drove.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "adit/posegraph/pcm.hpp"

namespace adit {

/// Path length up to each keyframe, metres.
[[nodiscard]] std::vector<double> path_lengths(const OdometryChain& chain);

/// The first keyframe at or beyond `metres`; none before the start and beyond the end.
[[nodiscard]] std::optional<std::uint32_t> keyframe_at(const std::vector<double>& path_m, double metres);

/// At most `num` of `size` keyframes, evenly spread.
[[nodiscard]] std::vector<std::uint32_t> evenly_spread(std::size_t size, std::size_t num);

/// The loop whose end `b` is nearest to keyframe `b` along the other robot's path; the first of equals. At
/// least one loop.
[[nodiscard]] const PcmLoop& nearest_loop(const std::vector<PcmLoop>& loops,
                                          const std::vector<double>& their_path_m, std::size_t b);

}  // namespace adit
