// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// What may come and go between two visits of one place: a vehicle, a pallet, a person. A rule of thumb about
/// shape and place, which no part of a tunnel's walls, roof or openings meets.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "adit/core/config.hpp"
#include "adit/registration/agreement.hpp"

namespace adit {

/// Of the largest vehicles that drive in drifts: load-haul-dump machines, trucks, light vehicles.
struct ThingShape {
  double tallest_m = 3.1;
  double longest_m = 7.0;
  double highest_foot_m = 1.5;
  double floor_around_m = 3.0;
};
/// The keys are the names of the fields; they carry the meanings.
[[nodiscard]] Fields fields_of(ThingShape& shape);

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

/// True if the points `patch` of a scan, which differ, may be a thing that stands on the floor: it has the
/// shape of one (ThingShape), and does not continue a wall that both scans saw, as what fills a niche or
/// closes an opening would. `compared` is of each point of the scan, whose z axis points upwards. A patch of
/// a scan that shows no floor is no thing.
[[nodiscard]] bool may_be_a_thing(const SeenSurface& scan, std::span<const std::size_t> patch,
                                  const std::vector<Compared>& compared, const RegistrationConfig& config);

}  // namespace adit
