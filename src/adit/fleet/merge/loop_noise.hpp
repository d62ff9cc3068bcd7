// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Errors of loops beside what a registration states, or instead of it. They are added to each loop as noise
/// of its own, independent from loop to loop, though the errors of two units are alike over all loops of a
/// pair: many loops count for more than they should (docs/decisions/0086-what-loops-share.md).
#pragma once

#include "adit/core/pose.hpp"

namespace adit {

/// Standard deviations, none negative; the defaults are those of Swarm-SLAM's back-end.
struct LoopNoise {
  double translation = 0.1;   ///< Metres.
  double rotation_deg = 0.6;  ///< About each axis.
};
/// Diagonal, [translation; rotation] in 1/m^2 and 1/rad^2; infinite where the noise is zero.
[[nodiscard]] Matrix6 information_of(const LoopNoise& noise);

/// The information of a pose with `information` (finite, semi-definite, of the same units) after an
/// independent error of `noise` (right perturbation). Directions without information stay without, and noise
/// of zero changes nothing.
[[nodiscard]] Matrix6 with_noise(const LoopNoise& noise, const Matrix6& information);

}  // namespace adit
