// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/merge/loop_noise.hpp"

#include "adit/core/angles.hpp"
#include "adit/core/decompositions.hpp"

namespace adit {

Matrix6 information_of(const LoopNoise& noise) {
  Vector6 sigma;
  sigma << Vector3::Constant(noise.translation), Vector3::Constant(noise.rotation_deg * kDegree);
  return sigma.cwiseAbs2().cwiseInverse().asDiagonal();
}

Matrix6 with_noise(const LoopNoise& noise, const Matrix6& information) {
  // Woodbury's identity: the inverse of a sum of covariances, of which one may be infinite.
  const Matrix6 of_both =
      information - information * inverse(information + information_of(noise)) * information;
  return 0.5 * (of_both + of_both.transpose());
}

}  // namespace adit
