// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

namespace adit {

/// A point that a search found: its index in the cloud that was searched.
struct Neighbor {
  std::uint32_t index = 0;        ///< Counts all points of that cloud, finite or not.
  float squared_distance = 0.0F;  ///< Square metres.
  bool operator==(const Neighbor&) const = default;
};

}  // namespace adit
