// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Two robots seldom drive the same line: a place is looked for as it was seen, and as it would look from
/// beside.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "adit/core/records.hpp"
#include "adit/place/scan_context.hpp"
#include "adit/robot/robot_map.hpp"

namespace adit {

/// Lines parallel to the one that was driven.
struct Lanes {
  int on_each_side = 0;  ///< Beside the one that was driven.
  double apart_m = 1.0;  ///< From each to the next.
};

/// What keyframe `k` looks like from each of them, the driven one first.
[[nodiscard]] std::vector<ScanContext> contexts_from(const Lanes& lanes, const RobotMap& map,
                                                     std::uint32_t k);

/// Names the place that looks most like a descriptor; none where none is near enough.
using FindSimilar = std::function<std::optional<LoopCandidate>(const ScanContext&)>;
/// What `find` names for keyframe `k` from each of them; each place once, with its smallest distance.
[[nodiscard]] std::vector<LoopCandidate> most_similar_from(const Lanes& lanes, const RobotMap& map,
                                                           std::uint32_t k, const FindSimilar& find);

}  // namespace adit
