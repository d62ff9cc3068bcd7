// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <compare>
#include <cstdint>
#include <functional>

namespace adit {

/// A robot of the fleet: 0, 1, 2, ... at most 255, so that every keyframe fits one 64-bit graph key.
struct RobotId {
  std::uint8_t value = 0;  ///< As `robot_ids` gives them out.
  auto operator<=>(const RobotId&) const = default;
};

/// The index-th keyframe of a robot, counted from 0 in the order driven.
struct KeyframeId {
  RobotId robot;            ///< In whose map the keyframe is.
  std::uint32_t index = 0;  ///< Position in RobotMap::keyframes.
  auto operator<=>(const KeyframeId&) const = default;
};

/// The key that g2o files carry: GTSAM's Symbol layout, a letter in the top byte ('a' + robot) and the index
/// below.
[[nodiscard]] constexpr std::uint64_t graph_key(KeyframeId id) {
  return (static_cast<std::uint64_t>('a' + id.robot.value) << 56U) | id.index;
}
/// The inverse of `graph_key`. Of a key that it did not make, an id without meaning.
[[nodiscard]] constexpr KeyframeId keyframe_id(std::uint64_t key) {
  return {{static_cast<std::uint8_t>((key >> 56U) - 'a')}, static_cast<std::uint32_t>(key)};
}

}  // namespace adit

template <>
/// For unordered containers.
struct std::hash<adit::RobotId> {
  /// Different for each robot.
  std::size_t operator()(adit::RobotId id) const noexcept { return id.value; }
};
template <>
/// For unordered containers.
struct std::hash<adit::KeyframeId> {
  /// Different for each keyframe, where std::size_t has 64 bits.
  std::size_t operator()(adit::KeyframeId id) const noexcept {
    return (static_cast<std::size_t>(id.robot.value) << 32U) | id.index;
  }
};
