// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Places of its own map to which a robot may have come back, and what its odometry says about loops there.
#pragma once

#include <cstdint>
#include <vector>

#include "adit/core/config.hpp"
#include "adit/posegraph/pcm.hpp"

namespace adit {

/// When odometry allows that a robot came back to a place.
struct RevisitConfig {
  double path_m = 40.0;
  double near_m = 5.0;
  double sigmas = 3.0;
  double probability = 0.99;
};
/// The keys are the names of the fields.
inline Fields fields_of(RevisitConfig& c) {
  return {
      {"path_m", &c.path_m, "m", 1.0, 10000.0,
       "path driven between two visits at least: nearer keyframes see the same walls without a return"},
      {"near_m", &c.near_m, "m", 0.0, 1000.0, "two keyframes of one place are at most this far apart"},
      {"sigmas", &c.sigmas, "", 0.1, 100.0,
       "sigmas by which odometry may be off, and factor on its noise in the test of a loop"},
      {"probability", &c.probability, "", 0.5, 0.999999, "probability that a true loop passes that test"}};
}

/// The later keyframes that may stand where keyframe k does: at least `config.path_m` on along the path, and
/// within a few metres and the drift of the odometry.
[[nodiscard]] std::vector<std::uint32_t> possible_revisits(const OdometryChain& chain, std::uint32_t k,
                                                           const RevisitConfig& config = {});

/// Whether a loop within one map is compatible with its odometry, generously: odometry slips.
[[nodiscard]] bool fits_odometry(const OdometryChain& chain, const PcmLoop& loop,
                                 const RevisitConfig& config = {});

/// Evidence that such a loop is true: the logarithm of the likelihood ratio of how far it lies, in the plane,
/// from where the odometry led. A true one is as far as the odometry drifts; one that only looks alike may be
/// anywhere that `possible_revisits` allows.
[[nodiscard]] double odometry_evidence(const OdometryChain& chain, const PcmLoop& loop,
                                       const RevisitConfig& config = {});

}  // namespace adit
