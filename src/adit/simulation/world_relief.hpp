// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "adit/core/pose.hpp"

namespace adit {

/// One scale of a smooth random displacement, metres.
struct ReliefOctave {
  double wavelength = 2.0;  ///< From one bulge to the next, about.
  double amplitude = 0.01;  ///< Largest displacement along each axis.
};

/// Turns smooth walls into shotcrete or rock by displacing space itself: neighbouring surfaces stay joined.
/// An octave's amplitude stays well below its wavelength, so that nothing folds over.
struct Relief {
  std::uint64_t seed = 1;             ///< Of the octaves, and of where the long waves rise.
  std::vector<ReliefOctave> octaves;  ///< Their displacements add up.
  double floor_share =
      0.0;  ///< Share of the vertical displacement that the floor (z = 0) takes part in, 0 to 1.
  double ramp_amplitude = 0.0;     ///< Amplitude of the long waves by which all floors rise and sink, metres.
  double ramp_wavelength = 320.0;  ///< Of those waves, about, metres.
};

/// The position of a point of the smooth world after displacement.
[[nodiscard]] Vector3 displaced(const Relief& relief, const Vector3& p);

/// The same where the floor lies `lift` metres above z = 0 at (p.x, p.y) and p is given as above a level
/// floor. Rock belongs to the place where it ends up, so that levels above one another differ.
[[nodiscard]] Vector3 displaced(const Relief& relief, const Vector3& p, double lift);

/// The same for a point of the smooth floor (its z is ignored): only its height changes.
[[nodiscard]] Vector3 on_floor(const Relief& relief, const Vector3& p);
/// The same where the smooth floor lies `lift` metres above z = 0.
[[nodiscard]] Vector3 on_floor(const Relief& relief, const Vector3& p, double lift);

}  // namespace adit
