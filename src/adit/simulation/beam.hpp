// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Beams that have a width: what they meet at edges and on walls that they graze.
///
/// A beam's footprint grows with the range. Where it lies on two surfaces, the sensor reports the stronger
/// return, or a point in between where both are less than a pulse apart. On a wall that is met at a grazing
/// angle the footprint is long, and the range lies anywhere within it (Lichti, Gordon and Tipdecho, "Error
/// models and propagation in directly georeferenced terrestrial laser scanner networks", 2005).
#pragma once

#include <cstdint>
#include <optional>

#include "adit/simulation/raycaster.hpp"

namespace adit {

/// The width of a beam, and how far apart two of its returns have to be.
struct Beam {
  double divergence = 0.0;  ///< Radians, full angle; 0: no width.
  double pulse_m = 0.3;     ///< Returns nearer to one another than this are one.
};

/// Ranges in the columns before and after that of a block, ray by ray; none at the ends of a sweep and where
/// beams make no columns.
struct Neighbours {
  const RayBlock::Numbers* before = nullptr;  ///< Fired just before.
  const RayBlock::Numbers* after = nullptr;   ///< Fired just after.
};

/// Casts the rays of a block, without a width, at the world and at what is there beside it for now. Returns
/// whether any of them meets that.
bool cast_rays(const Raycaster& world, const std::optional<Raycaster>& movers, float range_max,
               RayBlock& rays);

/// Gives rays that were cast a width: where neighbours in the block or in the columns beside it show an edge
/// (10 cm off a straight line), or a surface is met at more than 70 degrees, a ring of rays finds what the
/// footprint holds. `seed` draws where in it the range lies. A divergence of 0 changes nothing.
void widen_rays(const Raycaster& world, const std::optional<Raycaster>& movers, const Beam& beam,
                const Neighbours& columns, float range_max, std::uint64_t seed, RayBlock& rays);

}  // namespace adit
