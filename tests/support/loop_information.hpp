// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include "adit/core/angles.hpp"
#include "adit/core/pose.hpp"

namespace adit::test {

/// Of loops that are known to 0.1 m and 0.6 degrees.
inline Matrix6 loop_information() {
  Vector6 sigma;
  sigma << Vector3::Constant(0.1), Vector3::Constant(0.6 * kDegree);
  return sigma.cwiseAbs2().cwiseInverse().asDiagonal();
}

}  // namespace adit::test
