// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/merge/loop_noise.hpp"

#include "adit/core/angles.hpp"
#include "adit/core/decompositions.hpp"

namespace adit {
namespace {

/// [translation; rotation] in m^2 and rad^2.
Vector6 variances_of(const LoopNoise& noise) {
  Vector6 sigma;
  sigma << Vector3::Constant(noise.translation), Vector3::Constant(noise.rotation_deg * kDegree);
  return sigma.cwiseAbs2();
}

}  // namespace

Matrix6 information_of(const LoopNoise& noise) { return variances_of(noise).cwiseInverse().asDiagonal(); }

Matrix6 with_noise(const LoopNoise& noise, const Matrix6& information) {
  // The parallel sum I (I + N)^-1 N of I and the information N of the noise, which needs no inverse of I. N
  // is cancelled, I (1 + N^-1 I)^-1, as it is infinite where the noise is zero. I - I (I + N)^-1 I is the
  // same on paper, but loses its digits where I is much larger than N.
  const Matrix6 noise_covariance = variances_of(noise).asDiagonal();
  const Matrix6 of_both = information * inverse(Matrix6::Identity() + noise_covariance * information);
  return 0.5 * (of_both + of_both.transpose());
}

}  // namespace adit
