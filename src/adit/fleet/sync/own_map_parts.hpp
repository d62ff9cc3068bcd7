// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// What a robot sends of its own map: descriptors and clouds of keyframes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "adit/fleet/sync/protocol.hpp"
#include "adit/robot/robot_map.hpp"
#include "adit/robot/submap.hpp"

namespace adit {

/// The keyframes that take part in loop search, in the order driven.
[[nodiscard]] std::vector<std::uint32_t> searchable_keyframes(const RobotMap& map);

/// Descriptors of the searchable keyframes, from number `first` of them on.
[[nodiscard]] std::vector<MessageBody> places_since(const RobotMap& map, std::size_t first);

/// What the clouds that a robot sends are made of.
struct SentClouds {
  double voxel_m = 0.3;  ///< One point each.
  SubmapConfig submap;   ///< Of clouds of CloudKind::submap.
  SubmapConfig view;     ///< Of CloudKind::view: the scans beside the keyframe's own.
};
/// The clouds that a peer asks for; keyframes that do not exist are left out.
[[nodiscard]] Clouds clouds_of(const RobotMap& map, const CloudRequest& request, const SentClouds& config);

}  // namespace adit
