// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <vector>

#include "adit/core/result.hpp"
#include "adit/simulation/raycaster.hpp"
#include "adit/simulation/route.hpp"

namespace adit {

inline constexpr double kFloorAbove = 1.5;  ///< Metres: waypoints may lie below the floor.
inline constexpr double kFloorBelow =
    3.0;  ///< Metres: waypoints may be at the height of a sensor or of a person's eyes.

/// Height in metres of the surface at (p.x, p.y) that is nearest to p.z, world frame, z up; none where there
/// is no surface from `kFloorAbove` above p to `kFloorBelow` below it. It is the nearest and not the first
/// from above, since worlds have several levels and ceilings lower than `kFloorAbove`. Edges between
/// triangles belong to the floor, and so do cracks of up to a millimetre, which vertices written with few
/// decimals leave. The raycaster should be watertight (EdgeRule), or an edge may let the search pass to
/// another level.
[[nodiscard]] std::optional<double> floor_height(const Raycaster& raycaster, const Vector3& p);

/// The route's waypoints put on the floor (world frame, metres), with further floor points between waypoints
/// more than a metre apart. Fails, naming robot, waypoint and position, on fewer than two distinct waypoints,
/// a number that is not finite, a waypoint without floor, and a wall between two waypoints (looked for 0.5 m
/// above the floor).
[[nodiscard]] Result<std::vector<Vector3>> floor_line(const Raycaster& raycaster, const Route& route);

}  // namespace adit
