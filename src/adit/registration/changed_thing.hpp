// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// What may come and go between two visits of one place: a vehicle, a pallet, a person. A rule of thumb about
/// shape and place, which no part of a tunnel's walls, roof or openings meets.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "adit/registration/agreement.hpp"

namespace adit {

/// How each point of a scan compares with another scan, at some pose.
enum class Compared : unsigned char {
  unseen,        ///< The other scan says nothing of that place.
  confirmed,     ///< It lies near a surface of the other scan,
  same_surface,  ///< which faces the same way.
  differs,
};

/// Sets of points that are connected over neighbouring cells of a grid, as indices, the largest first.
[[nodiscard]] std::vector<std::vector<std::size_t>> connected_patches(
    const std::vector<Eigen::Vector3f>& points, float cell_size);

/// True if the points `patch` of a scan, which differ, may be a thing that stands on the floor: it begins at
/// most 1.5 m above the floor, ends at most 3.1 m above it, is at most 7 m long, and does not continue a wall
/// that both scans saw, as what fills a niche or closes an opening would. `compared` is of each point of the
/// scan, whose z axis points upwards. A patch of a scan that shows no floor is no thing.
[[nodiscard]] bool may_be_a_thing(const SeenSurface& scan, std::span<const std::size_t> patch,
                                  const std::vector<Compared>& compared, const RegistrationConfig& config);

}  // namespace adit
