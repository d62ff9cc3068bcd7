// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Where LiDARs that do not turn at a steady pace look: patterns that do not repeat from scan to scan, so
/// that their field of view fills up with time.
#pragma once

#include "adit/core/pose.hpp"
#include "adit/core/time.hpp"
#include "adit/simulation/lidar_model.hpp"

namespace adit {

/// The unit direction, in the lidar frame, of the ray fired at `stamp` by a sensor whose pattern is not
/// LidarPattern::spinning.
///
/// Rosette: a laser behind two wedge prisms that turn at different rates. To first order each bends the ray
/// by the same angle, towards where its thick side points, and the two add as vectors in the plane: a rose
/// curve (G. F. Marshall, "Risley prism scan patterns", Proc. SPIE 3787, 1999; of the Livox Mid-40: R.
/// Brazeal, B. Wilkinson, H. Hochmair, "A rigorous observation model for the Risley prism-based Livox Mid-40
/// lidar sensor", Sensors 21, 2021). The optical axis is x; elevation_max is half the field of view.
///
/// Wave: azimuth turns at one rate while elevation swings between its limits at another.
[[nodiscard]] Vector3 pattern_direction(const LidarConfig& config, Stamp stamp);

}  // namespace adit
