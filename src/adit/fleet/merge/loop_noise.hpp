// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Errors that loops have alike, whatever a registration says of itself.
#pragma once

#include "adit/core/pose.hpp"

namespace adit {

/// Standard deviations; the defaults are those of Swarm-SLAM's back-end.
struct LoopNoise {
  double translation = 0.1;   ///< Metres.
  double rotation_deg = 0.6;  ///< About each axis.
};
/// Diagonal, [translation; rotation] in 1/m^2 and 1/rad^2.
[[nodiscard]] Matrix6 information_of(const LoopNoise& noise);

/// The information of a pose with `information` after an independent error of `noise` (right perturbation).
/// Directions without information stay without.
[[nodiscard]] Matrix6 with_noise(const LoopNoise& noise, const Matrix6& information);

}  // namespace adit
