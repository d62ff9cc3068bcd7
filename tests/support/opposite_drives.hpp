// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Two robots that drove one straight tunnel in opposite directions: their odometries and loops.
#pragma once

#include <cstddef>
#include <numbers>
#include <vector>

#include "adit/fleet/sync/fleet_graph.hpp"
#include "adit/posegraph/pcm.hpp"
#include "support/loop_information.hpp"

namespace adit::test {

/// Half a metre between keyframes.
inline OdometryChain along_x(std::size_t num, double variance = 1e-4) {
  std::vector<Pose> poses;
  for (std::size_t k = 0; k < num; ++k)
    poses.push_back(Pose::translation_of(0.5 * static_cast<double>(k), 0, 0));
  return {poses, std::vector<Matrix6>(num - 1, Matrix6::Identity() * variance)};
}

inline constexpr std::size_t kNum = 200;  // keyframes: 100 m

/// Robot b came towards a: it stands at 100 m - x of a, on a lane 1 m beside.
inline Pose T_a_b_true(std::size_t a, std::size_t b, double off_m = 0.0) {
  const double x_a = 0.5 * static_cast<double>(a);
  const double x_b = 99.5 - 0.5 * static_cast<double>(b) + off_m;
  return Pose::planar(x_b - x_a, 1.0, std::numbers::pi);
}

/// Keyframes that stand side by side, if b is `off_m` farther on than it truly is.
inline PcmLoop loop_at(std::size_t a, double off_m = 0.0) {
  const auto b = static_cast<std::size_t>(static_cast<double>(kNum - 1 - a) + 2.0 * off_m);
  return {a, b, T_a_b_true(a, b, off_m), loop_information()};
}

inline const std::vector<PcmLoop> kTrueLoops = {loop_at(80), loop_at(90), loop_at(100)};

}  // namespace adit::test
